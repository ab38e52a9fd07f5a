#include "studies/extrapolation.hpp"

#include <catch2/catch.hpp>

#include "solver/diagnostics.hpp"
#include "studies/richardson.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// A summary of a run that loses mass at this rate, and share, up to `end`.
Summary steady(double rate, double share, double end, long cells) {
  Summary s;
  s.cells = cells;
  s.discharge_window[0] = 10;
  s.discharge_window[1] = end;
  for (double t = 0; t <= end; t += 0.5) {
    s.mass_over_time.push_back({t, 1000 - rate * t});
    s.quasi_static_over_time.push_back({t, share});
  }
  s.discharge_rate = rate;
  return s;
}

CoarseRuns coarse_runs(std::vector<Summary> summaries) {
  CoarseRuns runs;
  for (Summary& s : summaries) runs.cases.emplace_back().summary = std::move(s);
  return runs;
}

}  // namespace

TEST_CASE("extrapolation: figures of three grids over their common window") {
  const CoarseRuns coarse = coarse_runs({steady(0.84, 0.16, 60, 256), steady(0.96, 0.19, 55, 1024)});
  Summary fine = steady(0.99, 0.2, 50, 4096);
  // What happens outside of the window of another grid does not count: here the finest goes on for longer.
  fine.discharge_window[1] = 60;
  for (double t = 56; t <= 60; t += 0.5) fine.mass_over_time.push_back({t, 0});
  extrapolate(coarse, fine);
  REQUIRE(fine.extrapolation);
  const Extrapolation& e = *fine.extrapolation;
  CHECK(e.cells == std::vector<long>{256, 1024, 4096});
  CHECK(e.discharge_rates[0] == Approx(0.84));
  CHECK(e.discharge_rates[2] == Approx(0.99));
  CHECK(e.order == Approx(2));
  CHECK(e.discharge_rate == Approx(1));
  CHECK(e.error_bar == Approx(1.25 * 0.01));
  CHECK(e.quasi_static_fraction == Approx(richardson(std::vector{0.16, 0.19, 0.2}).value));
  CHECK(fine.discharge_rate == 0.99);  // that of its own grid
  CHECK(fine.warnings.empty());
}

TEST_CASE("extrapolation: a discharge that depends on the step is said aloud") {
  CoarseRuns coarse = coarse_runs({steady(0.84, 0.16, 60, 256), steady(0.96, 0.19, 60, 1024)});
  for (const double halved : {0.85, 0.80}) {
    coarse.half_steps.emplace().summary = steady(halved, 0.16, 60, 256);
    Summary fine = steady(0.99, 0.2, 60, 4096);
    extrapolate(coarse, fine);
    REQUIRE(fine.extrapolation);
    CHECK(fine.extrapolation->step_change.value() == Approx(halved / 0.84 - 1));
    CHECK(fine.warnings.size() == (halved < 0.82 ? 1 : 0));
    if (halved < 0.82) CHECK_THAT(fine.warnings[0], Catch::Contains("depends on the time step"));
  }
}

TEST_CASE("extrapolation: none where a grid failed, where windows are apart, and doubts are said") {
  CoarseRuns failed = coarse_runs({steady(0.84, 0.16, 60, 256)});
  failed.stopped = "16 cells across: something";
  Summary fine = steady(0.99, 0.2, 50, 4096);
  extrapolate(failed, fine);
  CHECK_FALSE(fine.extrapolation);
  REQUIRE(fine.warnings.size() == 1);
  CHECK_THAT(fine.warnings[0], Catch::Contains("16 cells across: something"));

  fine = steady(0.99, 0.2, 50, 4096);
  extrapolate(coarse_runs({steady(0.84, 0.16, 15, 256)}), fine);
  CHECK_FALSE(fine.extrapolation);

  Summary troubled = steady(0.96, 0.16, 50, 256);
  troubled.missed_tolerances = 3;
  fine = steady(0.99, 0.2, 50, 4096);
  extrapolate(coarse_runs({troubled}), fine);
  CHECK(fine.extrapolation);
  REQUIRE(fine.warnings.size() == 1);
  CHECK(fine.warnings[0] == "the coarser run with 256 cells missed 3 tolerances");

  fine = steady(0.99, 0.2, 50, 4096);
  extrapolate(coarse_runs({steady(0.96, 0.2, 50, 256), steady(1.0, 0.2, 50, 256)}), fine);
  REQUIRE(fine.extrapolation);
  CHECK(fine.extrapolation->error_bar == Approx(0.12));
  REQUIRE(fine.warnings.size() == 1);
  CHECK_THAT(fine.warnings[0], Catch::Contains("discharge rate does not approach its limit from one side"));
}

TEST_CASE("extrapolation: the coarser grids of a scene are run, and an interrupt ends them") {
  Scene scene = silo(64, 2, 75, 37.5);
  scene.accuracy.extrapolate = 2;
  scene.output.series_every = 0.25;
  Observer nobody;
  const CoarseRuns runs = run_coarser(scene, true, nobody);
  CHECK(runs.stopped.empty());
  REQUIRE(runs.cases.size() == 2);
  CHECK(runs.cases[0].summary.cells == 16 * 16);
  CHECK(runs.cases[1].summary.cells == 32 * 32);
  for (const CaseResult& c : runs.cases) {
    CHECK(c.summary.mass_over_time.back()[0] == 2);
    CHECK(c.summary.discharge_rate > 0);
  }
  CHECK(runs.seconds > 0);
  REQUIRE(runs.half_steps);
  CHECK(runs.half_steps->summary.cells == 16 * 16);
  CHECK(runs.half_steps->summary.steps > 1.5 * runs.cases[0].summary.steps);

  struct Stop : Observer {
    std::string interrupt() override { return "enough"; }
  } stop;
  const CoarseRuns stopped = run_coarser(scene, true, stop);
  CHECK(stopped.interrupted);
  CHECK(stopped.cases.size() == 1);
}

TEST_CASE("extrapolation: every grid has to be a sound scene") {
  const auto messages = [](const Scene& scene) {
    std::string all;
    for (const Problem& p : check(scene))
      if (p.fatal) all += p.path + ": " + p.message + "\n";
    return all;
  };
  const auto sound = [](Scene scene) {
    scene.output.series_every = 1;
    return scene;
  };
  Scene scene = sound(silo(64, 2, 75, 37.5));
  for (const int grids : {0, 1, 2}) {
    scene.accuracy.extrapolate = grids;
    CHECK(messages(scene).empty());
  }
  scene.accuracy.extrapolate = 3;
  CHECK_THAT(messages(scene), Catch::Contains("accuracy.extrapolate: 3 is out of range (must be 0 to 2)"));
  scene.accuracy.extrapolate = 2;
  scene.orifices[0].width = 18.75;
  CHECK_THAT(messages(scene),
             Catch::Contains(
                 "accuracy.extrapolate: 2 needs the scene on 16 cells across too: an orifice 2 cells wide") &&
                 Catch::Contains("Use extrapolate 1, or more cells"));
  scene.inserts = {insert_of(Shape::square, 75, 75, 6, 6)};
  CHECK_THAT(messages(scene),
             Catch::Contains("on 32 cells across too: inserts.0") && Catch::Contains("Use extrapolate 0"));
  scene = sound(silo(62, 2, 75, 75));
  scene.accuracy.extrapolate = 2;
  CHECK_THAT(messages(scene), Catch::Contains("31 cells across cannot be halved"));
  scene.orifices.clear();
  CHECK(messages(scene).empty());  // nothing discharges, nothing is extrapolated
}
