#include "solver/boundary_of.hpp"

#include <algorithm>
#include <cmath>

namespace hourglass {

static int face_count(Side side, const Patch& patch) {
  return side == Side::left || side == Side::right ? patch.ny : patch.nx;
}

std::vector<OpenFace> faces_of(const Orifice& o, const Patch& patch) {
  const bool vertical = o.wall == Side::left || o.wall == Side::right;
  const int n = face_count(o.wall, patch);
  const auto in_cells = [&](double at) {
    const double cells = (at - (vertical ? patch.y0 : patch.x0)) / patch.h;
    const double edge = std::round(cells);
    return std::clamp(std::abs(cells - edge) < 1e-6 ? edge : cells, 0.0, static_cast<double>(n));
  };
  const double from = in_cells(o.centre - 0.5 * o.width), to = in_cells(o.centre + 0.5 * o.width);
  std::vector<OpenFace> faces;
  for (int k = static_cast<int>(from); k < to; ++k)
    faces.push_back({k, std::min(to, k + 1.0) - std::max(from, static_cast<double>(k))});
  return faces;
}

std::vector<OpenFace> shares_of(const Orifice& o, const Boundary& boundary, const Patch& patch) {
  const SideFaces& side = o.wall == Side::left     ? boundary.left
                          : o.wall == Side::right  ? boundary.right
                          : o.wall == Side::bottom ? boundary.bottom
                                                   : boundary.top;
  std::vector<OpenFace> faces = faces_of(o, patch);
  for (OpenFace& f : faces) f.open = side.open[f.face] > 0 ? f.open / side.open[f.face] : 0;
  return faces;
}

std::vector<WayOut> ways_out_of(const Scene& scene, const Boundary& boundary) {
  const Patch patch = scene.patch();
  std::vector<WayOut> ways;
  for (std::size_t o = 0; o < scene.orifices.size(); ++o)
    ways.push_back(
        {scene.orifices[o].wall, static_cast<int>(o), shares_of(scene.orifices[o], boundary, patch)});
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top}) {
    if (scene.wall(side) != Wall::open) continue;
    ways.push_back({side, -1, {}});
    for (int f = 0; f < face_count(side, patch); ++f) ways.back().faces.push_back({f, 1});
  }
  return ways;
}

static SideFaces side_of(const Scene& scene, const Patch& patch, Side side) {
  const int n = face_count(side, patch);
  const bool slips = side == Side::left && scene.left_is_middle();
  const Wall wall = slips ? Wall::free_slip : scene.wall(side);
  SideFaces faces;
  faces.open.assign(n, wall == Wall::open ? 1.0 : 0.0);
  for (const Orifice& o : scene.orifices)
    if (o.wall == side)
      for (const OpenFace& f : faces_of(o, patch))
        faces.open[f.face] = std::min(1.0, faces.open[f.face] + f.open);
  const bool no_slip = wall == Wall::no_slip;
  const double edge = !no_slip                                             ? 0
                      : scene.rheology.orifice_edge == EdgeRule::wall      ? 2
                      : scene.rheology.orifice_edge == EdgeRule::half_wall ? 1
                                                                           : 0;
  // An end within a face makes of both corners of the face what lies between a wall's corner, an edge and a free one.
  const auto weight = [&](int before, int after) {
    const double a = 1 - faces.open[before], b = 1 - faces.open[after];
    return no_slip ? 2 * a * b + edge * (a * (1 - b) + b * (1 - a)) : 0;
  };
  faces.shear.resize(n + 1);
  faces.shear[0] = weight(0, 0);
  faces.shear[n] = weight(n - 1, n - 1);
  for (int k = 1; k < n; ++k) faces.shear[k] = weight(k - 1, k);
  return faces;
}

Boundary boundary_of(const Scene& scene) {
  const Patch patch = scene.patch();
  return {side_of(scene, patch, Side::left),        side_of(scene, patch, Side::right),
          side_of(scene, patch, Side::bottom),      side_of(scene, patch, Side::top),
          scene.wall(Side::left) == Wall::periodic, scene.left_is_middle()};
}

}  // namespace hourglass
