#pragma once
// The developed flow of the base silo on any grid, for benchmarks.
#include <cmath>
#include <map>
#include <memory>
#include <tuple>

#include "kernels/vof_sweep.hpp"
#include "tests/support/make_scene.hpp"

namespace hourglass::perf {

/// Twice as fine: shares by their straight interfaces, the rest linear (the first step projects the
/// velocity).
inline void refine(const Fields& coarse, Fields& fine) {
  Fields from = coarse;
  const int nx = from.patch().nx, ny = from.patch().ny;
  fill_vof_halo({}, {0, ny}, from.grains);
  // Along an axis that a location is staggered in, i lies on a coarse point or between two; else a quarter
  // of a coarse cell beside one.
  const auto linear = [](const auto& f, bool staggered_x, bool staggered_y, int i, int j) {
    const auto points = [](bool staggered, int k, int n) {  // two coarse points and the weight of the first
      const int near = k / 2, other = staggered ? (k + 1) / 2 : k % 2 == 0 ? near - 1 : near + 1;
      return std::tuple{near, std::clamp(other, 0, n - 1), staggered ? 0.5 : 0.75};
    };
    const auto [i0, i1, wx] = points(staggered_x, i, f.nx());
    const auto [j0, j1, wy] = points(staggered_y, j, f.ny());
    return wy * (wx * f(i0, j0) + (1 - wx) * f(i1, j0)) + (1 - wy) * (wx * f(i0, j1) + (1 - wx) * f(i1, j1));
  };
  const auto each = [](auto& f, auto value) {
    for (int j = 0; j < f.ny(); ++j)
      for (int i = 0; i < f.nx(); ++i) f(i, j) = value(i, j);
  };
  each(fine.u, [&](int i, int j) { return linear(from.u, true, false, i, j); });
  each(fine.v, [&](int i, int j) { return linear(from.v, false, true, i, j); });
  each(fine.p, [&](int i, int j) { return linear(from.p, false, false, i, j); });
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const double share = from.grains(i, j);
      Block block;
      gather<At::xface>(
          i, j, [&](int a, int b) { return from.grains(a, b); }, block);
      const Line line = share > 0 && share < 1 ? reconstruct(block) : Line{};
      for (int b : {0, 1})
        for (int a : {0, 1}) {  // quarters, counted from the corner that the grains fill first
          const double x = 0.5 * (line.nx < 0 ? 1 - a : a), y = 0.5 * (line.ny < 0 ? 1 - b : b);
          const bool straight = line.nx != 0 || line.ny != 0;
          const double quarter =
              area_in_rectangle(std::abs(line.nx), std::abs(line.ny), line.alpha, x, y, 0.5, 0.5);
          fine.grains(2 * i + a, 2 * j + b) = straight ? std::clamp(4 * quarter, 0.0, 1.0) : share;
        }
    }
}

/// The developed flow at n: grown at 128 cells, then refined.
inline const Fields& developed(int n) {
  static std::map<int, std::unique_ptr<Fields>> known;
  auto& fields = known[n];
  if (!fields) {
    fields = std::make_unique<Fields>(silo(n).patch(), 1);
    if (n <= 128) {
      Simulation grown(silo(n));
      while (grown.t() < 10) grown.step();
      *fields = grown.fields();
    } else {
      refine(developed(n / 2), *fields);
    }
  }
  return *fields;
}

/// The same, put into a simulation of that grid; what else it holds starts as the grains say.
inline void start_developed(Simulation& simulation) {
  Fields& to = simulation.fields();
  const Fields& from = developed(to.patch().nx);
  to.u = from.u;
  to.v = from.v;
  to.p = from.p;
  to.grains = from.grains;
  if (!to.solid.empty()) to.solid[0] = from.grains;
}

}  // namespace hourglass::perf
