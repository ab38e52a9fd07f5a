#pragma once
// The grains of a scene's fills on its grid.
#include "kernels/geometry.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// The shares of each cell's open part that grains and the materials beyond the first fill: exactly the areas of
/// the fills that no later fill hides. geometry: nullptr, or that of the scene.
void paint(const Scene& scene, const Geometry* geometry, Fields& fields);

}  // namespace hourglass
