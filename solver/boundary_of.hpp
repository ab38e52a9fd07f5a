#pragma once
#include "kernels/boundary.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// The boundary of a scene's domain, face by face: walls, openings, and the rule at orifice edges.
Boundary boundary_of(const Scene& scene);

/// Boundary faces [first, last) of an orifice along its side.
struct FaceRange {
  int first, last;
};
FaceRange faces_of(const Orifice& orifice, const Patch& patch);

}  // namespace hourglass
