#include "solver/projection.hpp"

#include <array>

#include "kernels/norms.hpp"

namespace hourglass {

template <class T>
Projection<T>::Projection(const Patch& patch, const Boundary& boundary, bool compliant,
                          const Geometry* geometry, const FreeSurface* surface, int extra_sweeps)
    : geometry_(geometry), surface_(surface), multigrid_(patch, boundary, 2 + extra_sweeps), krylov_(patch),
      q_(patch), rhs_(patch), largest_(patch.ny), speed_(patch.ny) {
  if (compliant || surface)
    multigrid_.each_level(
        [](PoissonLevel<T>& level) { level.a.absorption = CellFieldOf<T>(level.x.patch()); });
}

template <class T>
void Projection<T>::assemble(Team& team, const CellField& with_air, const CellField* compliance, double dt) {
  const CellField& density = surface_ ? surface_->density() : with_air;
  PoissonLevel<T>& level = multigrid_.finest();
  const Boundary& boundary = level.boundary();
  const int nx = density.nx(), ny = density.ny();
  const Rows rows = team.rows(ny + 1);
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const double* rho = density.row(j);
      T* __restrict b = level.a.beta.u.row(j);
#pragma omp simd
      for (int i = 0; i <= nx; ++i) b[i] = static_cast<T>(2 / (rho[i - 1] + rho[i]));
      if (!boundary.periodic_x) {
        b[0] = static_cast<T>(2 * boundary.left.open[j] / rho[0]);
        b[nx] = static_cast<T>(2 * boundary.right.open[j] / rho[nx - 1]);
      }
      if (geometry_) {
        const double* open = geometry_->aperture.u.row(j);
        const auto beta = [&](int i, double twice_rho) { b[i] = static_cast<T>(2 * open[i] / twice_rho); };
#pragma omp simd
        for (int i = 1; i < nx; ++i) beta(i, rho[i - 1] + rho[i]);
        beta(0, boundary.periodic_x ? rho[-1] + rho[0] : rho[0]);
        beta(nx, boundary.periodic_x ? rho[nx - 1] + rho[nx] : rho[nx - 1]);
      }
      if (with_modules && level.a.absorption.allocated()) {  // compliance δp, δp = q h/dt, for ∇·u h
        T* __restrict kappa = level.a.absorption.row(j);
        const double scale = compliance ? density.patch().h * density.patch().h / dt : 0;
        for (int i = 0; i < nx; ++i) kappa[i] = static_cast<T>(compliance ? scale * (*compliance)(i, j) : 0);
        for (int i = 0; geometry_ && i < nx; ++i) kappa[i] *= static_cast<T>(geometry_->volume(i, j));
      }
    }
    T* __restrict b = level.a.beta.v.row(j);
    if (j > 0 && j < ny) {
      const double *below = density.row(j - 1), *above = density.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i) b[i] = static_cast<T>(2 / (below[i] + above[i]));
    } else {
      const SideFaces& side = j == 0 ? boundary.bottom : boundary.top;
      const double* rho = density.row(j == 0 ? 0 : ny - 1);
      for (int i = 0; i < nx; ++i) b[i] = static_cast<T>(2 * side.open[i] / rho[i]);
    }
    if (geometry_) {
      const double* open = geometry_->aperture.v.row(j);
      const double *below = density.row(std::max(j - 1, 0)), *above = density.row(std::min(j, ny - 1));
      const double both = j > 0 && j < ny ? 2 : 4;
#pragma omp simd
      for (int i = 0; i < nx; ++i) b[i] = static_cast<T>(both * open[i] / (below[i] + above[i]));
    }
  }
  team.sync();
  if (surface_) {
    end_at_surface(rows);
    team.sync();
  }
  level.finish(team);
  multigrid_.coarsen(team);
}

template <class T>
void Projection<T>::end_at_surface(Rows rows) {
  auto& a = multigrid_.finest().a;
  const CellField& liquid = surface_->liquid();
  const bool periodic = multigrid_.finest().boundary().periodic_x;
  const int nx = q_.nx(), ny = q_.ny();
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const auto at = [&](int i) {
        return static_cast<T>(liquid(periodic ? (i + nx) % nx : std::clamp(i, 0, nx - 1), j));
      };
      for (int i = 0; i <= nx; ++i) a.beta.u(i, j) *= at(i - 1) * at(i);
      for (int i = 0; i < nx; ++i) {
        a.absorption(i, j) = static_cast<T>(liquid(i, j) * a.absorption(i, j) + surface_->absorption()(i, j));
        if (liquid(i, j) == 0) q_(i, j) = 0;
      }
      if (periodic) wrap_row(q_.row(j), nx);
    }
    for (int i = 0; i < nx; ++i)
      a.beta.v(i, j) *= static_cast<T>(liquid(i, std::max(j - 1, 0)) * liquid(i, std::min(j, ny - 1)));
  }
}

template <class T>
void Projection<T>::add_gravity_and_pressure(Team& team, const CellField& p, std::array<double, 2> g,
                                             double dt, Velocity& w) const {
  const Rows rows = team.rows(row_count(w));
  for (int k = rows.begin; k < rows.end; ++k) add_gravity_and_pressure_row(p, g, dt, w, k);
  team.sync();
}

template <class T>
void Projection<T>::add_gravity_and_pressure_row(const CellField& p, std::array<double, 2> g, double dt,
                                                 Velocity& w, int k) const {
  const double dt_h = dt / p.patch().h;
  const auto row = row_of(w, k);
  const T* __restrict b = row_of(multigrid_.finest().a.beta, k).data;
  const bool is_u = k % 2 == 0 && k / 2 < w.u.ny();
  const double* pc = p.row(k / 2);
  const double* pm = is_u ? pc - 1 : p.row(k / 2 - 1);
  const double push = dt * g[is_u ? 0 : 1];
  double* __restrict out = row.data;
  if (surface_) {
    const double *per_open = geometry_ ? row_of(geometry_->inverse_aperture, k).data : nullptr,
                 *at_surface = row_of(surface_->beta(), k).data;
    for (int i = 0; i < row.n; ++i) {
      const double beta = (static_cast<double>(b[i]) + at_surface[i]) * (per_open ? per_open[i] : 1.0);
      out[i] = beta > 0 ? out[i] + (push - dt_h * beta * (pc[i] - pm[i])) : 0;
    }
    return;
  }
  if (geometry_) {
    const double* __restrict per_open = row_of(geometry_->inverse_aperture, k).data;
#pragma omp simd
    for (int i = 0; i < row.n; ++i) {
      const double accelerated = push - dt_h * per_open[i] * static_cast<double>(b[i]) * (pc[i] - pm[i]);
      out[i] = b[i] != T(0) ? out[i] + accelerated : 0;
    }
    return;
  }
#pragma omp simd
  for (int i = 0; i < row.n; ++i)
    out[i] = b[i] != T(0) ? out[i] + (push - dt_h * static_cast<double>(b[i]) * (pc[i] - pm[i])) : 0;
}

template <class T>
double Projection<T>::measure_divergence(Team& team, const Velocity& w, const CellField* divergence) {
  const double h = rhs_.patch().h;
  const Rows rows = team.rows(rhs_.ny());
  for (int j = rows.begin; j < rows.end; ++j) {
    const double *u = w.u.row(j), *vs = w.v.row(j), *vn = w.v.row(j + 1);
    double* __restrict out = rhs_.row(j);
    const int n = rhs_.nx();
#pragma omp simd
    for (int i = 0; i < n; ++i) out[i] = -((u[i + 1] - u[i]) + (vn[i] - vs[i]));
    if (geometry_) {
      const double *a = geometry_->aperture.u.row(j), *as = geometry_->aperture.v.row(j),
                   *an = geometry_->aperture.v.row(j + 1);
#pragma omp simd
      for (int i = 0; i < n; ++i)
        out[i] = -((a[i + 1] * u[i + 1] - a[i] * u[i]) + (an[i] * vn[i] - as[i] * vs[i]));
    }
    if (with_modules && divergence && geometry_) {
      for (int i = 0; i < n; ++i) out[i] += h * geometry_->volume(i, j) * (*divergence)(i, j);
    } else if (with_modules && divergence) {
      const double* S = divergence->row(j);
#pragma omp simd
      for (int i = 0; i < n; ++i) out[i] += h * S[i];
    }
    if (surface_) {
      const double* liquid = surface_->liquid().row(j);
#pragma omp simd
      for (int i = 0; i < n; ++i) out[i] *= liquid[i];
    }
    largest_[j] = max_magnitude(out, n);
    speed_[j] = std::max(max_magnitude(u, n + 1), max_magnitude(vs, n));
  }
  team.sync();
  const double result = largest_.max();
  team.sync();
  return result;
}

template <class T>
double Projection<T>::max_divergence(Team& team, const Velocity& w, double dt) {
  return measure_divergence(team, w, nullptr) * dt / q_.patch().h;
}

template <class T>
SolveStats Projection<T>::solve(Team& team, double dt, double tolerance, int max_iterations, Velocity& w,
                                CellField& p, const ProjectionModules& modules) {
  PoissonLevel<T>& level = multigrid_.finest();
  const Boundary& boundary = level.boundary();
  const double to_div = dt / q_.patch().h;
  measure_divergence(team, w, modules.divergence);
  const Rows rows = team.rows(q_.ny());
  const double floor = 64 * 2.2e-16 * speed_.max();
  const StopRule rule{Measure::maximum, std::max(tolerance / to_div, floor), max_iterations};
  SolveStats stats = krylov_.solve(team, multigrid_, rhs_, q_, rule);
  stats.initial *= to_div;
  stats.final *= to_div;
  stats.tolerance *= to_div;

  // A closed box knows p up to a constant: mean 0 of what is added.
  double mean = 0;
  if (!boundary.any_open() && !surface_) {
    for (int j = rows.begin; j < rows.end; ++j) {
      double s = 0;
      for (int i = 0; i < q_.nx(); ++i) s += q_(i, j);
      speed_[j] = s;
    }
    team.sync();
    mean = speed_.sum() / static_cast<double>(q_.patch().cells());
  }

  const Rows faces = team.rows(row_count(w));
  for (int k = faces.begin; k < faces.end; ++k) {
    auto row = row_of(w, k);
    const T* __restrict b = row_of(level.a.beta, k).data;
    const bool is_u = k % 2 == 0 && k / 2 < w.u.ny();
    const double* qc = q_.row(k / 2);
    const double* qm = is_u ? qc - 1 : q_.row(k / 2 - 1);
    double* __restrict out = row.data;
    if (surface_) {
      const double *per_open = geometry_ ? row_of(geometry_->inverse_aperture, k).data : nullptr,
                   *at_surface = row_of(surface_->beta(), k).data;
      for (int i = 0; i < row.n; ++i)
        out[i] -=
            (static_cast<double>(b[i]) + at_surface[i]) * (per_open ? per_open[i] : 1.0) * (qc[i] - qm[i]);
    } else if (geometry_) {
      const double* __restrict per_open = row_of(geometry_->inverse_aperture, k).data;
#pragma omp simd
      for (int i = 0; i < row.n; ++i) out[i] -= per_open[i] * static_cast<double>(b[i]) * (qc[i] - qm[i]);
    } else {
#pragma omp simd
      for (int i = 0; i < row.n; ++i) out[i] -= static_cast<double>(b[i]) * (qc[i] - qm[i]);
    }
    if (boundary.periodic_x) wrap_row(row.data, q_.nx());
  }
  const double to_p = q_.patch().h / dt;
  team.sync();  // q is read across rows above
  for (int j = rows.begin; j < rows.end; ++j) {
    double *q = q_.row(j), *out = p.row(j);
#pragma omp simd
    for (int i = 0; i < q_.nx(); ++i) {
      q[i] -= mean;
      out[i] += to_p * q[i];
    }
    if (modules.rotational != 0) {  // rhs_ is still -h (∇·u** - divergence)
      const double *eta = modules.viscosity->row(j), *rhs = rhs_.row(j);
      const double omega_h = modules.rotational / q_.patch().h;
#pragma omp simd
      for (int i = 0; i < q_.nx(); ++i) {
        const double bound = 0.25 * std::abs(out[i]) + modules.least_bound,
                     change =
                         omega_h * eta[i] * rhs[i];  // of small cells less than it ought to be: rhs is theirs
        out[i] += std::min(std::max(change, -bound), bound);
      }
    }
    for (int i = 0; surface_ && i < q_.nx(); ++i)
      if (!surface_->is_liquid(i, j)) out[i] = 0;
    if (boundary.periodic_x) wrap_row(q, q_.nx());
    if (boundary.periodic_x) wrap_row(out, q_.nx());
  }
  team.sync();
  return stats;
}

template class Projection<float>;
template class Projection<double>;

}  // namespace hourglass
