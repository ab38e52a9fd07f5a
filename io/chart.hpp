#pragma once
// Charts: curves and points with their errors, and values over a plane of two parameters. Drawn without a display
// (io/offscreen.hpp), in the type and the ink of the pictures of fields.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/scales.hpp"

namespace hourglass {

/// Colours that readers who do not see red or green tell apart too: Okabe & Ito 2008, less the yellow.
inline constexpr std::array<Colour, 7> palette{{{0, 114, 178},
                                                {213, 94, 0},
                                                {0, 158, 115},
                                                {204, 121, 167},
                                                {230, 159, 0},
                                                {86, 180, 233},
                                                {40, 40, 40}}};

struct Axis {
  std::string title{};  ///< with its unit, "time [√(d/g)]"
  bool log = false;
  /// lo < hi, on a log axis 0 < lo; without one, all that is shown with some room.
  std::optional<std::array<double, 2>> range{};
};

enum class Mark { none, disc, ring, square, diamond, triangle };

/// Points that are not finite, or not above 0 on a log axis, are left out; lines are broken there.
struct Series {
  std::string name{};  ///< in the legend; empty: not there
  std::vector<double> x{}, y{};
  bool line = true, dashed = false;
  Mark mark = Mark::none;
  int colour = 0;                        ///< of the palette, which begins anew after its last
  bool greyed = false;                   ///< kept for the record, behind the others
  std::vector<double> error{};           ///< of y by point, drawn as a bar up and down; empty: none
  std::vector<double> lower{}, upper{};  ///< a band by point; empty: none
  std::vector<std::string> labels{};     ///< beside the points, where there is room; empty: none
};

/// A line across the plot with a label outside of it.
struct ReferenceLine {
  enum class Way { vertical, horizontal };
  Way way = Way::horizontal;
  double at = 0;  ///< on the axis that it crosses
  std::string label{};
};

struct Chart {
  std::string title{};  ///< above; empty: none
  Axis x{}, y{};
  std::vector<Series> series{};
  std::vector<ReferenceLine> lines{};
  int width = 1100, height = 820;  ///< of the plot within its axes, in pixels; the picture is larger
};

/// The legend stands at the right of the plot. Throws what draw_png() does.
void draw_chart(const Chart& chart, const std::filesystem::path& path);

/// Values on a rectangle of two parameters.
struct HeatMap {
  std::string title{};
  Axis x{}, y{}, value{};  ///< value: of the colour bar
  ColourMap colours = ColourMap::viridis;
  /// Where the values were taken, rising; each fills the middle between its neighbours.
  std::vector<double> at_x{}, at_y{};
  std::vector<double> values{};    ///< row by row: values[j * at_x.size() + i]; NaN: blank
  std::vector<double> contours{};  ///< lines of constant value
  std::string contour_name{};      ///< in the legend
  std::vector<Series> over{};      ///< curves and labelled points on top
  int width = 900, height = 820;   ///< as of a chart
};

/// Throws std::invalid_argument if the numbers of places and values differ, and what draw_png() does.
void draw_heat_map(const HeatMap& map, const std::filesystem::path& path);

}  // namespace hourglass
