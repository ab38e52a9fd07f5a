#include "solver/time_step.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

constexpr double h = 0.5, plenty = 1e300;

TimeStep chosen(const FastestCells& fastest, double before, double left = plenty, const Scene& scene = {}) {
  return choose_time_step(scene, fastest, h, before, left);
}

}  // namespace

TEST_CASE("the time step is the smallest of its limits, and says which one") {
  const double before = 10;  // growth does not bind
  CHECK(chosen({0, 0}, before).limit == DtLimit::dt_max);
  CHECK(chosen({0, 0}, before).dt == Approx(0.0548));
  const TimeStep cfl = chosen({50, 0}, before);
  CHECK(cfl.limit == DtLimit::cfl);
  CHECK(cfl.dt == Approx(0.5 * h / 50));
  const TimeStep air = chosen({1, 100}, before);
  CHECK(air.limit == DtLimit::cfl_air);
  CHECK(air.dt == Approx(0.9 * h / 100));
  const TimeStep end = chosen({0, 0}, before, 1e-3);
  CHECK(end.limit == DtLimit::end);
  CHECK(end.dt == 1e-3);
  const TimeStep rounded = chosen({0, 0}, before, 0.0548 * (1 + 1e-12));  // and not a step of 1e-14 after it
  CHECK(rounded.limit == DtLimit::end);
  CHECK(rounded.dt == 0.0548 * (1 + 1e-12));
}

TEST_CASE("the time step grows by a quarter from a small first one") {
  const TimeStep first = chosen({0, 0}, 0);
  CHECK(first.dt == Approx(std::min(0.0548, 0.1 * std::sqrt(h))));
  const TimeStep next = chosen({0, 0}, 1e-3);
  CHECK(next.limit == DtLimit::growth);
  CHECK(next.dt == Approx(1.25e-3));
  Scene weightless;
  weightless.gravity = {0, 0};
  CHECK(chosen({0, 0}, 0, plenty, weightless).limit == DtLimit::dt_max);
}

TEST_CASE("the fastest cells: grains count with their neighbours, air apart") {
  const Patch p{12, 10, 1, 0, 0};
  Fields f(p, 1);
  f.grains(3, 4) = 0.01;
  f.u(5, 4) = -7;  // right of cell (4, 4), beside the grains
  f.v(9, 8) = 30;  // far off
  f.u(10, 8) = 4;
  std::array<RowSums, 2> rows{RowSums(p.ny), RowSums(p.ny)};
  for (int threads : {1, 3}) {
    const FastestCells fastest = fastest_cells(f, threads, rows);
    CHECK(fastest.near_grains == 7);
    CHECK(fastest.air == 34);
  }
  f.v(9, 8) = std::nan("");
  const FastestCells broken = fastest_cells(f, 1, rows);
  CHECK_FALSE(std::isfinite(broken.air + broken.near_grains));
}

TEST_CASE("every limit has a name") {
  for (DtLimit limit : {DtLimit::dt_max, DtLimit::cfl, DtLimit::cfl_air, DtLimit::growth, DtLimit::end})
    CHECK(std::string(name_of(limit)).size() > 2);
}

TEST_CASE("a step ends at the limit that it is given, exactly") {
  Scene s = silo(32);
  Simulation simulation(s);
  while (simulation.t() < 0.5) simulation.step(0.5);
  CHECK(simulation.t() == 0.5);
  const StepReport report = simulation.step();
  CHECK(report.t == simulation.t());
  CHECK(report.dt > 1e-3);  // the cut step before does not slow down the next
}

TEST_CASE(
    "what falls due at a multiple of the step is shown at that time, free of the rounding of their sum") {
  struct Times : Observer {
    std::vector<double> of_fields;
    void on_fields(const Simulation& simulation) override { of_fields.push_back(simulation.t()); }
  } times;
  Scene s = silo(16);
  s.output.series_every = s.output.fields_every = 10 * s.time.dt_max;
  s.output.snapshots_every = 0;
  s.time.end = 31 * s.time.dt_max;
  const Summary summary = Simulation(s).run({&times});
  const double every = s.output.fields_every;
  CHECK(times.of_fields == std::vector<double>{0, every, 2 * every, 3 * every, s.time.end});
  CHECK(summary.steps == 31);
}
