#pragma once
// Viscous and pressure coefficients of random or given media, complete with halos.
#include "kernels/poisson.hpp"
#include "kernels/rheology.hpp"
#include "kernels/viscous.hpp"
#include "tests/support/random_fields.hpp"

namespace hourglass {

/// Wraps what is periodic and fills the inverse diagonal, once eta_c, eta_n and mass are set inside.
template <class T>
void finish(const Boundary& boundary, ViscousCoefficients<T>& a) {
  const int nx = a.eta_c.nx(), ny = a.eta_c.ny();
  for (int j = 0; boundary.periodic_x && j <= ny; ++j) {
    if (j < ny) {
      wrap_row(a.eta_c.row(j), nx);
      wrap_row(a.mass.u.row(j), nx);
    }
    wrap_row(a.eta_n.row(j), nx);
    wrap_row(a.mass.v.row(j), nx);
  }
  Team alone;
  fill_inverse_diagonal(alone, boundary, a);
}

/// eta(x, y) at cell centres, the corners by the rule of the solver, and mass [M/T] on every face (half at boundaries).
template <class T, class Eta>
ViscousCoefficients<T> viscous_coefficients(const Patch& patch, const Boundary& boundary, Eta&& eta,
                                            double mass, bool harmonic = true) {
  ViscousCoefficients<T> a(patch);
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      a.eta_c(i, j) = static_cast<T>(eta(patch.x_centre(i), patch.y_centre(j)));
  for (int j = 0; j <= patch.ny; ++j) corner_viscosity_row(a.eta_c, boundary, harmonic, j, a.eta_n);
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i <= patch.nx; ++i)
      a.mass.u(i, j) = static_cast<T>(!boundary.periodic_x && (i == 0 || i == patch.nx) ? 0.5 * mass : mass);
  for (int j = 0; j <= patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      a.mass.v(i, j) = static_cast<T>(j == 0 || j == patch.ny ? 0.5 * mass : mass);
  finish(boundary, a);
  return a;
}

/// Viscosities spread evenly in the logarithm over [1, contrast], masses over [1e-3, 1].
template <class T>
ViscousCoefficients<T> random_viscous(const Patch& patch, const Boundary& boundary, Noise& noise,
                                      double contrast) {
  ViscousCoefficients<T> a = viscous_coefficients<T>(
      patch, boundary, [&](double, double) { return noise.logarithmic(1, contrast); }, 1.0);
  for (int k = 0; k < row_count(a.mass); ++k) {
    auto row = row_of(a.mass, k);
    for (int i = 0; i < row.n; ++i) row.data[i] = static_cast<T>(noise.logarithmic(1e-3, 1));
  }
  finish(boundary, a);
  return a;
}

/// Zero on fixed faces, wrapped where periodic: what an unknown of the viscous operator looks like.
template <class T, class X>
void make_admissible(const ViscousCoefficients<T>& a, const Boundary& boundary, VelocityOf<X>& x) {
  for (int k = 0; k < row_count(x); ++k) {
    auto row = row_of(x, k);
    const auto inverse = row_of(a.inverse_diagonal, k);
    for (int i = 0; i < row.n; ++i)
      if (inverse.data[i] == T(0)) row.data[i] = X(0);
    if (boundary.periodic_x) wrap_row(row.data, a.eta_c.nx());
  }
}

template <class T, class X>
VelocityOf<X> apply(const ViscousCoefficients<T>& a, const VelocityOf<X>& x) {
  VelocityOf<X> out(x.patch());
  for (int k = 0; k < row_count(x); ++k) apply_viscous_row(a, x, k, row_of(out, k).data);
  return out;
}

/// Densities spread evenly in the logarithm over [1/contrast, 1]; beta = aperture / rho.
template <class T>
PoissonCoefficients<T> random_poisson(const Patch& patch, const Boundary& b, Noise& noise, double contrast) {
  PoissonCoefficients<T> a(patch);
  const auto beta = [&] { return static_cast<T>(noise.logarithmic(1, contrast)); };
  for (int j = 0; j < patch.ny; ++j) {
    for (int i = 0; i <= patch.nx; ++i) a.beta.u(i, j) = beta();
    if (b.periodic_x) {
      a.beta.u(patch.nx, j) = a.beta.u(0, j);
    } else {
      a.beta.u(0, j) *= static_cast<T>(2 * b.left.open[j]);
      a.beta.u(patch.nx, j) *= static_cast<T>(2 * b.right.open[j]);
    }
  }
  for (int j = 0; j <= patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i) {
      a.beta.v(i, j) = beta();
      if (j == 0) a.beta.v(i, j) *= static_cast<T>(2 * b.bottom.open[i]);
      if (j == patch.ny) a.beta.v(i, j) *= static_cast<T>(2 * b.top.open[i]);
    }
  Team alone;
  fill_inverse_diagonal(alone, a);
  return a;
}

template <class T, class X>
CellFieldOf<X> apply(const PoissonCoefficients<T>& a, const CellFieldOf<X>& x) {
  CellFieldOf<X> out(x.patch());
  for (int k = 0; k < row_count(x); ++k) apply_poisson_row(a, x, k, out.row(k));
  return out;
}

}  // namespace hourglass
