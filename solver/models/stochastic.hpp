#pragma once
// The stochastic (spot) model of steady silo flow (Kamrin & Bazant 2007): spots of loosened grains of size
// L_s leave the orifice, drift upwards and diffuse with d rho/dy = (L_s/2) lap rho; grains move against their
// flux,
//   (u, v) = q [ (L_s/2) grad rho - rho e_y ],
// which is solenoidal. A point source of unit flux, with R = sqrt(x^2 + y^2) and K1 the modified Bessel
// function:
//   rho = y exp(y/L_s) K1(R/L_s) / (pi L_s R)
// Slots by adaptive quadrature. Far above (y >> L_s) this is the kinematic model with B = L_s/2. Closed sides
// by images.
//
// A spot moves the grains over its own width: `spot` > 0 averages the flow over this width along x. (Across y
// it is not averaged, so that the flux through every height stays q and nothing reaches below the floor.)
#include <array>

#include "solver/models/sources.hpp"

namespace hourglass {

class StochasticFlow {
 public:
  /// L_s [L] > 0; spot: width of the average [L] >= 0.
  StochasticFlow(Floor floor, double L_s, double spot = 0) : floor_(std::move(floor)), L_(L_s), spot_(spot) {}
  /// Velocity at a height y > 0 over the floor [L/T], with an error below 1e-12 of the largest at this
  /// height.
  PointVelocity at(double x, double y) const;

 private:
  PointVelocity point(double x, double y) const;  // of unit flux
  PointVelocity spread(double x, double y, double slot) const;

  Floor floor_;
  double L_, spot_;
};

/// exp(s) K_0(s) and exp(s) K_1(s), s > 0, to 1e-14 of their values.
std::array<double, 2> scaled_bessel_k(double s);

}  // namespace hourglass
