#include "studies/field_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "solver/solids.hpp"

namespace hourglass {
namespace {

bool within(const Polygon& convex, double x, double y) {
  const double way = twice_signed_area(convex) >= 0 ? 1 : -1;
  for (std::size_t k = 0; k < convex.size(); ++k)
    if (way * turn(convex[k], convex[(k + 1) % convex.size()], {x, y}) <= 0) return false;
  return !convex.empty();
}

}  // namespace

FieldPoint::FieldPoint(const Scene& scene, const Geometry* geometry, double x, double y) : x_(x), y_(y) {
  const Patch p = scene.patch();
  const double height = p.ny * p.h, west = scene.left_is_middle() ? -scene.width : 0;
  if (!(x >= west && x <= scene.width && y >= 0 && y <= height))
    throw std::invalid_argument(
        fmt::format("({}, {}) lies outside of the silo, which is x from {} to {}, y from 0 to {}", x, y, west,
                    scene.width, height));
  const std::vector<Polygon> solids = solids_of(scene);
  if (std::ranges::any_of(solids, [&](const Polygon& solid) { return within(solid, std::abs(x), y); }))
    return;
  const bool periodic = scene.wall(Side::left) == Wall::periodic;
  const auto add = [&](int i, int j, double weight) {
    const bool image = i < 0 && scene.left_is_middle();
    if (image) i = -1 - i;
    i = periodic ? (i + p.nx) % p.nx : std::clamp(i, 0, p.nx - 1);
    j = std::clamp(j, 0, p.ny - 1);
    if (!geometry || geometry->volume(i, j) > 0) cells_.push_back({i, j, weight, image});
  };
  const double a = (x - p.x0) / p.h - 0.5, b = (y - p.y0) / p.h - 0.5;
  const int i = static_cast<int>(std::floor(a)), j = static_cast<int>(std::floor(b));
  const double s = a - i, t = b - j;
  // The nearest centre is that of the cell that holds the place.
  const int di = s < 0.5 ? 0 : 1, dj = t < 0.5 ? 0 : 1;
  const auto weight = [&](int m, int n) { return (m == 0 ? 1 - s : s) * (n == 0 ? 1 - t : t); };
  add(i + di, j + dj, weight(di, dj));
  if (cells_.empty()) return;
  add(i + 1 - di, j + dj, weight(1 - di, dj));
  add(i + di, j + 1 - dj, weight(di, 1 - dj));
  add(i + 1 - di, j + 1 - dj, weight(1 - di, 1 - dj));
}

double FieldPoint::value(const std::string& field, const CellField& values, const CellField& grains) const {
  double sum = 0, weights = 0;
  for (const Cell& cell : cells_) {
    if (field != "grains" && grains(cell.i, cell.j) < 0.5) {
      if (&cell == &cells_.front()) break;
      continue;
    }
    sum += cell.weight * values(cell.i, cell.j) * (cell.image && field == "velocity_x" ? -1 : 1);
    weights += cell.weight;
  }
  return weights > 0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace hourglass
