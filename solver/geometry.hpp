#pragma once
// The geometry of a scene on a patch: solids, orifices whose ends lie within faces, axisymmetric coordinates.
#include <memory>

#include "kernels/boundary.hpp"
#include "kernels/geometry.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// nullptr where nothing of it is in the scene: whole cells and faces, Cartesian coordinates.
std::unique_ptr<Geometry> geometry_of(const Scene& scene, const Boundary& boundary);

}  // namespace hourglass
