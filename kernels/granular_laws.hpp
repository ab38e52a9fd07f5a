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
  double cohesion = 0;                             ///< yield stress at P = 0 [M/T^2]

  double d_sqrt_rho() const { return diameter * std::sqrt(density); }
  const Grain& at(int /*cell*/) const { return *this; }  ///< the same everywhere: GrainRows is not
};

/// Grains whose properties change along a row of cells. Only d sqrt(rho) enters the law, not each by itself.
struct GrainRows {
  const double *mu_s, *delta_mu, *I_0, *d_sqrt_rho, *cohesion;

  Grain at(int i) const { return {mu_s[i], delta_mu[i], I_0[i], d_sqrt_rho[i], 1, cohesion[i]}; }
};

/// Inertial number I = |γ̇| d / sqrt(P/ρ) (GDR MiDi 2004); written so that P = 0 gives a large number, not a
/// NaN.
inline double inertial_number(double gamma_dot, double pressure, const Grain& g) {
  return gamma_dot * g.diameter * std::sqrt(g.density) / std::sqrt(std::max(pressure, 1e-300));
}

/// mu(I) = mu_s + delta_mu I / (I_0 + I) (Jop, Forterre & Pouliquen 2006).
inline double mu_of_I(double I, const Grain& g) { return g.mu_s + g.delta_mu * I / (g.I_0 + I); }

/// Effective viscosity (mu(I) P + cohesion) / |γ̇| without limits [M/T]. As one fraction, without a division by I:
/// mu P / |γ̇| = P (mu_s r + (mu_s + delta_mu) γ̇ d) / ((r + γ̇ d) γ̇),  r = I_0 sqrt(P/ρ).
inline double granular_viscosity(double gamma_dot, double pressure, const Grain& g) {
  const double rate = std::max(gamma_dot, 1e-30);
  const double slip = rate * g.d_sqrt_rho(), root = g.I_0 * std::sqrt(pressure);
  const double stress =
      pressure * (g.mu_s * root + (g.mu_s + g.delta_mu) * slip) + g.cohesion * (root + slip);
  return stress / ((root + slip) * rate);
}

/// mu(I) bent down at small I so that its equations are well posed there (Barker & Gray 2017, JFM 828:5, eq. 6.3):
/// sqrt(alpha / ln(A/I)) up to I_1, (mu_s I_0 + mu_d I + mu_inf I^2)/(I_0 + I) beyond, mu_d = mu_s + delta_mu.
struct RegularisedFriction {
  double I_1 = 0;        ///< lower end of the well-posed range of mu(I) [1] > 0
  double log_A = 0;      ///< makes mu continuous at I_1
  double alpha = 1.9;    ///< [1] in (0, 2)
  double mu_inf = 0.05;  ///< [1]

  double mu(double I, const Grain& g) const {
    return I > I_1 ? mu_beyond(I, g) : std::sqrt(alpha / (log_A - std::log(std::max(I, 1e-300))));
  }
  /// The branch beyond I_1.
  double mu_beyond(double I, const Grain& g) const {
    return (g.mu_s * g.I_0 + (g.mu_s + g.delta_mu) * I + mu_inf * I * I) / (g.I_0 + I);
  }
};

/// Packing fraction at inertial number I: linear, down to phi_min.
inline double packing_of_I(double I, double phi_max, double phi_g, double phi_min) {
  return std::max(phi_max - phi_g * I, phi_min);
}

/// C(I) of Barker, Schaeffer, Bohorquez & Gray 2015: the equations are well posed where C <= 0.
inline double well_posedness(double I, const Grain& g) {
  const double mu = mu_of_I(I, g);
  const double mu_prime = g.delta_mu * g.I_0 / ((g.I_0 + I) * (g.I_0 + I));
  const double nu = I * mu_prime / mu;
  return 4 * nu * nu - 4 * nu + mu * mu * (1 - nu / 2) * (1 - nu / 2);
}

}  // namespace hourglass
