#pragma once
// Pictures of cell fields. render_png takes plain data; picture_of and render_run make it from frames.
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/frame.hpp"
#include "io/scales.hpp"
#include "io/xdmf.hpp"
#include "kernels/polygon.hpp"

namespace hourglass {

/// A stretch of a side that is no wall.
struct Opening {
  Side side = Side::bottom;
  double begin = 0, end = 0;  ///< along the side [L]
};

/// What can be drawn over the colours of a picture, and its words on the command line.
enum class Overlay { quasi_static, streamlines };
inline constexpr std::array overlay_names{"quasi_static", "streamlines"};

struct Picture {
  CellField values;
  CellField grains;                  ///< share of grains; the free surface is its 0.5 contour
  CellField velocity_x, velocity_y;  ///< at cell centres; not allocated: no arrows, no overlays
  std::string title, unit;           ///< of the colour bar
  std::string velocity_unit;         ///< for the note on the arrows
  std::string length_unit, time_unit;
  bool axial = false;                ///< x is the distance from an axis: labelled r, without signs
  std::optional<double> time = 0.0;  ///< nullopt: a steady flow
  bool log_scale = false;
  bool show_air = false;  ///< colour the air too instead of leaving it blank
  ColourMap colours = ColourMap::viridis;
  std::optional<std::array<double, 2>> range;  ///< of the colours; otherwise nice_range() of shown_extremes()
  double tails = 0;  ///< share of the values at either end that need not fit into the range
  std::vector<Opening> openings;
  std::vector<Polygon> solids;  ///< outlines [L]; they may overlap
  std::vector<Overlay> overlays;
  double slow_speed = 0;                ///< below it grains are quasi-static
  std::array<int, 2> least_size{0, 0};  ///< pixels; white is added at the right and above
};

/// Least and largest value that the picture shows outside of solids, of those that its scale can show and less its
/// tails; {inf, -inf} if there is none.
std::array<double, 2> shown_extremes(const Picture& picture);

/// Width and height in pixels.
std::array<int, 2> size_of(const Picture& picture);

/// Draws the field with colour bar, axes, free surface, walls, openings and solids, the overlays, and arrows in the
/// grains, whose length is logarithmic over three decades of speed; streamlines take their place. 1400 pixels wide; a
/// tall domain is 1300 pixels high plus margins. Errors as draw_png() (io/offscreen.hpp).
void render_png(const Picture& picture, const std::filesystem::path& path);

/// The same as the bytes of a PNG file, at half the size so many times.
std::string png_of(const Picture& picture, int halved);

struct PictureOptions {
  std::vector<Overlay> overlays{};
  bool half = false;  ///< of a domain that is one half of what is meant draw only this half
};

/// The picture of one field of a frame. Throws std::invalid_argument if an overlay is not possible.
Picture picture_of(const std::string& field, const Frame& frame, const RunInfo& info,
                   const PictureOptions& options = {});

/// With its mirror image at the left edge. `odd`: the values change sign.
Picture mirrored(const Picture& half, bool odd);

/// The pictures that a run draws of itself, snapshots/<field>_<nnnn>.png in its folder; those of render_run(),
/// pictures/<field>_<nnnn>.png; and those of a video, frames/<field>_<nnnn>.png.
std::filesystem::path snapshot_path(const std::filesystem::path& run, const std::string& field, int number);
std::filesystem::path picture_path(const std::filesystem::path& run, const std::string& field, int number);
std::filesystem::path video_frame_path(const std::filesystem::path& run, const std::string& field,
                                       int number);

/// The picture of one field by frame, in a range that all of `frames` have in common. The reader must outlive it.
std::function<Picture(int frame)> pictures_of(const FieldReader& reader, const std::string& field,
                                              const std::vector<int>& frames,
                                              const PictureOptions& options = {});

struct RenderOptions : PictureOptions {
  std::vector<std::string> fields{};  ///< none: all that are stored
  std::vector<double> times{};        ///< the frame nearest to each; none: all frames
  bool animate = false;               ///< a video of each field, from pictures of one size
};

/// `hourglass render`: draws fields of a stored run, numbered by frame. The pictures of one field share one colour
/// range, so that they compare. Prints the name of each file and returns 0. Throws std::invalid_argument for a field
/// that is not stored, a time outside the run or an overlay that is not possible, std::runtime_error if the run cannot
/// be read or the picture not be drawn or written.
int render_run(const std::filesystem::path& run, const RenderOptions& options);

}  // namespace hourglass
