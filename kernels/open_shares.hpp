#pragma once
// Exact shares of cells and faces that convex polygons leave open, where they may overlap.
#include <algorithm>
#include <vector>

#include "kernels/polygon.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Corners within this of a grid line, in cells, are taken to lie on it.
inline constexpr double snap = 1e-9;

/// The polygons with their corners snapped to the grid lines of the patch.
inline std::vector<Polygon> snapped(std::vector<Polygon> polygons, const Patch& patch) {
  const std::array<double, 2> origin{patch.x0, patch.y0};
  for (Polygon& p : polygons)
    for (auto& corner : p)
      for (int axis = 0; axis < 2; ++axis) {
        const double line = std::round((corner[axis] - origin[axis]) / patch.h);
        const double at = origin[axis] + line * patch.h;
        if (std::abs(corner[axis] - at) < snap * patch.h) corner[axis] = at;
      }
  return polygons;
}

/// Lowest and highest coordinate of a polygon.
inline std::array<double, 2> range_of(const Polygon& p, int axis) {
  const auto [low, high] = std::minmax_element(
      p.begin(), p.end(), [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  return {(*low)[axis], (*high)[axis]};
}

/// Open share of each cell [1], exact to rounding. in: convex polygons, snapped.
inline CellField open_volume(const std::vector<Polygon>& solids, const Patch& patch) {
  CellField open(patch, 1);
  const auto cells = [](double from, double to, int n) {
    return std::array{std::clamp(static_cast<int>(std::floor(from)), 0, n),
                      std::clamp(static_cast<int>(std::ceil(to)), 0, n)};
  };
  std::vector<Polygon> covers;
  for (std::size_t k = 0; k < solids.size(); ++k) {
    const auto [low, high] = range_of(solids[k], 1);
    const auto [first, last] = cells((low - patch.y0) / patch.h, (high - patch.y0) / patch.h, patch.ny);
    for (int j = first; j < last; ++j) {
      const double y0 = patch.y_corner(j), y1 = patch.y_corner(j + 1);
      const Polygon strip =
          half_of(half_of(solids[k], 1, y0, 1), 1, y1, -1);  // row by row: circles have many corners
      if (strip.size() < 3) continue;
      const auto [left, right] = range_of(strip, 0);
      const auto [begin, end] = cells((left - patch.x0) / patch.h, (right - patch.x0) / patch.h, patch.nx);
      covers.clear();
      for (std::size_t m = k + 1; m < solids.size(); ++m) {
        Polygon cover = half_of(half_of(solids[m], 1, y0, 1), 1, y1, -1);
        if (cover.size() >= 3) covers.push_back(std::move(cover));
      }
      for (int i = begin; i < end; ++i) {
        const double x0 = patch.x_corner(i), x1 = patch.x_corner(i + 1);
        const Polygon part = half_of(half_of(strip, 0, x0, 1), 0, x1, -1);
        open(i, j) -= visible_area(part, covers, 0) / (patch.h * patch.h);
      }
    }
  }
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      open(i, j) = open(i, j) < snap ? 0 : open(i, j) > 1 - snap ? 1 : open(i, j);
  return open;
}

/// Open share of each face [1], boundary faces included; a face along the side of a polygon is closed. in: convex polygons,
/// snapped.
inline Velocity open_faces(const std::vector<Polygon>& solids, const Patch& patch) {
  Velocity open(patch);
  std::vector<std::array<double, 2>> closed;
  // Along the line where coordinate `axis` is `at`: what convex polygons cover of it, in order.
  const auto cover_line = [&](int axis, double at) {
    closed.clear();
    for (const Polygon& p : solids) {
      double low = INFINITY, high = -INFINITY;
      const auto meet = [&](double along) {
        low = std::min(low, along);
        high = std::max(high, along);
      };
      for (std::size_t k = 0; k < p.size(); ++k) {
        const auto &a = p[k], &b = p[k + 1 == p.size() ? 0 : k + 1];
        if (a[axis] == at) meet(a[1 - axis]);
        if ((a[axis] < at) != (b[axis] < at) && b[axis] != at && a[axis] != at)
          meet(a[1 - axis] + (at - a[axis]) / (b[axis] - a[axis]) * (b[1 - axis] - a[1 - axis]));
      }
      if (high > low) closed.push_back({low, high});
    }
    std::sort(closed.begin(), closed.end());
  };
  const auto open_share = [&](double from, double to) {
    double covered = 0, reached = from;
    for (const auto& [low, high] : closed) {
      covered += std::max(0.0, std::min(high, to) - std::max(low, reached));
      reached = std::max(reached, std::min(high, to));
    }
    const double share = 1 - covered / (to - from);
    return share < snap ? 0 : share > 1 - snap ? 1 : share;
  };
  for (int i = 0; i <= patch.nx; ++i) {
    cover_line(0, patch.x_corner(i));
    for (int j = 0; j < patch.ny; ++j) open.u(i, j) = open_share(patch.y_corner(j), patch.y_corner(j + 1));
  }
  for (int j = 0; j <= patch.ny; ++j) {
    cover_line(1, patch.y_corner(j));
    for (int i = 0; i < patch.nx; ++i) open.v(i, j) = open_share(patch.x_corner(i), patch.x_corner(i + 1));
  }
  return open;
}

}  // namespace hourglass
