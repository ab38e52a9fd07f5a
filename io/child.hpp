#pragma once
// For files that make a library crash or go round in circles: a child process works on them.
#include <functional>
#include <optional>
#include <string>

namespace hourglass {

/// The bytes that `work` makes in a child process; none if the child does not live through it, or works for longer than so
/// many seconds of processor time. What `work` throws is thrown here as std::runtime_error with the same words. Where no
/// process can be had, `work` is done in this one.
std::optional<std::string> from_child(const std::function<std::string()>& work, double seconds = 10);

/// Whether a child process lives through `work`; exceptions do not count.
bool survives(const std::function<void()>& work);

}  // namespace hourglass
