#include "solver/rheology.hpp"

namespace hourglass {

RheologyStage::RheologyStage(const Scene& scene, const Patch& patch, const Boundary& boundary)
    : law_(scene.rheology.law), limits_{scene.rheology.eta_min, scene.rheology.eta_max, scene.air.viscosity,
                                        scene.rheology.background_pressure},
      periodic_(boundary.periodic_x), row_counts_(patch.ny) {
  equal_properties_ = true;
  for (const Material& m : scene.materials) {
    grains_.push_back({m.mu_s, m.delta_mu, m.I_0, m.diameter, m.density});
    viscosity_.push_back(m.viscosity);
    const Material& first = scene.materials.front();
    equal_properties_ = equal_properties_ && m.mu_s == first.mu_s && m.delta_mu == first.delta_mu &&
                        m.I_0 == first.I_0 && m.diameter == first.diameter && m.density == first.density &&
                        m.viscosity == first.viscosity;
  }
  if (law_ == Law::newtonian) return;  // no shear rate needed, none stored
  passes_ = smoothing_passes(scene.rheology.smoothing_length, patch.h);
  gamma2_ = CellField(patch);
  if (passes_.empty()) return;
  weighted_ = CellField(patch);
  weight_ = CellField(patch);
}

/// All but the last half pass of |γ̇|^2 <- Σ c |γ̇|^2 / Σ c over the smoothing kernel, a mean over grains, neither over
/// air nor over walls: numerator and weight after all passes in x and all but one in y. Synced on return.
void RheologyStage::smooth(Team& team, const Fields& fields, CellField& spare) {
  const int nx = weight_.nx();
  const Rows rows = team.rows(weight_.ny());
  double* __restrict line = row_scratch<double>(nx);
  for (std::size_t k = 0; k < passes_.size(); ++k) {
    for (int j = rows.begin; j < rows.end; ++j) {
      const double* __restrict c = fields.grains.row(j);
      if (k == 0) {
        shear_rate_squared_row(fields.u, fields.v, j, line);
#pragma omp simd
        for (int i = 0; i < nx; ++i) line[i] *= c[i];
        smooth_row(line, nx, passes_[k], periodic_, weighted_.row(j));
        smooth_row(c, nx, passes_[k], periodic_, weight_.row(j));
        continue;
      }
      for (CellField* f : {&weighted_, &weight_}) {
        std::copy(f->row(j), f->row(j) + nx, line);
        smooth_row(line, nx, passes_[k], periodic_, f->row(j));
      }
    }
    team.sync();
    if (k + 1 == passes_.size()) return;
    for (CellField* f : {&weighted_, &weight_}) {
      for (int j = rows.begin; j < rows.end; ++j) smooth_column_row(*f, passes_[k], j, spare.row(j));
      team.sync();
      if (team.leads()) f->swap(spare);
      team.sync();
    }
  }
}

LimitCounts RheologyStage::update(const Fields& fields, int threads, CellField& eta) {
  parallel(threads, [&](Team& team) {
    const int nx = eta.nx(), ny = eta.ny();
    const Rows rows = team.rows(ny);
    if (law_ == Law::newtonian) {
      for (int j = rows.begin; j < rows.end; ++j)
        for (int i = 0; i < nx; ++i) {
          double rest = fields.grains(i, j), mix = (1 - rest) * limits_.air;
          for (std::size_t k = 0; k < fields.tracers.size(); ++k) {
            mix += fields.tracers[k](i, j) * viscosity_[k + 1];
            rest -= fields.tracers[k](i, j);
          }
          eta(i, j) = mix + rest * viscosity_[0];
        }
      return;
    }
    if (!passes_.empty()) smooth(team, fields, eta);
    double* __restrict weight = row_scratch<double>(nx);
    thread_local std::vector<const double*> tracers;
    tracers.resize(fields.tracers.size());
    for (int j = rows.begin; j < rows.end; ++j) {
      const double *c = fields.grains.row(j), *p = fields.p.row(j);
      double *e = eta.row(j), *__restrict g2 = gamma2_.row(j);
      if (passes_.empty()) {
        shear_rate_squared_row(fields.u, fields.v, j, g2);
      } else {
        smooth_column_row(weighted_, passes_.back(), j, g2);
        smooth_column_row(weight_, passes_.back(), j, weight);
#pragma omp simd
        for (int i = 0; i < nx; ++i)
          g2[i] = weight[i] > 1e-12 ? std::max(g2[i], 0.0) / std::max(weight[i], 1e-12) : 0.0;
      }
      if (equal_properties_) {
        granular_viscosity_row(g2, p, c, nx, grains_[0], limits_, e);
      } else {
        for (std::size_t k = 0; k < tracers.size(); ++k) tracers[k] = fields.tracers[k].row(j);
        blended_viscosity_row(g2, p, c, tracers, nx, grains_, limits_, e);
      }
      double capped = 0, floored = 0;  // numbers, not integers, for the vector unit's sake
#pragma omp simd reduction(+ : capped, floored)
      for (int i = 0; i < nx; ++i) {
        const double air = (1 - c[i]) * limits_.air;
        capped += static_cast<double>((c[i] > 0.5) & (e[i] >= 0.999 * c[i] * limits_.eta_max));
        floored += static_cast<double>((c[i] > 0.5) & (e[i] <= 1.001 * (c[i] * limits_.eta_min + air)));
      }
      row_counts_[j] = {static_cast<long>(capped), static_cast<long>(floored)};
    }
  });
  LimitCounts total;
  if (law_ == Law::newtonian) return total;
  for (const LimitCounts& c : row_counts_) {
    total.capped += c.capped;
    total.floored += c.floored;
  }
  return total;
}

}  // namespace hourglass
