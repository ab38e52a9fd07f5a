#include "solver/viscous_solve.hpp"

#include "kernels/rheology.hpp"

namespace hourglass {

template <class T>
void ViscousSolve<T>::assemble(Team& team, const CellField& eta, bool harmonic, const CellField& density,
                               double dt, const WallDrag& drag, const Velocity& u, Velocity& star) {
  ViscousLevel<T>& level = multigrid_.finest();
  auto& a = level.a;
  const int nx = eta.nx(), ny = eta.ny();
  const double scale = eta.patch().h * eta.patch().h / dt;
  const bool periodic = level.boundary().periodic_x;
  const Rows rows = team.rows(ny + 1);
  if (geometry_) set_coefficients_in_geometry(rows, eta, harmonic, density, scale, star);
  for (int j = rows.begin; !geometry_ && j < rows.end; ++j) {
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
  for (int k = 2 * rows.begin; surface_ && k < std::min(2 * rows.end, row_count(a.mass)); ++k) {
    const auto m = row_of(a.mass, k);
    const char* kind = row_of(surface_->kind(), k).data;
#pragma omp simd
    for (int i = 0; i < m.n; ++i) m.data[i] *= T(kind[i] == FreeSurface::grains_beside);
  }
  if (with_modules && drag.force) add_drag(rows, drag, u, star);
  if (team.leads()) has_drag_ = geometry_ || drag.force;
  for (int j = rows.begin; (geometry_ || drag.force) && j < std::min(rows.end, ny); ++j) {
    double sum = 0;
    for (int i = 0; i < nx; ++i) sum += density(i, j) * (geometry_ ? geometry_->volume(i, j) : 1);
    inertia_[j] = scale * sum;
  }
  team.sync();
  for (int j = rows.begin; !geometry_ && j < rows.end; ++j)
    corner_viscosity_row(a.eta_c, level.boundary(), harmonic, j, a.eta_n);
  team.sync();
  level.finish(team);
  multigrid_.coarsen(team);
}

/// eta V in cells, eta times open control volumes at corners; the mass of a face is that of the open halves of its cells,
/// 0 where it is closed, and what solids beside it add as a drag.
template <class T>
void ViscousSolve<T>::set_coefficients_in_geometry(Rows rows, const CellField& eta, bool harmonic,
                                                   const CellField& density, double scale, Velocity& star) {
  const Geometry& g = *geometry_;
  const Boundary& boundary = multigrid_.finest().boundary();
  auto& a = multigrid_.finest().a;
  const int nx = eta.nx(), ny = eta.ny();
  // Of two cells with open volumes v; harmonic, as at the corner of a wall.
  const auto at_wall = [harmonic](double v1, double eta1, double v2, double eta2) {
    const double sum = std::max(v1 + v2, 1e-300);
    const auto inverse = [](double x) { return 1 / std::max(x, 1e-290); };
    return harmonic ? sum / std::max(v1 * inverse(eta1) + v2 * inverse(eta2), 1e-290)
                    : (v1 * eta1 + v2 * eta2) / sum;
  };
  const auto face = [&](T* m, int n, const double* aperture, const double* wall, double* velocity,
                        auto&& side1, auto&& side2) {
    for (int i = 0; i < n; ++i) {
      const auto [v1, rho1, eta1] = side1(i);
      const auto [v2, rho2, eta2] = side2(i);
      const double mass = 0.5 * scale * (v1 * rho1 + v2 * rho2);
      const double shear = wall[i] > 0 ? wall[i] * at_wall(v1, eta1, v2, eta2) : 0;
      m[i] = static_cast<T>(aperture[i] > 0 ? mass + shear : 0);
      if (shear > 0) velocity[i] *= mass / (mass + shear);  // the right-hand side is that of the mass alone
    }
  };
  using Side = std::array<double, 3>;
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const double *e = eta.row(j), *open = g.volume.row(j), *rho = density.row(j);
      T* __restrict ec = a.eta_c.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i) ec[i] = static_cast<T>(e[i] * open[i]);
      const auto cell = [&](int i) {
        if (boundary.periodic_x) i = (i + nx) % nx;
        return i >= 0 && i < nx ? Side{open[i], rho[i], e[i]} : Side{0, 0, 1};
      };
      face(
          a.mass.u.row(j), nx + 1, g.aperture.u.row(j), g.wall.u.row(j), star.u.row(j),
          [&](int i) { return cell(i - 1); }, cell);
    }
    const auto row = [&](int k) {
      return [&, k](int i) {
        return k >= 0 && k < ny ? Side{g.volume(i, k), density(i, k), eta(i, k)} : Side{0, 0, 1};
      };
    };
    face(a.mass.v.row(j), nx, g.aperture.v.row(j), g.wall.v.row(j), star.v.row(j), row(j - 1), row(j));
    corner_viscosity_row(eta, g, boundary, harmonic, j, a.eta_n);
  }
}

/// On a face mass u* + k u_wall = (mass + k) u*' with k = h^2 F P c / speed, on the same share of a control volume.
template <class T>
void ViscousSolve<T>::add_drag(Rows rows, const WallDrag& drag, const Velocity& u, Velocity& star) {
  auto& mass = multigrid_.finest().a.mass;
  const CellField& force = *drag.force;
  const int nx = force.nx(), ny = force.ny();
  const double h2 = force.patch().h * force.patch().h, floor2 = drag.speed_floor * drag.speed_floor;
  const bool periodic = multigrid_.finest().boundary().periodic_x;
  const auto [u_wall, v_wall] = drag.wall_velocity;
  const auto press = [&](T& m, double& velocity, double wall, double k) {
    const double before = m, total = before + k;
    velocity = (before * velocity + k * wall) / total;
    m = static_cast<T>(total);
  };
  const auto open = [this](int i, int j) { return geometry_ ? geometry_->volume(i, j) : 1.0; };
  for (int j = rows.begin; j < rows.end; ++j) {
    const int jc = std::min(j, ny - 1);
    const double* f = force.row(jc);
    const double *vs = u.v.row(j), *us = u.u.row(j - 1), *uc = u.u.row(j);
    if (j < ny) {
      const double* vn = u.v.row(j + 1);
      for (int i = 0; i <= nx; ++i) {
        const double right = i < nx || periodic ? f[i] * open(i, jc) : 0;
        const double left = i > 0 || periodic ? f[i - 1] * open(i - 1, jc) : 0;
        const double across = 0.25 * ((vs[i - 1] + vs[i]) + (vn[i - 1] + vn[i])) - v_wall,
                     along = uc[i] - u_wall;
        const double speed = std::sqrt(std::max(along * along + across * across, floor2));
        press(mass.u(i, j), star.u(i, j), u_wall, 0.5 * h2 * (left + right) / speed);
      }
    }
    const double *above = force.row(j), *below = force.row(j - 1);
    for (int i = 0; i < nx; ++i) {
      const double both = (j < ny ? above[i] * open(i, j) : 0) + (j > 0 ? below[i] * open(i, j - 1) : 0);
      const double across = 0.25 * ((us[i] + us[i + 1]) + (uc[i] + uc[i + 1])) - u_wall,
                   along = vs[i] - v_wall;
      const double speed = std::sqrt(std::max(along * along + across * across, floor2));
      press(mass.v(i, j), star.v(i, j), v_wall, 0.5 * h2 * both / speed);
    }
  }
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
    const double falling = has_drag_ ? 0 : gravity_speed * gravity_speed;
    double e = 0;
#pragma omp simd reduction(+ : e)
    for (int i = 0; i < b.n; ++i) {
      const double mass = m[i], speed = b.data[i];
      e += mass * (speed * speed + falling);
      b.data[i] = mass * speed;
    }
    energy_[k] = e;
  }
  team.sync();
  const double inertia = has_drag_ ? 2 * inertia_.sum() : 0;  // of u and of v
  const double scale = std::sqrt(energy_.sum() + inertia * gravity_speed * gravity_speed);
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
