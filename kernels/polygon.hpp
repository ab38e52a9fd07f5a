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

/// The part of the polygon inside of a rectangle.
inline Polygon part_in(const Polygon& polygon, double x0, double y0, double x1, double y1) {
  return half_of(half_of(half_of(half_of(polygon, 0, x0, 1), 0, x1, -1), 1, y0, 1), 1, y1, -1);
}

/// Twice the area, positive anticlockwise; coordinates are taken from the first corner: no cancellation.
inline double twice_signed_area(const Polygon& p) {
  double sum = 0;
  for (std::size_t k = 1; k + 1 < p.size(); ++k)
    sum += (p[k][0] - p[0][0]) * (p[k + 1][1] - p[0][1]) - (p[k + 1][0] - p[0][0]) * (p[k][1] - p[0][1]);
  return sum;
}
inline double area(const Polygon& p) { return 0.5 * std::abs(twice_signed_area(p)); }

/// The part of a polygon inside of a convex one.
inline Polygon part_inside(Polygon polygon, const Polygon& convex) {
  const double turn = twice_signed_area(convex) >= 0 ? 1 : -1;
  for (std::size_t k = 0; k < convex.size() && !polygon.empty(); ++k) {
    const auto& a = convex[k];
    const auto& b = convex[k + 1 == convex.size() ? 0 : k + 1];
    const auto side = [&](const std::array<double, 2>& p) {
      return turn * ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]));
    };
    Polygon kept;
    for (std::size_t m = 0; m < polygon.size(); ++m) {
      const auto& p = polygon[m];
      const auto& q = polygon[m + 1 == polygon.size() ? 0 : m + 1];
      const double sp = side(p), sq = side(q);
      if (sp >= 0) kept.push_back(p);
      if ((sp < 0 && sq > 0) || (sp > 0 && sq < 0)) {
        const double t = sp / (sp - sq);
        kept.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
      }
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// Area of a polygon that none of the convex `covers` from index `first` on hides.
inline double visible_area(const Polygon& polygon, const std::vector<Polygon>& covers, std::size_t first) {
  if (polygon.size() < 3) return 0;
  for (; first < covers.size(); ++first) {
    const Polygon hidden = part_inside(polygon, covers[first]);
    if (area(hidden) > 0)
      return visible_area(polygon, covers, first + 1) - visible_area(hidden, covers, first + 1);
  }
  return area(polygon);
}

/// Share of the rectangle [x0, x1] x [y0, y1] that the polygon covers, in [0, 1]. Exact to rounding for any
/// polygon that does not cross itself.
inline double covered_fraction(const Polygon& polygon, double x0, double y0, double x1, double y1) {
  return std::min(1.0, area(part_in(polygon, x0, y0, x1, y1)) / ((x1 - x0) * (y1 - y0)));
}

}  // namespace hourglass
