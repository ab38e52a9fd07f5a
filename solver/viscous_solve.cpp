#include "solver/viscous_solve.hpp"

#include "kernels/rheology.hpp"

namespace hourglass {

template <class T>
void ViscousSolve<T>::assemble(Team& team, const CellField& eta, bool harmonic, const CellField& density,
                               double dt) {
  ViscousLevel<T>& level = multigrid_.finest();
  auto& a = level.a;
  const int nx = eta.nx(), ny = eta.ny();
  const double scale = eta.patch().h * eta.patch().h / dt;
  const bool periodic = level.boundary().periodic_x;
  const Rows rows = team.rows(ny + 1);
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const double* e = eta.row(j);
      T* __restrict ec = a.eta_c.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i) ec[i] = static_cast<T>(e[i]);
      const double* rho = density.row(j);
      T* __restrict m = a.mass.u.row(j);
#pragma omp simd
      for (int i = 0; i <= nx; ++i) m[i] = static_cast<T>(0.5 * scale * (rho[i - 1] + rho[i]));
      if (!periodic) {  // half a control volume
        m[0] = static_cast<T>(0.5 * scale * rho[0]);
        m[nx] = static_cast<T>(0.5 * scale * rho[nx - 1]);
      }
    }
    const double *below = density.row(std::max(j - 1, 0)), *above = density.row(std::min(j, ny - 1));
    const double share = j == 0 || j == ny ? 0.25 : 0.5;
    T* __restrict m = a.mass.v.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i) m[i] = static_cast<T>(share * scale * (below[i] + above[i]));
  }
  team.sync();
  for (int j = rows.begin; j < rows.end; ++j)
    corner_viscosity_row(a.eta_c, level.boundary(), harmonic, j, a.eta_n);
  team.sync();
  level.finish(team);
  multigrid_.coarsen(team);
}

template <class T>
SolveStats ViscousSolve<T>::solve(Team& team, Velocity& star, Velocity& x, double tolerance,
                                  double gravity_speed, int max_iterations) {
  ViscousLevel<T>& level = multigrid_.finest();
  const Rows rows = team.rows(row_count(x));
  for (int k = rows.begin; k < rows.end; ++k) {
    auto b = row_of(star, k);
    const T* m = row_of(level.a.mass, k).data;
    level.mask(star, k);
    level.mask(x, k);
    level.wrap(x, k);
    double e = 0;
#pragma omp simd reduction(+ : e)
    for (int i = 0; i < b.n; ++i) {
      const double mass = m[i], speed = b.data[i];
      e += mass * (speed * speed + gravity_speed * gravity_speed);
      b.data[i] = mass * speed;
    }
    energy_[k] = e;
  }
  team.sync();
  const double scale = std::sqrt(energy_.sum());
  SolveStats stats =
      krylov_.solve(team, multigrid_, star, x, {Measure::energy, tolerance * scale, max_iterations});
  if (scale > 0) {
    stats.initial /= scale;
    stats.final /= scale;
    stats.tolerance = tolerance;
  }
  return stats;
}

template class ViscousSolve<float>;
template class ViscousSolve<double>;

}  // namespace hourglass
