#pragma once
// Pictures of cell fields. render_png takes plain data; picture_of and render_run make it from frames.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/frame.hpp"
#include "io/scales.hpp"

namespace hourglass {

/// A stretch of a side that is no wall.
struct Opening {
  Side side = Side::bottom;
  double begin = 0, end = 0;  ///< along the side [L]
};

struct Picture {
  CellField values;
  CellField grains;                  ///< share of grains; the free surface is its 0.5 contour
  CellField velocity_x, velocity_y;  ///< at cell centres; not allocated: no arrows
  std::string title, unit;           ///< of the colour bar
  std::string velocity_unit;         ///< for the note on the arrows
  std::string length_unit, time_unit;
  double time = 0;
  bool log_scale = false;
  bool show_air = false;  ///< colour the air too instead of leaving it blank
  ColourMap colours = ColourMap::viridis;
  std::optional<std::array<double, 2>> range;  ///< of the colours; otherwise nice_range() of shown_extremes()
  std::vector<Opening> openings;
};

/// Least and largest value that the picture shows, of those that its scale can show; {inf, -inf} if there is
/// none.
std::array<double, 2> shown_extremes(const Picture& picture);

/// Draws the field with colour bar, axes, free surface, walls and openings, and arrows in the grains, whose
/// length is logarithmic over three decades of speed. 1400 pixels wide; a tall domain is 1300 pixels high
/// plus margins. Errors as draw_png() (io/offscreen.hpp).
void render_png(const Picture& picture, const std::filesystem::path& path);

/// The picture of one field of a frame.
Picture picture_of(const std::string& field, const Frame& frame, const RunInfo& info);

/// snapshots/<field>_<nnnn>.png in a run folder.
std::filesystem::path snapshot_path(const std::filesystem::path& run, const std::string& field, int number);

/// `hourglass render`: draws fields of a stored run into its snapshots folder, numbered by frame; where that
/// would be the number of another snapshot of the run, as <field>_t<time>.png. No fields: all that are
/// stored; no times: all frames, otherwise the frame nearest each time. The pictures of one field share one
/// colour range, so that they compare. Prints the name of each file and returns 0. Throws
/// std::invalid_argument for a field that is not stored or a time outside the run, std::runtime_error if the
/// run cannot be read or the picture not be drawn or written.
int render_run(const std::filesystem::path& run, const std::vector<std::string>& fields,
               const std::vector<double>& times);

}  // namespace hourglass
