#include "solver/solids.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hourglass {

namespace {

using Point = std::array<double, 2>;

/// Indices of a polygon's corners.
using Loop = std::vector<std::size_t>;

/// Triangles between the corners of an anticlockwise polygon: Meisters 1975, Am. Math. Mon. 82:648.
std::vector<Loop> clip_ears(const Polygon& p, Loop rest) {
  std::vector<Loop> triangles;
  while (rest.size() >= 3) {
    const std::size_t n = rest.size();
    const auto corner = [&](std::size_t k) -> const Point& { return p[rest[k % n]]; };
    std::size_t ear = n;
    for (std::size_t k = 0; k < n && ear == n; ++k) {
      const Point &a = corner(k), &b = corner(k + 1), &c = corner(k + 2);
      if (turn(a, b, c) < 0) continue;
      const bool clear = std::none_of(rest.begin(), rest.end(), [&](std::size_t other) {
        const Point& q = p[other];
        return q != a && q != b && q != c && turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0;
      });
      if (clear || turn(a, b, c) == 0) ear = k;  // a corner on a straight line just goes
    }
    if (ear == n) return triangles;  // it crosses itself
    const Loop triangle{rest[ear], rest[(ear + 1) % n], rest[(ear + 2) % n]};
    if (turn(p[triangle[0]], p[triangle[1]], p[triangle[2]]) > 0) triangles.push_back(triangle);
    rest.erase(rest.begin() + (ear + 1) % n);
  }
  return triangles;
}

bool is_convex(const Polygon& p, const Loop& loop) {
  const std::size_t n = loop.size();
  for (std::size_t k = 0; k < n; ++k)
    if (turn(p[loop[k]], p[loop[(k + 1) % n]], p[loop[(k + 2) % n]]) < 0) return false;
  return true;
}

/// Two loops as one, if they have an edge in common and are convex together.
bool merge(const Polygon& p, Loop& a, const Loop& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (a[i] != b[(j + 1) % b.size()] || a[(i + 1) % a.size()] != b[j]) continue;
      Loop both(a.begin(), a.begin() + i + 1);
      for (std::size_t k = 2; k < b.size(); ++k) both.push_back(b[(j + k) % b.size()]);
      both.insert(both.end(), a.begin() + i + 1, a.end());
      if (!is_convex(p, both)) return false;
      a = std::move(both);
      return true;
    }
  return false;
}

}  // namespace

Polygon outline_of(const Insert& s) {
  const auto [x, y] = s.centre;
  const double a = 0.5 * s.width, b = 0.5 * (s.shape == Shape::square ? s.width : s.height);
  switch (s.shape) {
    case Shape::square:
    case Shape::rectangle:
      return {{x - a, y - b}, {x + a, y - b}, {x + a, y + b}, {x - a, y + b}};
    case Shape::diamond:
      return {{x, y - b}, {x + a, y}, {x, y + b}, {x - a, y}};
    case Shape::triangle_up:
      return {{x - a, y - b}, {x + a, y - b}, {x, y + b}};
    case Shape::triangle_down:
      return {{x, y - b}, {x + a, y + b}, {x - a, y + b}};
    case Shape::circle: {
      constexpr int corners = 720;  // a multiple of 8: as symmetric as the circle on a square grid
      const double step = 2 * M_PI / corners, radius = a * std::sqrt(step / std::sin(step));
      Polygon circle;
      for (int k = 0; k < corners; ++k)
        circle.push_back({x + radius * std::cos((k + 0.5) * step), y + radius * std::sin((k + 0.5) * step)});
      return circle;
    }
    case Shape::polygon:
      break;
  }
  return {s.points.begin(), s.points.end()};
}

std::vector<Polygon> hopper_walls(const Scene& scene) {
  if (!scene.hopper) return {};
  const double middle = scene.left_is_middle() ? 0 : scene.width / 2, edge = outlet_of(scene)[1];
  const double run_per_rise = std::tan(scene.hopper->half_angle * M_PI / 180);
  const double rise = (scene.width - edge) / run_per_rise;
  Polygon right{{edge, 0}, {scene.width, 0}};
  if (rise <= scene.height)
    right.push_back({scene.width, rise});
  else
    right.insert(right.end(),
                 {{scene.width, scene.height}, {edge + scene.height * run_per_rise, scene.height}});
  if (scene.left_is_middle()) return {right};
  Polygon left(right.rbegin(), right.rend());
  for (Point& p : left) p[0] = 2 * middle - p[0];
  return {left, right};
}

std::vector<Polygon> outlines_of(const Scene& scene) {
  std::vector<Polygon> outlines;
  for (const Insert& insert : scene.inserts) outlines.push_back(outline_of(insert));
  for (Polygon& wall : hopper_walls(scene)) outlines.push_back(std::move(wall));
  return outlines;
}

std::vector<Polygon> convex_pieces(const Polygon& polygon) {
  Polygon p = polygon;
  if (twice_signed_area(p) < 0) std::reverse(p.begin(), p.end());
  Loop whole(p.size());
  std::iota(whole.begin(), whole.end(), 0);
  if (is_convex(p, whole)) return {p};
  std::vector<Loop> loops = clip_ears(p, whole);
  for (std::size_t k = 0; k < loops.size(); ++k)  // Hertel & Mehlhorn 1983: at most four times the fewest
    for (std::size_t other = k + 1; other < loops.size();)
      if (merge(p, loops[k], loops[other])) {
        loops.erase(loops.begin() + other);
        other = k + 1;
      } else {
        ++other;
      }
  std::vector<Polygon> pieces;
  for (const Loop& loop : loops) {
    Polygon& piece = pieces.emplace_back();
    for (const std::size_t k : loop) piece.push_back(p[k]);
  }
  return pieces;
}

std::vector<Polygon> solids_of(const Scene& scene) {
  std::vector<Polygon> solids;
  for (const Polygon& outline : outlines_of(scene))
    for (Polygon& piece : convex_pieces(outline)) solids.push_back(std::move(piece));
  return solids;
}

std::array<double, 2> outlet_of(const Scene& scene) {
  const double middle = scene.left_is_middle() ? 0 : scene.width / 2;
  return {middle - scene.hopper->outlet / 2, middle + scene.hopper->outlet / 2};
}

bool open_outlet(Scene& scene) {
  const auto at_bottom = [](const Orifice& o) { return o.wall == Side::bottom; };
  if (!scene.hopper || std::any_of(scene.orifices.begin(), scene.orifices.end(), at_bottom)) return false;
  const auto [from, to] = outlet_of(scene);
  scene.orifices.push_back({Side::bottom, (from + to) / 2, to - from});
  return true;
}

}  // namespace hourglass
