#pragma once
// Scenes for solver tests, in C++.
#include <algorithm>
#include <cmath>
#include <string>

#include "solver/simulation.hpp"

namespace hourglass {

inline Fill fill_box(int material, double x0, double x1, double y0, double y1) {
  return {material, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

/// An insert of that bounding box, or with those corners.
inline Insert insert_of(Shape shape, double x, double y, double width, double height) {
  return {.shape = shape, .centre = {x, y}, .width = width, .height = height, .points = {}};
}
inline Insert insert_of(std::vector<std::array<double, 2>> corners) {
  return {.shape = Shape::polygon, .points = std::move(corners)};
}

/// Greatest component of the velocity.
inline double fastest(const Fields& f) {
  double speed = 0;
  for (int j = 0; j <= f.p.ny(); ++j)
    for (int i = 0; i <= f.p.nx(); ++i)
      speed =
          std::max({speed, j < f.p.ny() ? std::abs(f.u(i, j)) : 0, i < f.p.nx() ? std::abs(f.v(i, j)) : 0});
  return speed;
}

/// Well posed over I in [0.0136, 1.81] (Lagree, Staron & Popinet 2011); Scene's default set is nowhere.
inline Material well_posed_grains() {
  Material m;
  m.mu_s = 0.32;
  m.delta_mu = 0.28;
  m.I_0 = 0.4;
  return m;
}

/// A scene that check() has nothing to say about.
inline Scene sound_scene() {
  Scene s;
  s.fill = {fill_box(0, 0, 150, 0, 135)};
  s.orifices = {Orifice{}};
  s.time.end = 1;
  s.materials[0] = {.name = "beads", .mu_s = 0.32, .delta_mu = 0.28, .I_0 = 0.4};
  return s;
}

/// The base scene of the reference thesis: 150 d x 150 d filled to 135 d, one orifice in the floor. No output.
/// One thread.
inline Scene silo(int cells, double end = 0, double orifice_centre = 75, double orifice_width = 18.75) {
  Scene s;
  s.cells_x = cells;
  s.fill = {fill_box(0, 0, s.width, 0, 135)};
  s.orifices = {{Side::bottom, orifice_centre, orifice_width}};
  s.time.end = end;
  s.output.series_every = s.output.fields_every = s.output.snapshots_every = 0;
  s.threads = 1;
  return s;
}
/// One of the thesis's units of discharge [rho sqrt(g d^3)] (docs/accuracy.md).
inline constexpr double code_unit = 164.3;

/// A box full of Newtonian fluids, solved tightly in double; one material a viscosity.
inline Scene newtonian(double width, double height, int cells_x, const std::vector<double>& viscosities) {
  Scene s;
  s.width = width;
  s.height = height;
  s.cells_x = cells_x;
  s.gravity = {0, 0};
  s.materials.clear();
  for (double viscosity : viscosities) {
    Material m;
    m.name = "fluid " + std::to_string(s.materials.size());
    m.viscosity = viscosity;
    s.materials.push_back(m);
  }
  s.fill = {fill_box(0, 0, width, 0, height)};
  s.rheology.law = Law::newtonian;
  s.accuracy.precision = Precision::full;
  s.accuracy.viscous_tolerance = 1e-10;
  s.accuracy.pressure_tolerance = 1e-12;
  s.time.dt_max = 1e30;
  s.threads = 1;
  return s;
}

/// Steps until no velocity changes by more than `change` of the largest in a step, or `most` steps; returns their number.
inline int run_to_steady(Simulation& simulation, double change, int most) {
  XFaceField u = simulation.fields().u;
  YFaceField v = simulation.fields().v;
  for (int n = 1; n <= most; ++n) {
    simulation.step();
    const Fields& f = simulation.fields();
    double largest = 0, moved = 0;
    const auto look = [&](const auto& now, auto& before) {
      for (int j = 0; j < now.ny(); ++j)
        for (int i = 0; i < now.nx(); ++i) {
          largest = std::max(largest, std::abs(now(i, j)));
          moved = std::max(moved, std::abs(now(i, j) - before(i, j)));
        }
      before = now;
    };
    look(f.u, u);
    look(f.v, v);
    if (moved <= change * largest) return n;
  }
  return most;
}

}  // namespace hourglass
