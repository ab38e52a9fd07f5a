#pragma once
// A channel of grains for exact shear flows along x.
#include "tests/support/make_scene.hpp"

namespace hourglass {

/// Four cells wide and periodic, full of well-posed grains of diameter d; gravity along x drives, the floor does not slip.
/// No smoothing, tight tolerances in double. Height, g and density are of order 1.
inline Scene granular_channel(double height, int cells, std::array<double, 2> gravity, double d, Wall top) {
  Scene s;
  s.height = height;
  s.width = 4 * height / cells;
  s.cells_x = 4;
  s.gravity = gravity;
  s.materials = {well_posed_grains()};
  s.materials[0].diameter = d;
  s.fill = {fill_box(0, 0, s.width, 0, height)};
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, top};
  s.rheology.eta_min = 1e-6;
  s.rheology.eta_max = 1e5;
  s.rheology.smoothing_length = 0;
  s.time.dt_max = 1e30;
  s.accuracy.viscous_tolerance = 1e-7;
  s.accuracy.pressure_tolerance = 1e-9;
  s.accuracy.precision = Precision::full;
  s.threads = 1;
  return s;
}

/// u = velocity(y) everywhere.
template <class Velocity>
void start(Fields& f, Velocity&& velocity) {
  for (int j = 0; j < f.u.ny(); ++j)
    for (int i = 0; i < f.u.nx(); ++i) f.u(i, j) = velocity(f.patch().y_centre(j));
}

}  // namespace hourglass
