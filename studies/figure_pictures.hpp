#pragma once
// The pictures of a figure, from what its runs have stored.
#include <filesystem>
#include <vector>

#include "studies/figure.hpp"

namespace hourglass {

/// Draws all of them into a folder, <figure>_<name>.png; returns their paths in the order of the file. Throws
/// std::runtime_error where a run has not stored what a picture needs, and what draw_png() (io/offscreen.hpp) throws.
std::vector<std::filesystem::path> draw_pictures(const Figure& figure, const FigureTable& table,
                                                 const std::filesystem::path& folder);

/// Where one of them goes within the folder.
std::string picture_name(const Figure& figure, const FigurePicture& picture);

}  // namespace hourglass
