#pragma once
// Laws of numbers, apart from the loops that feed them. |γ̇| = sqrt(2 D:D), P the mean pressure.
#include <algorithm>
#include <cmath>

namespace hourglass {

/// What the mu(I) law needs of a grain.
struct Grain {
  double mu_s = 0.62, delta_mu = 0.48, I_0 = 0.6;  ///< [1]
  double diameter = 1;                             ///< [L]
  double density = 1;                              ///< bulk density at rest [M/L^2]
};

/// Inertial number I = |γ̇| d / sqrt(P/ρ) (GDR MiDi 2004); written so that P = 0 gives a large number, not a
/// NaN.
inline double inertial_number(double gamma_dot, double pressure, const Grain& g) {
  return gamma_dot * g.diameter * std::sqrt(g.density) / std::sqrt(std::max(pressure, 1e-300));
}

/// mu(I) = mu_s + delta_mu I / (I_0 + I) (Jop, Forterre & Pouliquen 2006).
inline double mu_of_I(double I, const Grain& g) { return g.mu_s + g.delta_mu * I / (g.I_0 + I); }

/// Effective viscosity mu(I) P / |γ̇| without limits [M/T]. As one fraction, without a division by I:
/// mu P / |γ̇| = P (mu_s r + (mu_s + delta_mu) γ̇ d) / ((r + γ̇ d) γ̇),  r = I_0 sqrt(P/ρ).
inline double granular_viscosity(double gamma_dot, double pressure, double mu_s, double delta_mu, double I_0,
                                 double d_sqrt_rho) {
  const double rate = std::max(gamma_dot, 1e-30);
  const double slip = rate * d_sqrt_rho, root = I_0 * std::sqrt(pressure);
  return pressure * (mu_s * root + (mu_s + delta_mu) * slip) / ((root + slip) * rate);
}

/// C(I) of Barker, Schaeffer, Bohorquez & Gray 2015: the equations are well posed where C <= 0.
inline double well_posedness(double I, const Grain& g) {
  const double mu = mu_of_I(I, g);
  const double mu_prime = g.delta_mu * g.I_0 / ((g.I_0 + I) * (g.I_0 + I));
  const double nu = I * mu_prime / mu;
  return 4 * nu * nu - 4 * nu + mu * mu * (1 - nu / 2) * (1 - nu / 2);
}

}  // namespace hourglass
