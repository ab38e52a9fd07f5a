#pragma once
// Exact area of a polygon inside a rectangle: Sutherland & Hodgman 1974, CACM 17:32.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hourglass {

using Polygon = std::vector<std::array<double, 2>>;  ///< corners in order, either way round [L]

/// The part of the polygon on one side of an axis-parallel line: sign * (p[axis] - at) >= 0.
inline Polygon half_of(const Polygon& polygon, int axis, double at, double sign) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto& a = polygon[k];
    const auto& b = polygon[k + 1 == polygon.size() ? 0 : k + 1];
    const double side_a = sign * (a[axis] - at), side_b = sign * (b[axis] - at);
    if (side_a >= 0) kept.push_back(a);
    if ((side_a < 0 && side_b > 0) || (side_a > 0 && side_b < 0)) {
      const double t = side_a / (side_a - side_b);
      auto cut = a;
      cut[axis] = at;
      cut[1 - axis] += t * (b[1 - axis] - a[1 - axis]);
      kept.push_back(cut);
    }
  }
  return kept;
}

/// Share of the rectangle [x0, x1] x [y0, y1] that the polygon covers, in [0, 1]. Exact to rounding for any
/// polygon that does not cross itself.
inline double covered_fraction(const Polygon& polygon, double x0, double y0, double x1, double y1) {
  Polygon part = half_of(half_of(polygon, 0, x0, 1), 0, x1, -1);
  part = half_of(half_of(part, 1, y0, 1), 1, y1, -1);
  double twice_area = 0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const auto& a = part[k];
    const auto& b = part[k + 1 == part.size() ? 0 : k + 1];
    twice_area += (a[0] - x0) * (b[1] - y0) - (b[0] - x0) * (a[1] - y0);  // from the corner: no cancellation
  }
  return std::min(1.0, 0.5 * std::abs(twice_area) / ((x1 - x0) * (y1 - y0)));
}

}  // namespace hourglass
