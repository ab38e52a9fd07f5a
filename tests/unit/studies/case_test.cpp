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
