// A silo that stays filled, and one without air.
#include <catch2/catch.hpp>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Summary drain(const Scene& scene) { return Simulation(scene).run(); }

double left_of(const Scene& scene) {
  Simulation simulation(scene);
  const double before = simulation.grain_mass();
  simulation.run();
  return simulation.grain_mass() / before;
}

}  // namespace

TEST_CASE("a fed silo stays filled, discharges steadily, and its mass is accounted for", "[slow]") {
  Scene s = silo(64, 60);
  s.materials.push_back(s.materials[0]);
  s.materials[1].name = "fed";
  s.feed = Feed{1, 135};
  s.output.series_every = 5;
  struct Rows : Observer {
    std::vector<SeriesRow> rows;
    void on_series(const SeriesRow& row) override { rows.push_back(row); }
  } seen;
  Simulation simulation(s);
  const double full = simulation.grain_mass();
  const Summary summary = simulation.run({&seen});
  CHECK(summary.mass_error < 1e-6);
  CHECK(std::abs(summary.discharge_rate / drain(silo(64, 60)).discharge_rate - 1) <
        0.03);  // the level hardly matters
  const SeriesRow &last = seen.rows.back(), &before = seen.rows[seen.rows.size() - 2];
  CHECK(std::abs(last.outflow / before.outflow - 1) < 5e-3);
  CHECK(std::abs(*last.fed / last.outflow - 1) < 5e-3);
  CHECK(std::abs(last.mass / full - 1) < 1e-3);  // what left in the last step is not made up for yet
  CHECK(last.material_mass[1] > 0.1 * full);     // of what was fed, nothing has reached the orifice
  CHECK_FALSE(seen.rows.front().fed.value() > 0);

  s.feed.reset();
  Simulation unfed(s);
  CHECK_FALSE(unfed.run({&seen}).mass_error > 1e-6);
  CHECK_FALSE(seen.rows.back().fed);
}

TEST_CASE("a feed fills an empty top down to the grains at once") {
  Scene s = silo(32, 0);
  s.fill = {fill_box(0, 0, 150, 0, 60)};
  s.feed = Feed{0, 100};
  s.time.max_steps = 1;
  Simulation simulation(s);
  simulation.run();
  CHECK(std::abs(simulation.grain_mass() - 150 * 100) < 5);  // less what left in a step
}

TEST_CASE("without air: nearly the same discharge, exact mass, rows above the grains left out", "[slow]") {
  for (const bool insert : {false, true}) {
    Scene s = silo(64, 0);
    if (insert) s.inserts = {{Shape::diamond, {75, 56.25}, 37.5, 37.5, {}}};
    s.stop.mass_below = 0.3;
    const Summary passive = drain(s);
    s.air.model = AirModel::none;
    Simulation simulation(s);
    const Summary none = simulation.run();
    INFO((insert ? "diamond: " : "empty: ")
         << none.discharge_rate / passive.discharge_rate << ", mass error " << none.mass_error);
    CHECK(none.status == Status::stopped);
    CHECK(none.missed_tolerances == 0);
    CHECK(none.mass_error < 1e-6);
    CHECK(std::abs(none.discharge_rate / passive.discharge_rate - 1) < 0.01);
    CHECK(simulation.fields().patch().ny < s.patch().ny);
    CHECK(simulation.derived("grains").ny() == s.patch().ny);
  }
}

TEST_CASE("a tank without air stays at rest") {
  for (const double level : {60.0, 61.3, 63.9}) {
    Scene s = silo(32, 0);
    s.orifices.clear();
    s.fill = {fill_box(0, 0, 150, 0, level)};
    s.air.model = AirModel::none;
    s.start_pressure = StartPressure::hydrostatic;
    s.time.max_steps = 100;
    Simulation simulation(s);
    simulation.run();
    const double speed = fastest(simulation.fields());
    INFO("level " << level << ": " << speed);
    CHECK(speed < 1e-9);
    CHECK(left_of(s) == Approx(1).epsilon(1e-12));
  }
}
