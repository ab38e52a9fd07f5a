#pragma once
// What of a picture is drawn where, and the arrows that stand there. For the files that draw pictures only.
#include <string>
#include <vector>

#include "io/raster.hpp"
#include "io/render.hpp"
#include "io/streamlines.hpp"

namespace hourglass {

/// Pixels between streamlines, and between arrows, which stand closer where there is little room.
inline constexpr int widest_spacing = 42;

/// Bilinear between cell centres, level beyond the outermost ones; x, y in cells.
double interpolate(const CellField& field, double x, double y);

/// What solids cover, with the pixels of the cover as large as the picture's cells over `scale`.
Cover cover_of(const Picture& picture, int width, int height, double scale);

/// What of a picture is drawn where. Solids have no values of their own: those around are carried on into them, so that
/// lines run smoothly up to their outlines, whether the cells that these cut hold shares of the cell or of what is open.
/// So are those of the grains into the air, so that the smooth surface cuts through coloured cells only.
struct Ground {
  Cover solids;  ///< by cell
  CellField grains, values, velocity_x, velocity_y;

  explicit Ground(const Picture& picture);
  /// Grains, and no solid; x, y in cells.
  bool flows(double x, double y) const { return !solids.holds(x, y) && interpolate(grains, x, y) >= 0.5; }
  Point velocity(double x, double y) const {
    return {interpolate(velocity_x, x, y), interpolate(velocity_y, x, y)};
  }
};

/// Is the overlay asked for, and are there velocities to draw it from?
bool has(const Picture& picture, Overlay overlay);

struct Arrow {
  double x, y, dx, dy;  ///< middle and extent, in cells
  double speed;
};

/// Evenly spread over the domain, where they lie in grains.
std::vector<Arrow> arrows_of(const Picture& picture, const Ground& ground, double cell_pixels);

/// What the length of arrows says; empty if there are none.
std::string arrow_note(const std::vector<Arrow>& arrows, const std::string& unit);

/// The finite values that the picture shows outside of solids.
std::vector<double> shown_values(const Picture& picture);

}  // namespace hourglass
