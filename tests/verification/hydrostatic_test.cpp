// A tank with its surface inside a cell is at rest, to rounding.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

TEST_CASE("a tank at rest stays at rest") {
  for (const Precision precision : {Precision::mixed, Precision::full}) {
    Scene scene = silo(32);
    scene.orifices.clear();
    scene.fill = {fill_box(0, 0, 150, 0, 101.3)};  // 21.6 cells
    scene.start_pressure = StartPressure::hydrostatic;
    scene.accuracy.precision = precision;
    Simulation tank(scene);
    for (int k = 0; k < 20; ++k) {
      const StepReport report = tank.step();
      CHECK(report.pressure.converged);
      CHECK(report.viscous.converged);
    }
    const Fields& f = tank.fields();
    double fastest = 0;
    for (int j = 0; j < f.p.ny(); ++j)
      for (int i = 0; i < f.p.nx(); ++i) fastest = std::max({fastest, std::abs(f.u(i, j)), std::abs(f.v(i, j))});
    CHECK(fastest < 1e-10);  // sqrt(g d) = 1, free fall in one step: 0.05
    // p is the weight above: dense cells, the cell of the surface, air.
    const double h = f.patch().h;
    double p = 0.5 * h * scene.air.density, density_above = scene.air.density;
    for (int j = f.p.ny() - 1; j >= 0; --j) {
      const double c = f.grains(5, j), density = c + (1 - c) * scene.air.density;
      if (j < f.p.ny() - 1) p += 0.5 * h * (density + density_above);
      density_above = density;
      CHECK(f.p(5, j) == Approx(p).epsilon(2e-6));  // coefficients are float in mixed precision
    }
  }
}
