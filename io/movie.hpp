#pragma once
#include <filesystem>
#include <vector>

namespace hourglass {

/// Pictures of one size, in order, as an Ogg Theora video, which most players and browsers show. The file is
/// replaced in one go. Throws std::runtime_error if it cannot be written.
void write_movie(const std::vector<std::filesystem::path>& pngs, const std::filesystem::path& path,
                 int frames_per_second);

}  // namespace hourglass
