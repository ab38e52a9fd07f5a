#include "solver/time_step.hpp"

#include <cmath>

#include "kernels/norms.hpp"

namespace hourglass {

const char* name_of(DtLimit limit) {
  switch (limit) {
    case DtLimit::dt_max:
      return "dt_max";
    case DtLimit::cfl:
      return "cfl";
    case DtLimit::cfl_air:
      return "cfl_air";
    case DtLimit::growth:
      return "growth";
    case DtLimit::end:
      return "end";
    case DtLimit::back_off:
      return "back_off";
  }
  return "";
}

FastestCells fastest_cells(const Fields& fields, int threads, std::array<RowSums, 2>& by_row) {
  const int nx = fields.p.nx(), ny = fields.p.ny();
  RowSums &near = by_row[0], &air = by_row[1];
  parallel(threads, [&](Team& team) {
    const Rows rows = team.rows(ny);
    double* __restrict by_grains = row_scratch<double>(2 * nx);
    double* __restrict in_air = by_grains + nx;
    for (int j = rows.begin; j < rows.end; ++j) {
      const double *u = fields.u.row(j), *vs = fields.v.row(j), *vn = fields.v.row(j + 1);
      const double *c = fields.grains.row(j), *below = fields.grains.row(j - 1),
                   *above = fields.grains.row(j + 1);
#pragma omp simd
      for (int i = 0; i < nx; ++i) {
        const double speed =
            std::max(std::abs(u[i]), std::abs(u[i + 1])) + std::max(std::abs(vs[i]), std::abs(vn[i]));
        const double any = (c[i - 1] + c[i] + c[i + 1]) + (below[i] + above[i]);
        by_grains[i] = any > 0 ? speed : 0.0;
        in_air[i] = any > 0 ? 0.0 : speed;
      }
      near[j] = max_magnitude(by_grains, nx);
      air[j] = max_magnitude(in_air, nx);
    }
  });
  return {near.max(), air.max()};
}

TimeStep choose_time_step(const Scene& scene, const FastestCells& fastest, double h, double dt_before,
                          double t_left, double dt_most) {
  TimeStep best{scene.accuracy.step_factor * scene.time.dt_max, DtLimit::dt_max};
  const auto limit = [&](double dt, DtLimit by) {
    if (dt < best.dt) best = {dt, by};
  };
  limit(dt_most, DtLimit::back_off);
  const double g = scene.g();
  if (fastest.near_grains > 0) limit(scene.time.cfl * h / fastest.near_grains, DtLimit::cfl);
  if (fastest.air > 0) limit(0.9 * h / fastest.air, DtLimit::cfl_air);
  if (dt_before > 0) {
    limit(1.25 * dt_before, DtLimit::growth);
  } else if (g > 0) {
    limit(0.1 * std::sqrt(h / g), DtLimit::growth);
  }
  // All that is left, if no more than rounding is beyond the step: it would be a step of its own, of 1e-15.
  if (t_left < best.dt * (1 + 1e-9)) best = {t_left, DtLimit::end};
  return best;
}

}  // namespace hourglass
