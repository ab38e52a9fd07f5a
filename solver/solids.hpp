#pragma once
// What of the domain is solid: inserts and hopper walls as convex polygons, which may overlap.
#include <vector>

#include "kernels/polygon.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// Corners in order of one insert; a circle as a regular polygon of the circle's area with 720 corners, which lies
/// within 1e-5 of its radius.
Polygon outline_of(const Insert& insert);

/// Twice the area of a triangle, positive if its corners are in anticlockwise order.
inline double turn(const std::array<double, 2>& a, const std::array<double, 2>& b,
                   const std::array<double, 2>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The hopper's walls, from its outlet up to the sides of the domain, or to its top where that comes first; none
/// without a hopper.
std::vector<Polygon> hopper_walls(const Scene& scene);

/// Closed outlines of all solids of a scene, for drawing: inserts in their order, then the walls of the hopper.
std::vector<Polygon> outlines_of(const Scene& scene);

/// A polygon that does not cross itself, cut into convex ones, which meet but do not overlap.
std::vector<Polygon> convex_pieces(const Polygon& polygon);

/// All solids of a scene, cut into convex polygons.
std::vector<Polygon> solids_of(const Scene& scene);

/// The hopper's outlet [from, to] along the bottom of the domain and beyond a left edge that is its middle.
std::array<double, 2> outlet_of(const Scene& scene);

/// Makes the hopper's outlet the last orifice if there is a hopper and the scene names no orifice at the bottom; says
/// whether it did.
bool open_outlet(Scene& scene);

}  // namespace hourglass
