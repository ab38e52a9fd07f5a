// A run that meets trouble goes back to the last state kept and on with more care (docs/theory.md, Trouble).
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "solver/simulation.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// Spoils the fields after some steps, once each; keeps what the run tells.
class Spoiler : public Observer {
 public:
  Spoiler(Simulation& simulation, std::vector<long> steps, double value)
      : simulation_(simulation), steps_(std::move(steps)), value_(value) {}
  void on_step(const StepReport& report, double) override {
    for (long& step : steps_)
      if (report.step == step) {
        simulation_.fields().v(10, 10) = value_;
        step = -1;
      }
  }
  void on_series(const SeriesRow& row) override { times.push_back(row.step.t); }
  void on_warning(const std::string& text) override { warnings.push_back(text); }
  std::vector<double> times;
  std::vector<std::string> warnings;

 private:
  Simulation& simulation_;
  std::vector<long> steps_;
  double value_;
};

Scene short_silo() {
  Scene scene = silo(32, 12);
  scene.output.series_every = 1;
  return scene;
}

}  // namespace

TEST_CASE("a number that is none, and a speed without a reason, cost a few steps and no more") {
  Simulation plain(short_silo());
  const Summary untroubled = plain.run();
  REQUIRE(untroubled.back_offs == 0);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    Simulation simulation(short_silo());
    Spoiler spoiler(simulation, {70, 150}, value);
    const Summary summary = simulation.run({&spoiler});
    INFO(summary.reason);
    CHECK(summary.status == Status::finished);
    CHECK(summary.back_offs == 2);
    CHECK(summary.missed_tolerances == 0);
    CHECK(summary.mass_error < 1e-6);
    CHECK(summary.discharge_rate == Approx(untroubled.discharge_rate).epsilon(1e-2));
    REQUIRE(spoiler.times.size() == 13);  // nothing told twice, nothing left out
    for (std::size_t k = 0; k < spoiler.times.size(); ++k) CHECK(std::floor(spoiler.times[k]) == double(k));
    REQUIRE(spoiler.warnings.size() == 2);
    CHECK_THAT(spoiler.warnings[0],
               Catch::Contains("cell (10") && Catch::Contains("step 7") && Catch::Contains("back to t = "));
    CHECK(summary.warnings == spoiler.warnings);
  }
}

TEST_CASE("trouble that no care helps ends the run with its last good state") {
  Scene scene = short_silo();
  Simulation simulation(scene);
  class Always : public Observer {
   public:
    explicit Always(Simulation& s) : s_(s) {}
    void on_step(const StepReport& report, double) override {
      if (report.step >= 40) s_.fields().p(5, 5) = s_.fields().u(5, 5) = std::nan("");
    }
    void on_series(const SeriesRow& row) override { told = row.step.t; }
    double told = 0;

   private:
    Simulation& s_;
  } always(simulation);
  const Summary summary = simulation.run({&always});
  CHECK(summary.status == Status::diverged);
  CHECK_THAT(summary.reason, Catch::Contains("is not a number in cell (5, 5)") && Catch::Contains("t = "));
  CHECK(summary.back_offs == 4);
  CHECK(std::isfinite(simulation.fields().u(5, 5)));
  CHECK(simulation.t() > 0);
  CHECK(always.told == simulation.t());
  CHECK(summary.mass_error < 1e-6);
}

TEST_CASE("a tolerance out of reach is reported, and ends the run") {
  Scene scene = short_silo();
  scene.accuracy.max_iterations = 1;
  scene.accuracy.pressure_tolerance = 1e-14;
  Simulation simulation(scene);
  const Summary summary = simulation.run();
  CHECK(summary.status == Status::diverged);
  CHECK(summary.back_offs >= 4);
  CHECK(summary.missed_tolerances > 0);
  CHECK_FALSE(summary.warnings.empty());
  CHECK_THAT(summary.reason, Catch::Contains("missed"));
}

TEST_CASE("without a backup a run ends at the first trouble") {
  Scene scene = short_silo();
  scene.accuracy.backup_every = 0;
  Simulation simulation(scene);
  Spoiler spoiler(simulation, {20}, std::numeric_limits<double>::quiet_NaN());
  const Summary summary = simulation.run({&spoiler});
  CHECK(summary.status == Status::diverged);
  CHECK(summary.back_offs == 0);
  CHECK_THAT(summary.reason, Catch::Contains("is not a number"));
}
