#include "studies/case.hpp"

#include <catch2/catch.hpp>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

TEST_CASE("a case: the summary and every row of its series") {
  Scene scene = sound_scene();
  scene.cells_x = 16;
  scene.time.end = 1;
  scene.output.series_every = 0.25;
  double at_end = -1;
  const CaseResult result = run_case(scene, {.at_end = [&](const Simulation& s) { at_end = s.t(); }});
  CHECK_FALSE(result.failed());
  CHECK(result.summary.status == Status::finished);
  REQUIRE(result.series.size() == 5);
  CHECK(result.series.back().step.t == 1);
  CHECK(at_end == 1);
  CHECK(result.cpu_seconds > 0);
}

TEST_CASE("a case of a model in closed form has one row and its discharge") {
  Scene scene = silo(32);
  scene.model = Model::kinematic;
  const CaseResult result = run_case(scene);
  CHECK_FALSE(result.failed());
  REQUIRE(result.series.size() == 1);
  CHECK(result.series[0].outflow == result.summary.discharge_rate);
  CHECK(result.summary.discharge_constant == Approx(1).epsilon(1e-14));
}
