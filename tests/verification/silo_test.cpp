// The base silo drains: conservation, bounds, small orifices, the guard that speaks when nothing flows.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// Watches the grains' bounds, their account and the solvers at every step. One orifice lets grains out.
class Watch : public Observer {
 public:
  explicit Watch(const Simulation& simulation)
      : simulation_(simulation), initial_mass_(simulation.grain_mass()) {}
  void on_step(const StepReport& report, double) override {
    const CellField& c = simulation_.fields().grains;
    for (int j = 0; j < c.ny(); ++j)
      for (int i = 0; i < c.nx(); ++i) {
        low = std::min(low, c(i, j));
        high = std::max(high, c(i, j));
      }
    const double missing = initial_mass_ - simulation_.grain_mass() - simulation_.orifice_mass()[0];
    worst_mass_error = std::max(worst_mass_error, std::abs(missing) / initial_mass_);
    worst_divergence = std::max(worst_divergence, report.max_divergence);
    most_viscous = std::max(most_viscous, report.viscous.iterations);
    most_pressure = std::max(most_pressure, report.pressure.iterations);
  }
  double low = 1, high = 0, worst_divergence = 0, worst_mass_error = 0;
  int most_viscous = 0, most_pressure = 0;

 private:
  const Simulation& simulation_;
  const double initial_mass_;
};

}  // namespace

TEST_CASE("a whole drain at 64^2 conserves grains and keeps their share in [0, 1]") {
  Scene scene = silo(64, 200);
  scene.stop.mass_below = 0.25;
  Simulation simulation(scene);
  Watch watch(simulation);
  const Summary summary = simulation.run({&watch});
  CHECK(summary.status == Status::stopped);  // it drains
  CHECK(summary.missed_tolerances == 0);
  CHECK(summary.warnings.empty());
  CHECK(summary.mass_error < 1e-6);
  CHECK(watch.worst_mass_error < 1e-6);
  CHECK(watch.low > -1e-9);
  CHECK(watch.high < 1 + 1e-9);
  CHECK(watch.worst_divergence <= 1.0001 * scene.accuracy.pressure_tolerance);
  CHECK(watch.most_viscous <= 10);
  CHECK(watch.most_pressure <= 9);
  CHECK(summary.discharge_rate / code_unit == Approx(0.514).margin(0.012));
  figure(
      "drain 64^2: %ld steps, mass error %.1e, grains in [%.1e, 1 + %.1e], rate %.4f, iterations at most %d, "
      "%d",
      summary.steps, watch.worst_mass_error, watch.low, watch.high - 1, summary.discharge_rate / code_unit,
      watch.most_viscous, watch.most_pressure);
}

TEST_CASE(
    "the default levers cost no accuracy: rate, static share and mass as with tight tolerances in double",
    "[slow]") {
  Scene scene = silo(128, 27.386);
  const Summary quick = Simulation(scene).run();
  scene.accuracy = {.viscous_tolerance = 1e-6, .pressure_tolerance = 1e-9, .precision = Precision::full};
  const Summary tight = Simulation(scene).run();
  figure("default and tight: rate %.4f %.4f, static %.4f %.4f, mass error %.1e %.1e",
         quick.discharge_rate / code_unit, tight.discharge_rate / code_unit, quick.quasi_static_fraction,
         tight.quasi_static_fraction, quick.mass_error, tight.mass_error);
  CHECK(quick.discharge_rate == Approx(tight.discharge_rate).epsilon(2e-3));
  CHECK(quick.quasi_static_fraction == Approx(tight.quasi_static_fraction).epsilon(1e-2));
  CHECK(quick.mass_error < 1e-6);
}

TEST_CASE("the discharge at 128^2 lies where the grid study puts it", "[slow]") {
  // docs/accuracy.md: 0.5430 at 128^2, Richardson 0.554; the independent reference says 0.56 +- 0.02.
  const Summary summary = Simulation(silo(128, 27.386)).run();
  CHECK(summary.discharge_rate / code_unit == Approx(0.543).margin(0.005));
  CHECK(summary.missed_tolerances == 0);
}

TEST_CASE("small orifices flow at any viscosity cap", "[slow]") {
  struct Case {
    int cells;
    double low, high;  // code units
  };
  for (const Case c : {Case{4, 0.01, 0.06}, Case{6, 0.05, 0.14}, Case{8, 0.10, 0.21}, Case{12, 0.26, 0.40}})
    for (const double eta_max : {1.643e4, 1.643e5, 1.643e6}) {
      Scene scene = silo(128, 27.386, 75, c.cells * 150.0 / 128);
      scene.rheology.eta_max = eta_max;
      const Summary summary = Simulation(scene).run();
      const double rate = summary.discharge_rate / code_unit;
      INFO(c.cells << " cells, eta_max " << eta_max << ": " << rate);
      figure("orifice of %d cells at 128^2, eta_max %.3e: rate %.4f, mass error %.1e, missed %ld", c.cells,
             eta_max, rate, summary.mass_error, summary.missed_tolerances);
      CHECK(summary.missed_tolerances == 0);
      CHECK(summary.warnings.empty());
      CHECK(rate > c.low);
      CHECK(rate < c.high);
      CHECK(summary.mass_error < 1e-6);
    }
}

TEST_CASE(
    "a jammed orifice is reported: friction beyond measure, or a narrow hole that starts under full "
    "pressure") {
  Scene stuck = silo(64, 20, 75, 2 * 150.0 / 64);
  stuck.materials[0].mu_s = 50;
  Scene pressed = silo(64, 20, 75, 2 * 150.0 / 64);
  pressed.start_pressure = StartPressure::hydrostatic;
  for (const Scene& scene : {stuck, pressed}) {
    const Summary summary = Simulation(scene).run();
    REQUIRE_FALSE(summary.warnings.empty());
    CHECK_THAT(summary.warnings[0], Catch::Contains("orifice 0 is open but does not flow"));
  }
}

TEST_CASE("an open orifice with no grains above it is reported") {
  Scene scene = silo(64, 20);
  scene.fill = {fill_box(0, 0, 30, 0, 20)};  // a heap in the corner that does not reach the hole
  scene.materials[0].mu_s = 5;
  const Summary summary = Simulation(scene).run();
  REQUIRE_FALSE(summary.warnings.empty());
  CHECK(summary.warnings[0].find("orifice 0 is open but does not flow") != std::string::npos);
}

TEST_CASE("an inert tracer changes nothing and keeps its mass") {
  Scene plain = silo(64, 8), layered = plain;
  Material tracer = layered.materials[0];
  tracer.name = "tracer";
  layered.materials.push_back(tracer);
  layered.fill.push_back(fill_box(1, 0, 150, 75, 135));
  Simulation a(plain), b(layered);
  const double before = b.material_mass()[1];
  a.run();
  b.run();
  CHECK(b.grain_mass() == Approx(a.grain_mass()).epsilon(1e-12));
  CHECK(b.material_mass()[1] == Approx(before).epsilon(1e-6));  // none has reached the orifice yet
}
