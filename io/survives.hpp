#pragma once
// For files that make a library crash.
#include <functional>

namespace hourglass {

/// Whether a child process lives through `work` within ten seconds; exceptions do not count.
bool survives(const std::function<void()>& work);

}  // namespace hourglass
