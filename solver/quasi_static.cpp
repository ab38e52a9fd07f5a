#include "solver/quasi_static.hpp"

#include <algorithm>
#include <cmath>

#include "solver/solids.hpp"

namespace hourglass {
namespace {

/// Length that two intervals have in common.
double common(double a0, double a1, double b0, double b1) {
  return std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
}

/// Share of a cell that lies above a flat top; above several, of that which holds most of it.
double share_above(const std::vector<FlatTop>& tops, const Patch& p, int i, int j) {
  double most = 0;
  for (const FlatTop& top : tops)
    most = std::max(most, common(p.x_corner(i), p.x_corner(i + 1), top.x0, top.x1) *
                              common(p.y_corner(j), p.y_corner(j + 1), top.y, HUGE_VAL));
  return most / (p.h * p.h);
}

template <class Speed>
SlowShares shares_of(const CellField& grains, const Speed& speed_at, const Geometry* geometry,
                     const std::vector<FlatTop>& tops, const std::vector<double>& speeds, int threads) {
  const int nx = grains.nx(), ny = grains.ny(), n = static_cast<int>(speeds.size());
  RowSums all(ny);
  std::vector<RowSums> slow(speeds.size(), RowSums(ny)), above(tops.empty() ? 0 : speeds.size(), RowSums(ny));
  double lowest = HUGE_VAL;
  for (const FlatTop& top : tops) lowest = std::min(lowest, top.y);
  parallel(threads, [&](Team& team) {
    const Rows rows = team.rows(ny);
    for (int j = rows.begin; j < rows.end; ++j) {
      const bool in_reach = grains.patch().y_corner(j + 1) > lowest;
      for (int i = 0; i < nx; ++i) {
        const double c = grains(i, j) * (geometry ? geometry->volume(i, j) : 1.0);
        if (c == 0) continue;
        const double speed = speed_at(i, j), on_top = in_reach ? share_above(tops, grains.patch(), i, j) : 0;
        all[j] += c;
        for (int k = 0; k < n; ++k)
          if (speed < speeds[k]) {
            slow[k][j] += c;
            if (on_top > 0) above[k][j] += on_top * c;
          }
      }
    }
  });
  SlowShares out;
  const double total = all.sum();
  for (const RowSums& sums : slow) out.all.push_back(total > 0 ? sums.sum() / total : 0);
  for (const RowSums& sums : above) out.above_flat_tops.push_back(total > 0 ? sums.sum() / total : 0);
  return out;
}

}  // namespace

double grain_speed(const Scene& scene) { return std::sqrt(scene.g() * scene.materials[0].diameter); }

double quasi_static_speed(const Scene& scene) { return quasi_static_thresholds[1] * grain_speed(scene); }

std::vector<FlatTop> flat_tops(const Scene& scene) {
  std::vector<FlatTop> tops;
  if (scene.gravity[0] != 0 || scene.gravity[1] >= 0) return tops;
  for (const Insert& insert : scene.inserts) {
    if (insert.shape == Shape::circle) continue;
    const Polygon outline = outline_of(insert);
    const double turn = twice_signed_area(outline);
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const auto &a = outline[k], &b = outline[k + 1 == outline.size() ? 0 : k + 1];
      // Anticlockwise, the solid lies to the left of its edges.
      if (a[1] == b[1] && turn * (b[0] - a[0]) < 0)
        tops.push_back({std::min(a[0], b[0]), std::max(a[0], b[0]), a[1]});
    }
  }
  return tops;
}

SlowShares slow_shares(const Fields& f, const Geometry* geometry, const std::vector<FlatTop>& tops,
                       const std::vector<double>& speeds, int threads) {
  return shares_of(
      f.grains, [&](int i, int j) { return cell_speed(f, i, j); }, geometry, tops, speeds, threads);
}

SlowShares slow_shares(const CellField& grains, const CellField& speed, const Geometry* geometry,
                       const std::vector<FlatTop>& tops, const std::vector<double>& speeds, int threads) {
  return shares_of(grains, speed, geometry, tops, speeds, threads);
}

std::vector<double> slow_speeds(const Scene& scene) {
  std::vector<double> speeds;
  for (const double threshold : quasi_static_thresholds) speeds.push_back(threshold * grain_speed(scene));
  return speeds;
}

void tell_slow(const SlowShares& shares, SeriesRow& row) {
  row.quasi_static_1e2 = shares.all[0];
  row.quasi_static_fraction = shares.all[1];
  row.quasi_static_1e4 = shares.all[2];
  if (!shares.above_flat_tops.empty()) row.quasi_static_above_flat_top = shares.above_flat_tops[1];
}

}  // namespace hourglass
