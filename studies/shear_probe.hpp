#pragma once
// How fast a small oblique wave grows in a uniform shear flow of grains: measured in a run, and in theory. The flow is
// u = γ̇ y at constant P, so one inertial number everywhere; the wave is short against everything but the cells.
//
// Theory (Barker, Schaeffer, Bohorquez & Gray 2015, and the same for the scheme). At angle φ of the wave vector against
// the flow, c = cos 2φ, S = sin 2φ, with nu = dln mu/dln I, q = mu (1 - nu/2), s = eta k² Δt/ρ and r = s (2 - ω)/(1 + 2 s)
// the share of an error of the pressure that a step leaves (docs/theory.md, Splitting), a step takes stream function ψ and
// pressure p γ̇/(P k²) of the wave to
//
//   (1 + s) ψ' = (1 + s (1 - nu) c² a² F) ψ - s c (1 - nu/2) a p
//           p' = (1 - r) S (-mu (1 - nu) c a² F ψ + q a p) + r p
//
// a = cos(k_x h/2) cos(k_y h/2) is what the means between cells and corners leave of the wave, F what the smoothing of
// the shear rate leaves: exp(-k² l²/4). Without those two the greater eigenvalue passes 1 where
// λ(φ) = (1 - nu) c² + q S does, whatever s and ω are.
#include "kernels/granular_laws.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// mu and nu = dln mu/dln I at an inertial number.
struct FrictionAt {
  double mu, nu;
};
/// By the law of the rheology.
FrictionAt friction_at(double I, const Material& material, const Rheology& rheology);

/// λ at the worst angle: what lagging the viscosity by a step multiplies a short wave in stiff grains with, in the limit of
/// large s. Above 1 it grows.
double lag_factor(const FrictionAt& friction);

struct ShearProbe {
  Scene scene;             ///< its first material, rheology, nonlocal and splitting are what is probed
  double I = 0.01;         ///< inertial number [1] > 0
  double pressure = 67.5;  ///< [M/T^2] > 0
  double wavelength = 4;   ///< [L] > 0
  double stiffness = 1;    ///< s = eta k² Δt/ρ of the viscosity without its cap, which sets the step
  int cells = 32;          ///< across one period along the flow
  int steps = 18;

  double angle() const;       ///< of the wave vector against the flow, where it grows fastest [rad]
  double viscosity() const;   ///< mu P/γ̇ [M/T]
  double shear_rate() const;  ///< [1/T]
  double time_step() const;   ///< [T]
};

/// ln of the factor by which the wave grows.
struct Growth {
  double per_step = 0;   ///< [1]; NaN if the run failed
  double per_shear = 0;  ///< per time, over the shear rate [1]
};

/// Runs the probe and follows the wave: least-squares slope over the steps, the first few left out.
Growth measured_growth(const ShearProbe& probe);

/// By the theory above; capped grains, eta_max < mu P/γ̇, are a Newtonian fluid. NaN with physics.nonlocal and with more than one
/// round a step.
Growth predicted_growth(const ShearProbe& probe);

}  // namespace hourglass
