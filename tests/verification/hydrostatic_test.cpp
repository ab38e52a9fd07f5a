// A tank at rest stays at rest, to rounding, wherever its surface lies in a cell; its pressure is the weight above.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Scene tank(double filled_to, bool open, Precision precision) {
  Scene s = silo(32);
  s.orifices.clear();
  s.fill = {fill_box(0, 0, 150, 0, filled_to)};
  if (!open) s.walls[static_cast<int>(Side::top)] = Wall::no_slip;
  s.start_pressure = StartPressure::hydrostatic;
  s.accuracy.precision = precision;
  return s;
}

}  // namespace

TEST_CASE("a tank at rest stays at rest") {
  for (bool open : {true, false})
    for (Precision precision : {Precision::mixed, Precision::full})
      for (double filled_to : {101.3, 101.5725, 135.0}) {  // 0.6 of a cell, a sliver, 0.8 of a cell
        Simulation simulation(tank(filled_to, open, precision));
        const char* how = precision_names[static_cast<int>(precision)];
        INFO(filled_to << (open ? ", open top, " : ", closed, ") << how);
        double first = 0;
        for (int step = 1; step <= 20; ++step) {
          const StepReport report = simulation.step();
          CHECK(report.pressure.converged);
          CHECK(report.viscous.converged);
          if (step == 1) first = fastest(simulation.fields());
        }
        const double last = fastest(simulation.fields());
        CHECK(first < 1e-12);  // sqrt(g d) = 1, free fall in one step: 0.05
        CHECK(last < 1e-11);

        // Differences of p are means of densities: from the middle of a cell to the top they add up to the weight between.
        const Fields& f = simulation.fields();
        const double h = f.patch().h, air = simulation.scene().air.density;
        const double level =
            open ? 0 : f.p(5, f.p.ny() - 1) - 0.5 * h * air;  // a closed box: up to a constant
        double error = 0;
        for (int j = 0; j < f.p.ny(); ++j) {
          if (f.grains(5, j) > 0 && f.grains(5, j) < 1) continue;  // its middle is either grains or air
          const double y = f.patch().y_centre(j), grains = std::max(0.0, filled_to - y);
          const double weight = grains + (150 - y - grains) * air;
          for (int i : {0, 5, 31}) error = std::max(error, std::abs(f.p(i, j) - level - weight));
        }
        figure("tank to %.4f, %s, %s: speed %.1e after 1 step, %.1e after 20; pressure error %.1e", filled_to,
               open ? "open" : "closed", how, first, last, error);
        CHECK(error < (precision == Precision::full ? 1e-10 : 1e-5));  // mixed: 1 / rho is float
      }
}

TEST_CASE("a tank that starts without pressure settles") {
  // Not in one step: before the projection the grains have fallen for a step past walls that hold them.
  Scene scene = tank(101.3, true, Precision::mixed);
  scene.start_pressure = StartPressure::zero;
  Simulation simulation(scene);
  simulation.step();
  const double first = fastest(simulation.fields());
  for (int step = 2; step <= 100; ++step) simulation.step();
  const double last = fastest(simulation.fields()), p = simulation.fields().p(5, 0);
  figure("tank from p = 0: speed %.1e after 1 step, %.1e after 100, pressure at the bottom %.3f", first, last,
         p);
  CHECK(first < 6e-3);
  CHECK(last < 5e-4);
  CHECK(p == Approx(101.3 - 0.5 * 150 / 32 + 1e-3 * (150 - 101.3)).epsilon(2e-3));
}
