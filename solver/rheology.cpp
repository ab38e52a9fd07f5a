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
  if (!passes_.empty()) weight_ = CellField(patch);
}

/// |γ̇|^2 <- Σ c |γ̇|^2 / Σ c over the smoothing kernel: a mean over grains, neither over air nor over walls.
void RheologyStage::smooth(Team& team, CellField& spare) {
  const int nx = gamma2_.nx();
  const Rows rows = team.rows(gamma2_.ny());
  thread_local std::vector<double> scratch;
  scratch.resize(nx);
  for (const SmoothingPass& pass : passes_)
    for (CellField* f : {&gamma2_, &weight_}) {
      for (int j = rows.begin; j < rows.end; ++j) smooth_row(f->row(j), nx, pass, periodic_, scratch.data());
      team.sync();
      smooth_column(team, *f, pass, spare);
      team.sync();
      if (team.leads()) f->swap(spare);
      team.sync();
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
    hourglass::shear_rate_squared(team, fields.u, fields.v, gamma2_);
    if (!passes_.empty()) {
      for (int j = rows.begin; j < rows.end; ++j) {
        const double* c = fields.grains.row(j);
        double *a = gamma2_.row(j), *w = weight_.row(j);
        for (int i = 0; i < nx; ++i) {
          w[i] = c[i];
          a[i] *= c[i];
        }
      }
      smooth(team, eta);
      for (int j = rows.begin; j < rows.end; ++j) {
        const double* w = weight_.row(j);
        double* a = gamma2_.row(j);
        for (int i = 0; i < nx; ++i) a[i] = w[i] > 1e-12 ? std::max(a[i], 0.0) / w[i] : 0;
      }
    }
    std::vector<const double*> tracers(fields.tracers.size());
    for (int j = rows.begin; j < rows.end; ++j) {
      const double *c = fields.grains.row(j), *p = fields.p.row(j);
      double* e = eta.row(j);
      if (equal_properties_) {
        granular_viscosity_row(gamma2_.row(j), p, c, nx, grains_[0], limits_, e);
      } else {
        for (std::size_t k = 0; k < tracers.size(); ++k) tracers[k] = fields.tracers[k].row(j);
        blended_viscosity_row(gamma2_.row(j), p, c, tracers, nx, grains_, limits_, e);
      }
      LimitCounts counts;
      for (int i = 0; i < nx; ++i) {
        counts.capped += c[i] > 0.5 && e[i] >= 0.999 * c[i] * limits_.eta_max;
        counts.floored += c[i] > 0.5 && e[i] <= 1.001 * (c[i] * limits_.eta_min + (1 - c[i]) * limits_.air);
      }
      row_counts_[j] = counts;
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
