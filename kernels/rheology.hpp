#pragma once
// Viscosity at centres and corners from shear rate, pressure and material shares.
#include <algorithm>
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/granular_laws.hpp"
#include "kernels/team.hpp"
#include "kernels/viscous.hpp"

namespace hourglass {

/// Limits and air of the viscosity.
struct ViscosityLimits {
  double eta_min, eta_max;     ///< of the grains [M/T]
  double air;                  ///< eta of air [M/T]
  double background_pressure;  ///< added to p [M/T^2]
};

/// Cells at a limit, by row (for the log: limiters are honest).
struct LimitCounts {
  long capped = 0, floored = 0;
};

/// Cell viscosity of one material: eta = c clamp(mu(I) P / |γ̇|, eta_min, eta_max) + (1 - c) eta_air. P = 0
/// gives eta_min and rest under pressure eta_max: a scene that starts from p = 0 starts to flow
/// (docs/theory.md, Start). in: gamma2 [1/T^2], p, grains (interior); out: eta_c of row j. 3 reads (8 B) + 1
/// write (4 or 8 B).
template <class T>
void granular_viscosity_row(const double* __restrict gamma2, const double* __restrict p,
                            const double* __restrict grains, int n, const Grain& g,
                            const ViscosityLimits& limits, T* __restrict eta) {
  const double d_sqrt_rho = g.diameter * std::sqrt(g.density);
  const double mu_s = g.mu_s, delta_mu = g.delta_mu, I_0 = g.I_0;
  const double lo = limits.eta_min, hi = limits.eta_max, air = limits.air, p0 = limits.background_pressure;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double pressure = std::max(p[i] + p0, 0.0);
    const double raw = granular_viscosity(std::sqrt(gamma2[i]), pressure, mu_s, delta_mu, I_0, d_sqrt_rho);
    const double bounded = std::min(std::max(raw, lo), hi);
    eta[i] = static_cast<T>(grains[i] * bounded + (1 - grains[i]) * air);
  }
}

/// The same for several materials: a cell's mu_s, delta_mu, I_0 and d sqrt(rho) are linear means by volume
/// share. tracers[k][i]: share of the cell filled by grain k + 1.
template <class T>
void blended_viscosity_row(const double* gamma2, const double* p, const double* grains,
                           const std::vector<const double*>& tracers, int n, const std::vector<Grain>& g,
                           const ViscosityLimits& limits, T* eta) {
  for (int i = 0; i < n; ++i) {
    double eta_g = limits.eta_min;
    if (grains[i] > 0) {
      double first = 1, mu_s = 0, delta_mu = 0, I_0 = 0, ds = 0;
      const auto mix = [&](double share, const Grain& m) {
        mu_s += share * m.mu_s;
        delta_mu += share * m.delta_mu;
        I_0 += share * m.I_0;
        ds += share * m.diameter * std::sqrt(m.density);
      };
      for (std::size_t k = 0; k < tracers.size(); ++k) {
        const double share = std::clamp(tracers[k][i] / grains[i], 0.0, first);
        first -= share;
        mix(share, g[k + 1]);
      }
      mix(first, g[0]);
      const double pressure = std::max(p[i] + limits.background_pressure, 0.0);
      eta_g = granular_viscosity(std::sqrt(gamma2[i]), pressure, mu_s, delta_mu, I_0, ds);
      eta_g = std::min(std::max(eta_g, limits.eta_min), limits.eta_max);
    }
    eta[i] = static_cast<T>(grains[i] * eta_g + (1 - grains[i]) * limits.air);
  }
}

/// Corner viscosity from the cells around it, times the shear weight at boundaries. The harmonic mean
/// has the best observed order of the discharge (docs/accuracy.md). in: eta_c of the interior (wrapped halo
/// where periodic); out: row j of eta_n.
template <class T>
void corner_viscosity_row(const CellFieldOf<T>& eta_c, const Boundary& boundary, bool harmonic, int j,
                          CornerFieldOf<T>& eta_n) {
  const int nx = eta_c.nx(), ny = eta_c.ny();
  const T *below = eta_c.row(std::max(j - 1, 0)), *above = eta_c.row(std::min(j, ny - 1));
  T* __restrict out = eta_n.row(j);
  const auto mean = [&](int l, int r) {
    const T a = below[l], b = below[r], c = above[l], d = above[r];
    return harmonic ? T(4) / ((T(1) / a + T(1) / b) + (T(1) / c + T(1) / d)) : T(0.25) * ((a + b) + (c + d));
  };
  if (harmonic) {
#pragma omp simd
    for (int i = 1; i < nx; ++i)
      out[i] = T(4) / ((T(1) / below[i - 1] + T(1) / below[i]) + (T(1) / above[i - 1] + T(1) / above[i]));
  } else {
#pragma omp simd
    for (int i = 1; i < nx; ++i) out[i] = T(0.25) * ((below[i - 1] + below[i]) + (above[i - 1] + above[i]));
  }
  if (boundary.periodic_x) {
    out[0] = out[nx] = mean(nx - 1, 0);
  } else {
    out[0] = mean(0, 0) * T(boundary.left.shear[j]);
    out[nx] = mean(nx - 1, nx - 1) * T(boundary.right.shear[j]);
  }
  if (j == 0 || j == ny) {
    const SideFaces& side = j == 0 ? boundary.bottom : boundary.top;
    const int first = boundary.periodic_x ? 0 : 1, last = boundary.periodic_x ? nx : nx - 1;
    for (int i = first; i <= last; ++i) out[i] *= T(side.shear[i]);
    if (!boundary.periodic_x) {  // a domain corner belongs to two sides
      out[0] = mean(0, 0) * T(0.5 * (boundary.left.shear[j] + side.shear[0]));
      out[nx] = mean(nx - 1, nx - 1) * T(0.5 * (boundary.right.shear[j] + side.shear[nx]));
    }
  }
}

}  // namespace hourglass
