#pragma once
// Viscosity at centres and corners from shear rate, pressure and material shares.
#include <algorithm>
#include <span>
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/geometry.hpp"
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

/// Share of a material among the grains of each cell; 0 where there are none.
inline void share_row(const double* __restrict tracer, const double* __restrict grains, int n,
                      double* __restrict share) {
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double s = tracer[i] / std::max(grains[i], 1e-300);
    share[i] = std::min(std::max(s, 0.0), 1.0);
  }
}

/// Linear mean of a property over the materials of each cell: values[0] of material 0, which has what the others
/// leave, values[k] of the one with shares[k - 1].
inline void blend_row(std::span<const double> values, std::span<const double* const> shares, int n,
                      double* __restrict mean) {
  std::fill(mean, mean + n, values[0]);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const double* __restrict share = shares[k];
    const double excess = values[k + 1] - values[0];
#pragma omp simd
    for (int i = 0; i < n; ++i) mean[i] += excess * share[i];
  }
}

/// P that the grains feel.
inline double grain_pressure(double p, const ViscosityLimits& limits) {
  return std::max(p + limits.background_pressure, 0.0);
}

/// Cell viscosity: eta = c clamp((mu(I) P + cohesion) / |γ̇|, eta_min, eta_max) + (1 - c) eta_air. P = 0 gives
/// eta_min and rest under pressure eta_max: a scene that starts from p = 0 starts to flow (docs/theory.md, Start).
/// Properties: Grain, the same everywhere, or GrainRows. in: gamma2 [1/T^2], p, grains (interior); out: eta_c of a
/// row. 3 reads (8 B) + 1 write (4 or 8 B).
template <class T, class Properties>
void granular_viscosity_row(const double* __restrict gamma2, const double* __restrict p,
                            const double* __restrict grains, int n, const Properties& properties,
                            const ViscosityLimits& limits, T* __restrict eta) {
  const ViscosityLimits l = limits;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double raw = granular_viscosity(std::sqrt(gamma2[i]), grain_pressure(p[i], l), properties.at(i));
    const double bounded = std::min(std::max(raw, l.eta_min), l.eta_max);
    eta[i] = static_cast<T>(grains[i] * bounded + (1 - grains[i]) * l.air);
  }
}

/// The same with any friction: mu of the row is given.
inline void viscosity_of_friction_row(const double* __restrict gamma2, const double* __restrict p,
                                      const double* __restrict grains, int n, const double* __restrict mu,
                                      const double* __restrict cohesion, const ViscosityLimits& limits,
                                      double* __restrict eta) {
  const ViscosityLimits l = limits;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double stress = mu[i] * grain_pressure(p[i], l) + cohesion[i];
    const double raw = stress / std::max(std::sqrt(gamma2[i]), 1e-30);
    eta[i] = grains[i] * std::min(std::max(raw, l.eta_min), l.eta_max) + (1 - grains[i]) * l.air;
  }
}

/// The same from a granular fluidity: eta_grains = P/g + cohesion/|γ̇|; where grains are too few for a fluidity, eta_min.
inline void viscosity_of_fluidity_row(const double* __restrict g, const double* __restrict gamma2,
                                      const double* __restrict p, const double* __restrict grains, int n,
                                      const double* __restrict cohesion, const ViscosityLimits& limits,
                                      double* __restrict eta) {
  const ViscosityLimits l = limits;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double frictional = g[i] > 0 ? grain_pressure(p[i], l) / std::max(g[i], 1e-300) : 0.0;
    const double raw = frictional + cohesion[i] / std::max(std::sqrt(gamma2[i]), 1e-30);
    eta[i] = grains[i] * std::min(std::max(raw, l.eta_min), l.eta_max) + (1 - grains[i]) * l.air;
  }
}

/// I and mu(I) of a row.
inline void friction_row(const double* __restrict gamma2, const double* __restrict p, int n,
                         const GrainRows& properties, const ViscosityLimits& limits, double* __restrict I,
                         double* __restrict mu) {
  const GrainRows rows = properties;
  const ViscosityLimits l = limits;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const Grain g = rows.at(i);
    I[i] = inertial_number(std::sqrt(gamma2[i]), grain_pressure(p[i], l), g);
    mu[i] = mu_of_I(I[i], g);
  }
}

/// gamma2 + (mu_s P / eta_max)^2: with it the law meets eta_max smoothly.
inline void smooth_cap_row(const double* __restrict gamma2, const double* __restrict p,
                           const double* __restrict mu_s, int n, const ViscosityLimits& limits,
                           double* __restrict out) {
  const ViscosityLimits l = limits;
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double slowest = mu_s[i] * grain_pressure(p[i], l) / l.eta_max;
    out[i] = gamma2[i] + slowest * slowest;
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
  if (harmonic) {  // NOLINT(bugprone-branch-clone): it takes all loops under a pragma for the same
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

/// The same beside solids: the mean is one over open cells, and weighs as much as the corner's control volume is open. in:
/// eta of the interior.
template <class T>
void corner_viscosity_row(const CellField& eta, const Geometry& geometry, const Boundary& boundary,
                          bool harmonic, int j, CornerFieldOf<T>& eta_n) {
  const int nx = eta.nx(), ny = eta.ny(), jb = std::max(j - 1, 0), ja = std::min(j, ny - 1);
  const double *below = eta.row(jb), *above = eta.row(ja);
  const double *open_below = geometry.volume.row(jb), *open_above = geometry.volume.row(ja);
  const double* open = geometry.corner_volume.row(j);
  T* __restrict out = eta_n.row(j);
  const auto mean = [&](int l, int r) {
    const double a = open_below[l], b = open_below[r], c = open_above[l], d = open_above[r];
    const double sum = (a + b) + (c + d), least = 1e-290;
    const auto inverse = [least](double x) { return 1 / std::max(x, least); };
    const double part = harmonic ? (a * inverse(below[l]) + b * inverse(below[r])) +
                                       (c * inverse(above[l]) + d * inverse(above[r]))
                                 : (a * below[l] + b * below[r]) + (c * above[l] + d * above[r]);
    return harmonic ? sum / std::max(part, least) : part / std::max(sum, least);
  };
  const auto weighted = [&](int i, int l, int r, double shear) {
    out[i] = static_cast<T>(shear * open[i] * mean(l, r));
  };
  if (j > 0 && j < ny) {
#pragma omp simd
    for (int i = 1; i < nx; ++i) out[i] = static_cast<T>(open[i] * mean(i - 1, i));
  } else {
    const SideFaces& side = j == 0 ? boundary.bottom : boundary.top;
    for (int i = 1; i < nx; ++i) weighted(i, i - 1, i, side.shear[i]);
  }
  const auto end = [&](int i, int cell, const SideFaces& side) {
    const SideFaces& across = j == 0 ? boundary.bottom : boundary.top;
    const bool corner = j == 0 || j == ny;  // of the domain: it belongs to two sides
    if (boundary.periodic_x) {
      weighted(i, nx - 1, 0, corner ? across.shear[i] : 1);
    } else {
      weighted(i, cell, cell, corner ? 0.5 * (side.shear[j] + across.shear[i]) : side.shear[j]);
    }
  };
  end(0, 0, boundary.left);
  end(nx, nx - 1, boundary.right);
}

}  // namespace hourglass
