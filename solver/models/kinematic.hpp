#pragma once
// The kinematic model of steady silo flow (Nedderman & Tuzun 1979): u = -B dv/dx and div u = 0 give a
// diffusion equation whose time is the height, dv/dy = B d2v/dx2, with v = 0 on the floor and the discharge
// through the orifices. Plane flow:
//   point  v = -q / sqrt(4 pi B y) exp(-x^2 / 4 B y)
//   slot   v = -q / (4 a) [erf((x + a)/s) - erf((x - a)/s)],  |x| < a,  s = sqrt(4 B y)
// and u = -B dv/dx of each. Closed sides by images, which keep the flux through every height at q exactly.
#include "solver/models/sources.hpp"

namespace hourglass {

class KinematicFlow {
 public:
  /// B: length of the model [L] > 0.
  KinematicFlow(Floor floor, double B) : floor_(std::move(floor)), B_(B) {}
  /// Velocity at a height y > 0 over the floor [L/T].
  PointVelocity at(double x, double y) const;
  /// d v / d B [1/T]: (y / B) dv/dy.
  double dv_dB(double x, double y) const;

 private:
  Floor floor_;
  double B_;
};

}  // namespace hourglass
