#pragma once
// Pictures side by side, for comparing.
#include <filesystem>
#include <string>
#include <vector>

namespace hourglass {

struct Panel {
  std::filesystem::path picture;  ///< PNG
  std::string label;              ///< above it
};

/// Row by row, each picture scaled down to `panel_width` pixels (none is scaled up). Throws std::runtime_error if a picture
/// cannot be read, and what draw_png() does.
void draw_montage(const std::vector<Panel>& panels, int columns, int panel_width,
                  const std::filesystem::path& path);

}  // namespace hourglass
