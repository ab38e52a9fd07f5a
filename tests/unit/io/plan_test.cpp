#include "io/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "io/forecast.hpp"
#include "solver/simulation.hpp"

using namespace hourglass;

namespace {

/// A small silo that runs a hundred steps in a blink.
Scene small_silo() {
  Scene scene;
  scene.width = scene.height = 30;
  scene.cells_x = 16;
  scene.fill = {{0, {{0, 0}, {30, 0}, {30, 26}, {0, 26}}}};
  scene.orifices = {{Side::bottom, 15, 15}};
  scene.time.end = 2;
  scene.threads = 1;
  return scene;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What the scene says of a key that is on; empty if it is off.
std::string on(const Scene& scene, const std::string& key) {
  for (const Switch& s : switches_of(scene).on)
    if (s.key == key) return s.what;
  return "";
}

bool off(const Scene& scene, const std::string& key) {
  const auto keys = switches_of(scene).off;
  return std::count(keys.begin(), keys.end(), key) == 1;
}

/// The whole run, as the copy that it is predicted from.
Trial whole(const Scene& scene) {
  Simulation simulation(scene);
  return try_out(simulation, 1e9);
}

}  // namespace

TEST_CASE("plan: a plain scene switches on no more than smoothing") {
  const Scene scene = small_silo();
  const Switches s = switches_of(scene);
  REQUIRE(s.on.size() == 1);
  CHECK(s.on[0].key == "physics.rheology.smoothing_length");
  for (const char* key :
       {"physics.rheology.law", "physics.rheology.cap", "physics.nonlocal", "physics.dilatancy",
        "physics.wall_friction", "cohesion", "tracers", "accuracy.splitting", "accuracy.precision"})
    CHECK(off(scene, key));
  CHECK(contains(text_of(s), "Off, neither stored nor paid for: domain.symmetry"));
}

TEST_CASE("plan: each switch is named with its key, and is either on or off") {
  Scene scene = small_silo();
  scene.rheology.smoothing_length = 0;
  CHECK(off(scene, "physics.rheology.smoothing_length"));
  scene.rheology.law = Law::mu_I_regularised;
  scene.rheology.cap = Cap::smooth;
  scene.nonlocal = Nonlocal{.A = 0.7};
  scene.dilatancy = Dilatancy{.mode = DilatancyMode::relax};
  scene.wall_friction = WallFriction{.mu_w = 0.3, .gap = 20};
  scene.materials[0].cohesion = 2;
  scene.accuracy.splitting.outer = 2;
  scene.accuracy.precision = Precision::full;
  CHECK(contains(on(scene, "physics.rheology.law"), "mu_I_regularised"));
  CHECK(contains(on(scene, "physics.rheology.cap"), "smooth"));
  CHECK(contains(on(scene, "physics.nonlocal"), "A = 0.7"));
  CHECK(contains(on(scene, "physics.dilatancy"), "mode relax"));
  CHECK(contains(on(scene, "physics.wall_friction"), "F = 0.03"));
  CHECK(contains(on(scene, "materials.sand.cohesion"), "2"));
  CHECK(contains(on(scene, "accuracy.splitting"), "2 x 1 viscous solves"));
  CHECK(contains(on(scene, "accuracy.precision"), "full"));
  for (const Switch& s : switches_of(scene).on) CHECK_FALSE(off(scene, s.key));
  CHECK_FALSE(off(scene, "cohesion"));
}

TEST_CASE("plan: what shapes the domain is named with its key, and its geometry among the arrays") {
  Scene scene = small_silo();
  const auto keys = {"domain.symmetry", "domain.coordinates", "air.model", "inserts", "hopper", "feed"};
  for (const char* key : keys) CHECK(off(scene, key));
  CHECK_FALSE(contains(memory_text(Simulation(scene)), "geometry"));
  scene.inserts = {{.shape = Shape::circle, .centre = {15, 18}, .width = 6, .height = 6, .points = {}}};
  const Simulation simulation(scene);
  for (const ArrayGroup& g : arrays_of(simulation)) CHECK_FALSE(g.arrays.empty());
  CHECK(contains(memory_text(simulation), "  geometry  "));
  scene.symmetry = Symmetry::mirror;
  scene.coordinates = Coordinates::axisymmetric;
  scene.air.model = AirModel::none;
  scene.hopper = Hopper{.half_angle = 40};
  scene.feed = Feed{0, 26};
  CHECK(contains(on(scene, "domain.symmetry"), "mirror"));
  CHECK(contains(on(scene, "domain.coordinates"), "axisymmetric"));
  CHECK(contains(on(scene, "air.model"), "none"));
  CHECK(contains(on(scene, "inserts"), "1, by cut_cells"));
  CHECK(contains(on(scene, "hopper"), "40 degrees"));
  CHECK(contains(on(scene, "feed"), "sand replace air below y = 26"));
  for (const char* key : keys) CHECK_FALSE(off(scene, key));
}

TEST_CASE("plan: a material is an inert tracer or differs in named properties") {
  Scene scene = small_silo();
  scene.materials.resize(3);
  scene.materials[1].name = "dye";
  scene.materials[2].name = "fine";
  scene.materials[2].diameter = 0.5;
  scene.materials[2].mu_s = 0.4;
  scene.materials[2].A = 2;  // not used: the scene does not name the module
  CHECK(on(scene, "materials.dye") == "inert tracer: the same properties as sand");
  CHECK(on(scene, "materials.fine") == "a tracer that differs from sand in mu_s, diameter");
  scene.nonlocal = Nonlocal{};
  scene.materials[1].A = 2;
  CHECK(on(scene, "materials.dye") == "a tracer that differs from sand in A");
  CHECK_FALSE(off(scene, "tracers"));
}

TEST_CASE("plan: where mu(I) is well posed, and what helps where it is not") {
  Scene scene = small_silo();
  std::string text = well_posedness_text(scene);
  CHECK(contains(text, "sand: ill-posed at every I"));
  CHECK(contains(text, "physics.rheology.smoothing_length on (0.5)"));
  CHECK(contains(text, "mu_I_regularised has no solution"));
  scene.rheology.smoothing_length = 0;
  CHECK(contains(well_posedness_text(scene), "physics.rheology.smoothing_length off"));

  scene.materials[0] = {.name = "beads", .mu_s = 0.32, .delta_mu = 0.28, .I_0 = 0.4};
  text = well_posedness_text(scene);
  CHECK(contains(text, "beads: well posed for 0.0136 <= I <= 1.81"));
  CHECK(contains(text, "I_1 = 0.0136"));
  scene.rheology.law = Law::mu_I_regularised;
  CHECK(contains(well_posedness_text(scene), "bends it below I_1 = 0.0136"));
  scene.rheology.law = Law::newtonian;
  CHECK(contains(well_posedness_text(scene), "nothing to be ill-posed"));

  scene.rheology.law = Law::mu_I;
  scene.materials[0].delta_mu = 0;  // Coulomb
  CHECK(contains(well_posedness_text(scene), "ill-posed at every I"));
  scene.materials[0].mu_s = 0;
  CHECK(contains(well_posedness_text(scene), "no friction"));
}

TEST_CASE("plan: the table of arrays is what a simulation allocates") {
  Scene scene = small_silo();
  scene.materials.resize(2);
  scene.materials[1].name = "dye";
  for (const bool modules : {false, true}) {
    if (modules) {
      scene.nonlocal = Nonlocal{};
      scene.dilatancy = Dilatancy{};
      scene.wall_friction = WallFriction{.F = 0.0167};
      scene.accuracy.splitting.picard = 2;
    }
    const Simulation simulation(scene);
    std::size_t bytes = 0;
    for (const auto& [name, b] : simulation.memory()) bytes += b;
    const auto groups = arrays_of(simulation);
    CHECK(total_bytes(groups) == bytes);
    for (const ArrayGroup& g : groups) CHECK_FALSE(g.arrays.empty());
    const std::string text = memory_text(simulation);
    CHECK(contains(text, "total"));
    CHECK(contains(text, fmt::format(" {} ", bytes)));
    for (const char* group : {"fluidity  ", "dilatancy  ", "splitting  "})
      CHECK(contains(text, group) == modules);
  }
}

TEST_CASE("plan: steps of a fixed length are counted exactly") {
  Scene scene = small_silo();
  scene.time.dt_max = 0.01;
  for (const double end : {0.5, 0.503}) {
    scene.time.end = end;
    const Summary summary = Simulation(scene).run();
    Trial start = whole(scene);
    start.flow.resize(4);  // the rest is extrapolated
    const StepForecast f = predict_steps(scene, start);
    CHECK(f.steps == summary.steps);
    CHECK(f.t == end);
    CHECK(f.ends == "time.end");
    CHECK(f.sure);
  }
  scene.time.max_steps = 7;
  const StepForecast f = predict_steps(scene, whole(scene));
  CHECK(f.steps == 7);
  CHECK(f.ends == "time.max_steps");
}

TEST_CASE("plan: with the flow of the run itself the steps are those of the run") {
  Scene scene = small_silo();
  scene.time.dt_max = 1;  // the speed rules
  scene.time.end = 0;
  scene.stop.mass_below = 0.9;
  const Summary summary = Simulation(scene).run();
  REQUIRE(summary.status == Status::stopped);
  Scene longer = scene;  // a trial does not know of stops
  longer.time.max_steps = summary.steps + 5;
  const StepForecast f = predict_steps(scene, whole(longer));
  CHECK(f.steps == summary.steps);
  CHECK(f.limit != "dt_max");
  CHECK(f.ends == "stop.mass_below");
}

TEST_CASE("plan: a run that nothing seen will end is said to be one") {
  Scene scene = small_silo();
  scene.time.end = 0;
  scene.stop.mass_below = 0.5;
  Trial still{scene.patch(), {{0, {}, 100}, {500, {}, 100}}, {1}};  // no grain left, long after the start
  const StepForecast f = predict_steps(scene, still);
  CHECK(f.ends.empty());
  CHECK_FALSE(f.sure);
}

TEST_CASE("plan: the copy is halved while the scene stays sound and its orifices resolved") {
  Scene scene = small_silo();
  scene.cells_x = 64;  // the orifice 32 cells wide
  CHECK(coarsened(scene, 64 * 64).cells_x == 64);
  CHECK(coarsened(scene, 1000).cells_x == 16);
  CHECK(coarsened(scene, 1).cells_x == 16);     // 8 cells
  scene.orifices[0].width = 30 * 9 / 64.0 * 2;  // 18 cells; of 9 the ends are within cells
  CHECK(coarsened(scene, 1).cells_x == 32);
}
