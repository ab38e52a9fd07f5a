#include "solver/rheology.hpp"

namespace hourglass {

RheologyStage::RheologyStage(const Scene& scene, const Patch& patch, const Boundary& boundary,
                             const Geometry* geometry)
    : law_(scene.rheology.law),
      properties_(scene), limits_{scene.rheology.eta_min, scene.rheology.eta_max,
                                  scene.air.model == AirModel::none ? 0.0 : scene.air.viscosity,
                                  scene.rheology.background_pressure},
      geometry_(geometry), smooth_cap_(scene.rheology.cap == Cap::smooth),
      deviatoric_(scene.dilatancy.has_value()),
      general_(scene.nonlocal || scene.dilatancy || scene.wall_friction || law_ != Law::mu_I || smooth_cap_ ||
               !properties_.equal_law()),
      axisymmetric_(scene.axisymmetric()), ends_(boundary.ends()), row_counts_(patch.ny) {
  if (scene.wall_friction) wall_force_ = CellField(patch);
  if (law_ == Law::newtonian) return;  // no shear rate needed, none stored
  if (law_ == Law::mu_I_regularised)
    for (const Material& m : scene.materials)
      regularised_.push_back(regularised_friction(m, scene.rheology).value_or(RegularisedFriction{}));
  passes_ = smoothing_passes(scene.rheology.smoothing_length, patch.h);
  gamma2_ = CellField(patch);
  if (passes_.empty()) return;
  weighted_ = CellField(patch);
  weight_ = CellField(patch);
}

void RheologyStage::shear_rate_row(const Fields& fields, int j, double* out) const {
  if (with_modules && deviatoric_) {
    shear_rate_squared_row<true>(fields.u, fields.v, j, out);
  } else {
    shear_rate_squared_row(fields.u, fields.v, j, out);
  }
  if (!axisymmetric_) return;
  const double* u = fields.u.row(j);
  const Patch& patch = fields.patch();
  for (int i = 0; i < patch.nx; ++i) {  // the hoop's share of 2 D:D
    const double hoop = 0.5 * (u[i] + u[i + 1]) / patch.x_centre(i);
    out[i] += 2 * hoop * hoop;
  }
}

/// All but the last half pass of |γ̇|^2 <- Σ c |γ̇|^2 / Σ c over the smoothing kernel, a mean over grains, neither over
/// air nor over walls: numerator and weight after all passes in x and all but one in y. Synced on return.
void RheologyStage::smooth(Team& team, const Fields& fields, CellField& spare) {
  const int nx = weight_.nx();
  const Rows rows = team.rows(weight_.ny());
  double* __restrict line = row_scratch<double>(2 * nx);
  double* open_grains = line + nx;
  for (std::size_t k = 0; k < passes_.size(); ++k) {
    for (int j = rows.begin; j < rows.end; ++j) {
      const double* c = fields.grains.row(j);
      if (k == 0) {
        shear_rate_row(fields, j, line);
        if (geometry_) {
          const double* open = geometry_->volume.row(j);
          for (int i = 0; i < nx; ++i) open_grains[i] = c[i] * open[i];
          c = open_grains;
        }
#pragma omp simd
        for (int i = 0; i < nx; ++i) line[i] *= c[i];
        smooth_row(line, nx, passes_[k], ends_, weighted_.row(j));
        smooth_row(c, nx, passes_[k], ends_, weight_.row(j));
        continue;
      }
      for (CellField* f : {&weighted_, &weight_}) {
        std::copy(f->row(j), f->row(j) + nx, line);
        smooth_row(line, nx, passes_[k], ends_, f->row(j));
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

/// Row j of |γ̇|^2.
void RheologyStage::finish_shear_rate_row(const Fields& fields, int j) {
  double* __restrict g2 = gamma2_.row(j);
  if (passes_.empty()) return shear_rate_row(fields, j, g2);
  const int nx = gamma2_.nx();
  double* __restrict weight = row_scratch<double>(nx);
  smooth_column_row(weighted_, passes_.back(), j, g2);
  smooth_column_row(weight_, passes_.back(), j, weight);
#pragma omp simd
  for (int i = 0; i < nx; ++i)
    g2[i] = weight[i] > 1e-12 ? std::max(g2[i], 0.0) / std::max(weight[i], 1e-12) : 0.0;
}

void RheologyStage::newtonian_row(const Fields& fields, int j, GrainProperties::Rows& properties,
                                  double* eta) {
  const double *c = fields.grains.row(j), *viscosity = properties[GrainProperties::viscosity];
  const int nx = fields.p.nx();
#pragma omp simd
  for (int i = 0; i < nx; ++i) eta[i] = c[i] * viscosity[i] + (1 - c[i]) * limits_.air;
}

/// Row j for every law and module; the plain law of one material is granular_viscosity_row by itself. With a fluidity
/// eta waits for its solve.
void RheologyStage::general_row(const Fields& fields, int j, const Modules& modules, double* eta) {
  GrainProperties::Rows rows(properties_, fields, j);
  const double *c = fields.grains.row(j), *p = fields.p.row(j);
  const int nx = fields.p.nx();
  double* __restrict pressure = rows.scratch(0);
  for (int i = 0; i < nx; ++i) pressure[i] = grain_pressure(p[i], limits_);
  if (wall_force_.allocated()) {
    const double* F = rows[GrainProperties::F];
    double* __restrict out = wall_force_.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i) out[i] = F[i] * pressure[i] * c[i];
    fill_ends(ends_, out, nx);
  }
  if (law_ == Law::newtonian) return newtonian_row(fields, j, rows, eta);

  const double* gamma2 = gamma2_.row(j);
  if (smooth_cap_) {
    smooth_cap_row(gamma2, p, rows[GrainProperties::mu_s], nx, limits_, rows.scratch(1));
    gamma2 = rows.scratch(1);
  }
  const GrainRows law = rows.law();
  if (law_ == Law::mu_I && !modules.fluidity && !modules.dilatancy)
    return granular_viscosity_row(gamma2, p, c, nx, law, limits_, eta);

  double* __restrict I = rows.scratch(2), * __restrict mu = rows.scratch(3);
  friction_row(gamma2, p, nx, law, limits_, I, mu);
  if (law_ == Law::mu_I_regularised) {  // mu by share, for its parameters have no mean
    for (int i = 0; i < nx; ++i) {
      double rest = 1, sum = 0;
      for (std::size_t k = 1; k < regularised_.size(); ++k) {
        const double share = rows.share(static_cast<int>(k))[i];
        sum += share * regularised_[k].mu(I[i], properties_.grain(static_cast<int>(k)));
        rest -= share;
      }
      mu[i] = sum + rest * regularised_[0].mu(I[i], properties_.grain(0));
    }
  }
  if (modules.dilatancy)
    modules.dilatancy->set_row(fields, j, I, mu, gamma2, pressure, rows[GrainProperties::phi_g],
                               law.d_sqrt_rho);
  if (modules.fluidity) {
    modules.fluidity->set_row(fields, j, gamma2, pressure, I, mu, rows);
  } else {
    viscosity_of_friction_row(gamma2, p, c, nx, mu, law.cohesion, limits_, eta);
  }
}

/// Cells of row j that stand at a limit.
void RheologyStage::count_row(const Fields& fields, int j, const double* e) {
  const double* c = fields.grains.row(j);
  const int nx = fields.p.nx();
  const ViscosityLimits limits = limits_;
  double capped = 0, floored = 0;  // numbers, not integers, for the vector unit's sake
#pragma omp simd reduction(+ : capped, floored)
  for (int i = 0; i < nx; ++i) {
    const double air = (1 - c[i]) * limits.air;
    capped += static_cast<double>((c[i] > 0.5) & (e[i] >= 0.999 * c[i] * limits.eta_max));
    floored += static_cast<double>((c[i] > 0.5) & (e[i] <= 1.001 * (c[i] * limits.eta_min + air)));
  }
  row_counts_[j] = {static_cast<long>(capped), static_cast<long>(floored)};
}

RheologyStage::Result RheologyStage::update(Fields& fields, int threads, CellField& eta,
                                            const Modules& modules) {
  Result result;
  const bool newtonian = law_ == Law::newtonian;
  const Grain grain = properties_.grain(0);
  parallel(threads, [&](Team& team) {
    const int nx = eta.nx();
    const Rows rows = team.rows(eta.ny());
    if (!passes_.empty()) smooth(team, fields, eta);
    for (int j = rows.begin; j < rows.end; ++j) {
      if (!newtonian) finish_shear_rate_row(fields, j);
      if (with_modules && general_) {
        general_row(fields, j, modules, eta.row(j));
      } else {
        granular_viscosity_row(gamma2_.row(j), fields.p.row(j), fields.grains.row(j), nx, grain, limits_,
                               eta.row(j));
      }
      if (!newtonian && !(with_modules && modules.fluidity)) count_row(fields, j, eta.row(j));
    }
    if (!with_modules || !modules.fluidity) return;
    team.sync();
    const SolveStats stats = modules.fluidity->solve(team, fields);
    if (team.leads()) result.fluidity = stats;
    for (int j = rows.begin; j < rows.end; ++j) {
      GrainProperties::Rows properties(properties_, fields, j);
      viscosity_of_fluidity_row(fields.fluidity.row(j), gamma2_.row(j), fields.p.row(j), fields.grains.row(j),
                                nx, properties[GrainProperties::cohesion], limits_, eta.row(j));
      count_row(fields, j, eta.row(j));
    }
  });
  if (newtonian) return result;
  for (const LimitCounts& c : row_counts_) {
    result.limits.capped += c.capped;
    result.limits.floored += c.floored;
  }
  return result;
}

}  // namespace hourglass
