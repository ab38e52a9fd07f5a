#pragma once
// `hourglass report`: a run or a study on one page that needs nothing else. docs/studies.md says what it shows.
#include <filesystem>

namespace hourglass {

/// Writes the page and returns its path: `out`, or report.html in the folder if that is empty. Throws
/// std::invalid_argument if the folder holds neither, std::runtime_error if it cannot be read or written.
std::filesystem::path report(const std::filesystem::path& folder, const std::filesystem::path& out = {});

}  // namespace hourglass
