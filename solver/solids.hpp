#pragma once
// What of the domain is solid: inserts and hopper walls as convex polygons, which may overlap.
#include <vector>

#include "kernels/polygon.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// Corners in order of one insert; a circle as a regular polygon of the circle's area with 720 corners, which lies within
/// 1e-5 of its radius.
Polygon outline_of(const Insert& insert);

/// All solids of a scene, cut into convex polygons.
std::vector<Polygon> solids_of(const Scene& scene);

}  // namespace hourglass
