#pragma once
// The grains of a scene's fills on its grid.
#include <vector>

#include "kernels/field.hpp"
#include "kernels/geometry.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// Share of each cell's open part that is filled by grains and by each material beyond the first: exactly the
/// areas of the fills that no later fill hides. All fields are allocated, with as many tracers as materials
/// less one; geometry: nullptr, or that of the scene.
void paint(const Scene& scene, const Geometry* geometry, CellField& grains, std::vector<CellField>& tracers);

}  // namespace hourglass
