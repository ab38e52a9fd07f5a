#pragma once
#include <vector>

#include "kernels/boundary.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// The boundary of a scene's domain, face by face: walls, openings, and the rule at orifice edges. Ends of orifices may
/// lie within a face.
Boundary boundary_of(const Scene& scene);

/// A boundary face and how much of it an orifice opens.
struct OpenFace {
  int face;
  double open;
  bool operator==(const OpenFace&) const = default;
};
/// The faces of an orifice along its side; ends within 1e-6 of a cell edge lie on it.
std::vector<OpenFace> faces_of(const Orifice& orifice, const Patch& patch);
/// The same in shares of what all orifices together open of the face.
std::vector<OpenFace> shares_of(const Orifice& orifice, const Boundary& boundary, const Patch& patch);

/// A way out: an orifice, or a side that is open.
struct WayOut {
  Side side;
  int orifice;                  ///< index into Scene::orifices; -1: the side
  std::vector<OpenFace> faces;  ///< in shares of what is open
};
std::vector<WayOut> ways_out_of(const Scene& scene, const Boundary& boundary);

}  // namespace hourglass
