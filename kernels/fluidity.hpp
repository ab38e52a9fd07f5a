#pragma once
// Nonlocal granular fluidity g = P/eta (Kamrin & Koval 2012, PRL 108:178301), stationary, in a form without a division
// by mu - mu_s:
//
//   c (g - g_local) - lap g = 0,   c = 1/xi^2,
//
// integrated over cells: kappa_c g_c + sum over faces of a_f (g_c - g_nb) = kappa_c g_local, with kappa = share h^2 c
// [1], a_f the lesser share of grains beside the face, 0 between grains and air: no flux through the free surface.
#include <algorithm>
#include <cmath>

#include "kernels/boundary.hpp"
#include "kernels/granular_laws.hpp"
#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Cells with fewer grains have no fluidity.
inline constexpr double least_grains = 1e-6;

/// Bounds of kappa / share: below, that the matrix stays definite where nothing moves; above, that a float holds it
/// beside a_f = 1. g follows g_local to 1e-8 there.
inline constexpr double least_absorption = 1e-10, most_absorption = 1e8;

/// One row of the equation. in, along the row: |γ̇|^2 [1/T^2], P >= 0, share of grains, g of the step before [1/T],
/// properties, A d [L]. out: kappa [1], its source kappa g_local [1/T], the least g that eta_max allows, P/eta_max [1/T].
struct FluidityRow {
  const double *gamma2, *pressure, *grains, *g_before;
  const double* length;  ///< A d
  double *absorption, *source, *least;
};

namespace detail {

/// kappa / share and its source, bounded.
inline void store(const FluidityRow row, int i, double kappa, double source, double least) {
  const double c = row.grains[i] > least_grains ? row.grains[i] : 0.0;
  const double bounded = std::min(std::max(kappa, least_absorption), most_absorption);
  row.absorption[i] = c * bounded;
  row.source[i] = c * bounded * (source / std::max(kappa, least_absorption));
  row.least[i] = std::max(least, 1e-30);
}

}  // namespace detail

/// xi by mu(I(|γ̇|)), so that xi^2 = A^2 d^2 I_0 / (delta_mu I), and g_local = |γ̇| / mu(I): the closure of the silo thesis.
inline void fluidity_row_thesis(const FluidityRow row, const double* __restrict I,
                                const double* __restrict mu, const GrainRows properties, int n, double h,
                                double eta_max) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const Grain g = properties.at(i);
    const double reach = row.length[i] / h;
    const double slip = std::min(I[i] / g.I_0, 1e30);
    const double kappa = g.delta_mu * slip / std::max(reach * reach, 1e-30);
    const double local = std::sqrt(row.gamma2[i]) / std::max(mu[i], 1e-30);
    detail::store(row, i, kappa, kappa * local, row.pressure[i] / eta_max);
  }
}

/// Henann & Kamrin 2013 (PNAS 110:6730): mu is the stress ratio |γ̇|/g, and
///   lap g = N(g) / (A d)^2,  N = delta_mu |mu - mu_s| / (mu_2 - mu) (g - g_local(mu)),
///   g_local = I_0 sqrt(P/rho)/d (mu - mu_s) / (mu (mu_2 - mu)) above mu_s, else 0,  mu_2 = mu_s + delta_mu.
/// |γ̇| is that of the step; N is made linear about the g of the step before by a slope that is Newton's where that is
/// safe: at least N/g, so that kappa and source stay positive.
inline void fluidity_row_kamrin(const FluidityRow row, const GrainRows properties, int n, double h,
                                double eta_max) {
  for (int i = 0; i < n; ++i) {
    const Grain p = properties.at(i);
    const double rate = std::sqrt(row.gamma2[i]), mu_2 = p.mu_s + p.delta_mu;
    const double least = row.pressure[i] / eta_max;
    // The stress ratio cannot pass mu_2: a lower bound for g.
    const double g = std::max({row.g_before[i], least, rate / (0.999 * mu_2), 1e-30});
    const double mu = rate / g, excess = mu - p.mu_s, left = mu_2 - mu;
    const double speed = p.I_0 * std::sqrt(row.pressure[i]) / p.d_sqrt_rho();
    const double picard = p.delta_mu * std::abs(excess) / left;
    double local = 0, slope = 0;
    if (excess > 0) {
      local = speed * excess / (mu * left);
      // dN/dg by way of dmu/dg = -mu/g, of delta_mu [(mu - mu_s) g / left - speed (mu - mu_s)^2 / (mu left^2)].
      const double share = excess * excess / (mu * left * left);
      slope = p.delta_mu * (-(p.mu_s * left + excess * mu) / (left * left) +
                            speed * share * (2 / excess - 1 / mu + 2 / left) * mu / g);
    } else {
      slope = p.delta_mu * (excess * excess + p.mu_s * (mu_2 - p.mu_s)) / (left * left);
    }
    const double k = std::max(picard, slope), reach = std::max(row.length[i] / h, 1e-15);
    const double n_of_g = picard * (g - local);
    detail::store(row, i, k / (reach * reach), (k * g - n_of_g) / (reach * reach), least);
  }
}

/// a_f of row j of both components; boundary faces: 2 c where a wall holds g = 0 half a cell away, else 0.
/// in: share of grains, interior (wrapped where periodic).
template <class T>
void fluidity_faces_row(const CellField& grains, const Boundary& boundary, bool zero_at_walls, int j,
                        VelocityOf<T>& a) {
  const int nx = grains.nx(), ny = grains.ny();
  const auto some = [](double c) { return static_cast<T>(c) * T(c > least_grains); };
  const auto least = [&](double l, double r) { return some(std::min(l, r)); };
  const auto at_wall = [&](double c, double open) {
    return zero_at_walls && !(open > 0) ? T(2) * some(c) : T(0);
  };
  if (j < ny) {
    const double* c = grains.row(j);
    T* __restrict out = a.u.row(j);
#pragma omp simd
    for (int i = 1; i < nx; ++i) out[i] = least(c[i - 1], c[i]);
    if (boundary.periodic_x) {
      out[0] = out[nx] = least(c[nx - 1], c[0]);
    } else {
      out[0] = boundary.mirror_left ? T(0) : at_wall(c[0], boundary.left.open[j]);
      out[nx] = at_wall(c[nx - 1], boundary.right.open[j]);
    }
  }
  T* __restrict out = a.v.row(j);
  if (j > 0 && j < ny) {
    const double *below = grains.row(j - 1), *above = grains.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i) out[i] = least(below[i], above[i]);
  } else {
    const SideFaces& side = j == 0 ? boundary.bottom : boundary.top;
    const double* c = grains.row(j == 0 ? 0 : ny - 1);
    for (int i = 0; i < nx; ++i) out[i] = at_wall(c[i], side.open[i]);
  }
}

}  // namespace hourglass
