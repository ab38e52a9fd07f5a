#include "solver/boundary_of.hpp"

#include <algorithm>
#include <cmath>

namespace hourglass {

FaceRange faces_of(const Orifice& o, const Patch& patch) {
  const bool vertical = o.wall == Side::left || o.wall == Side::right;
  const double origin = vertical ? patch.y0 : patch.x0;
  const int n = vertical ? patch.ny : patch.nx;
  const int first = static_cast<int>(std::lround((o.centre - 0.5 * o.width - origin) / patch.h));
  const int last = static_cast<int>(std::lround((o.centre + 0.5 * o.width - origin) / patch.h));
  return {std::clamp(first, 0, n), std::clamp(last, 0, n)};
}

static SideFaces side_of(const Scene& scene, const Patch& patch, Side side) {
  const int n = side == Side::left || side == Side::right ? patch.ny : patch.nx;
  const Wall wall = scene.wall(side);
  SideFaces faces;
  faces.open.assign(n, wall == Wall::open ? 1.0 : 0.0);
  for (const Orifice& o : scene.orifices)
    if (o.wall == side) {
      const FaceRange r = faces_of(o, patch);
      std::fill(faces.open.begin() + r.first, faces.open.begin() + r.last, 1.0);
    }
  const double on_wall = wall == Wall::no_slip ? 2 : 0;
  const EdgeRule rule = scene.rheology.orifice_edge;
  const double on_edge = wall != Wall::no_slip         ? 0
                         : rule == EdgeRule::wall      ? 2
                         : rule == EdgeRule::half_wall ? 1
                                                       : 0;
  const auto weight = [&](int face) { return faces.open[face] > 0 ? 0.0 : on_wall; };
  faces.shear.resize(n + 1);
  faces.shear[0] = weight(0);
  faces.shear[n] = weight(n - 1);
  for (int k = 1; k < n; ++k)
    faces.shear[k] = (faces.open[k - 1] > 0) != (faces.open[k] > 0) ? on_edge : weight(k);
  return faces;
}

Boundary boundary_of(const Scene& scene) {
  const Patch patch = scene.patch();
  return {side_of(scene, patch, Side::left), side_of(scene, patch, Side::right),
          side_of(scene, patch, Side::bottom), side_of(scene, patch, Side::top),
          scene.wall(Side::left) == Wall::periodic};
}

}  // namespace hourglass
