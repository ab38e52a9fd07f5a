#include "solver/scene.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// The problem that a change to a sound scene makes; it must be the only one.
Problem only_problem(const std::function<void(Scene&)>& change) {
  Scene s = sound_scene();
  change(s);
  const std::vector<Problem> problems = check(s);
  for (const Problem& p : problems) UNSCOPED_INFO(p.path << ": " << p.message);
  REQUIRE(problems.size() == 1);
  return problems[0];
}

void expect(const Problem& p, bool fatal, const std::string& path, const std::vector<std::string>& parts) {
  CHECK(p.fatal == fatal);
  CHECK(p.path == path);
  for (const std::string& part : parts) CHECK_THAT(p.message, Catch::Contains(part));
}

constexpr bool error = true, warning = false;

}  // namespace

TEST_CASE("a sound scene has no problems, and its patch has square cells") {
  CHECK(check(sound_scene()).empty());
  Scene s = sound_scene();
  s.height = 75;
  CHECK(s.patch() == Patch{128, 64, 150.0 / 128, 0, 0});
}

TEST_CASE("well-posed ranges of I agree with published parameter sets") {
  const auto range = [](double mu_s, double delta_mu, double I_0) {
    return well_posed_range({.mu_s = mu_s, .delta_mu = delta_mu, .I_0 = I_0});
  };
  // low friction; Lagree et al. 2011; Jop et al. 2006; glass beads of Barker & Gray 2017
  const double sets[4][5] = {{0.47, 0.38, 0.6, 0.0623, 1.00},
                             {0.32, 0.28, 0.4, 0.0136, 1.81},
                             {0.382, 0.261, 0.279, 0.0194, 0.852},
                             {0.342, 0.215, 0.069, 0.00397, 0.280}};
  for (const auto& set : sets) {
    const auto found = range(set[0], set[1], set[2]);
    REQUIRE(found);
    CHECK((*found)[0] == Approx(set[3]).epsilon(5e-3));
    CHECK((*found)[1] == Approx(set[4]).epsilon(5e-3));
  }
  CHECK_FALSE(range(0.62, 0.48, 0.6));
  CHECK_FALSE(range(0.77, 0.58, 0.6));
  CHECK_FALSE(range(0.32, 0, 0.4));
}

TEST_CASE("scales of dimensional defaults") {
  Scene s = sound_scene();
  s.materials[0].diameter = 1e-3;
  s.materials[0].density = 1500;
  s.gravity = {0, -10};
  const Scales scale = scales(s);
  CHECK(scale.length == 1e-3);
  CHECK(scale.time == Approx(1e-2));
  CHECK(scale.density == 1500);
  CHECK(scale.viscosity == Approx(1500 * std::sqrt(10 * 1e-9)));
}

TEST_CASE("ranges of single values") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  struct Case {
    std::string path;
    std::function<void(Scene&)> change;
    std::string part;
  };
  const std::vector<Case> cases{
      {"domain.width", [](Scene& s) { s.width = 0; }, "0 is out of range (must be > 0)"},
      {"domain.height", [](Scene& s) { s.height = -150; }, "-150 is out of range (must be > 0)"},
      {"domain.width", [=](Scene& s) { s.width = nan; }, "must be > 0"},
      {"domain.height", [=](Scene& s) { s.height = inf; }, "must be > 0"},
      {"grid.cells_x", [](Scene& s) { s.cells_x = 0; }, "must be >= 2"},
      {"gravity", [=](Scene& s) { s.gravity[0] = nan; }, "not finite"},
      {"materials.beads.mu_s", [](Scene& s) { s.materials[0].mu_s = -0.1; },
       "-0.1 is out of range (must be >= 0)"},
      {"materials.beads.delta_mu", [](Scene& s) { s.materials[0].delta_mu = -0.1; }, "must be >= 0"},
      {"materials.beads.I_0", [](Scene& s) { s.materials[0].I_0 = 0; }, "Glass beads have about 0.28"},
      {"materials.beads.diameter", [](Scene& s) { s.materials[0].diameter = 0; }, "must be > 0"},
      {"materials.beads.density", [](Scene& s) { s.materials[0].density = -1; }, "must be > 0"},
      {"materials.beads.viscosity", [](Scene& s) { s.rheology.law = Law::newtonian; }, "must be > 0"},
      {"air.density", [](Scene& s) { s.air.density = 0; }, "must be > 0"},
      {"air.viscosity", [](Scene& s) { s.air.viscosity = 0; }, "must be > 0"},
      {"physics.rheology.eta_min", [](Scene& s) { s.rheology.eta_min = 0; }, "must be > 0"},
      {"physics.rheology.eta_max", [](Scene& s) { s.rheology.eta_max = 1; }, "not above eta_min"},
      {"physics.rheology.eta_max", [=](Scene& s) { s.rheology.eta_max = nan; }, "not finite"},
      {"physics.rheology.smoothing_length", [](Scene& s) { s.rheology.smoothing_length = -1; },
       "must be >= 0"},
      {"physics.rheology.background_pressure", [](Scene& s) { s.rheology.background_pressure = -1; },
       "must be >= 0"},
      {"time.end", [](Scene& s) { s.time.end = -1; }, "must be >= 0"},
      {"time.cfl", [](Scene& s) { s.time.cfl = 0.51; }, "above 0, at most 0.5"},
      {"time.cfl", [](Scene& s) { s.time.cfl = 0; }, "above 0, at most 0.5"},
      {"time.dt_max", [](Scene& s) { s.time.dt_max = 0; }, "must be > 0"},
      {"time.max_steps", [](Scene& s) { s.time.max_steps = -1; }, "must be >= 0"},
      {"stop.mass_below", [](Scene& s) { s.stop.mass_below = 1; }, "above 0, below 1"},
      {"stop.steady_discharge", [](Scene& s) { s.stop.steady_discharge = 0; }, "above 0, below 1"},
      {"accuracy.viscous_tolerance", [](Scene& s) { s.accuracy.viscous_tolerance = 1; }, "above 0, below 1"},
      {"accuracy.pressure_tolerance", [](Scene& s) { s.accuracy.pressure_tolerance = 0; },
       "above 0, below 1"},
      {"accuracy.max_iterations", [](Scene& s) { s.accuracy.max_iterations = 0; }, "must be >= 1"},
      {"output.series_every", [](Scene& s) { s.output.series_every = 0; }, "must be > 0"},
      {"output.fields_every", [](Scene& s) { s.output.fields_every = -1; }, "must be >= 0"},
      {"output.snapshots_every", [](Scene& s) { s.output.snapshots_every = -1; }, "must be >= 0"},
      {"output.compression", [](Scene& s) { s.output.compression = 10; }, "0 to 9"},
      {"output.fields.0", [](Scene& s) { s.output.fields = {"sped"}; }, "no field 'sped' (allowed: speed"},
      {"physics.nonlocal.A", [](Scene& s) { s.nonlocal = Nonlocal{-1}; }, "must be >= 0"},
      {"physics.dilatancy.K", [](Scene& s) { s.dilatancy = Dilatancy{.K = 0}; }, "must be > 0"},
      {"physics.dilatancy.phi_max", [](Scene& s) { s.dilatancy = Dilatancy{.phi_max = 1.1}; }, "at most 1"},
      {"physics.wall_friction", [](Scene& s) { s.wall_friction = WallFriction{}; }, "given once"},
      {"physics.wall_friction.F", [](Scene& s) { s.wall_friction = WallFriction{.F = -1}; }, "must be >= 0"},
      {"materials.beads.cohesion", [](Scene& s) { s.materials[0].cohesion = -1; }, "must be >= 0"},
      {"materials.beads",
       [](Scene& s) {
         s.rheology.law = Law::mu_I_regularised;
         s.materials[0].mu_s = 0.62;
       },
       "has no solution"},
      {"accuracy.splitting.outer", [](Scene& s) { s.accuracy.splitting.outer = 0; }, "1 to 100"},
      {"accuracy.splitting.rotational", [](Scene& s) { s.accuracy.splitting.rotational = 2; }, "below 2"},
      {"accuracy.fluidity_tolerance", [](Scene& s) { s.accuracy.fluidity_tolerance = 0; },
       "above 0, below 1"},
      {"threads", [](Scene& s) { s.threads = -1; }, "0 to 1024"},
      {"name", [](Scene& s) { s.name = "../x"; }, "cannot name a run folder"},
      {"materials.9b", [](Scene& s) { s.materials[0].name = "9b"; }, "cannot name a material"},
      {"materials.beads", [](Scene& s) { s.materials.push_back(s.materials[0]); }, "two materials"},
      {"orifices.0.width", [](Scene& s) { s.orifices[0].width = 0; }, "must be > 0"},
      {"orifices.0.centre", [=](Scene& s) { s.orifices[0].centre = nan; }, "not finite"},
  };
  for (const Case& c : cases) {
    INFO(c.path);
    expect(only_problem(c.change), error, c.path, {c.part});
  }
}

TEST_CASE("the grid: whole height, multigrid, memory; the cures work") {
  expect(only_problem([](Scene& s) { s.height = 150.5; }), error, "domain.height",
         {"128.427 cells", "come out whole", "height 150 ", "height 159.375"});
  expect(only_problem([](Scene& s) { s.cells_x = 150; }), error, "grid.cells_x",
         {"150 x 150 cells can be halved only to 75 x 75", "cells_x 144", "cells_x 152"});
  expect(only_problem([](Scene& s) { s.cells_x = 1 << 20; }), error, "grid.cells_x",
         {"600 bytes a cell", "this machine has", "Use cells_x <= "});
  for (const int cells_x : {144, 152}) {
    Scene s = sound_scene();
    s.cells_x = cells_x;
    CHECK(check(s).empty());
  }
  Scene s = sound_scene();
  s.height = 159.375;
  CHECK(check(s).empty());
}

TEST_CASE("orifices: inside the wall, wide enough, apart; the cures work") {
  const auto orifice = [](double centre, double width, Side wall = Side::bottom) {
    return [=](Scene& s) { s.orifices[0] = {wall, centre, width}; };
  };
  expect(only_problem(orifice(145, 18.75)), error, "orifices.0.centre",
         {"from 135.625 to 154.375", "the bottom wall (0 to 150)", "9.375 to 140.625"});
  expect(only_problem(orifice(75, 300)), error, "orifices.0.centre",
         {"wider (300) than the bottom wall (150)"});
  expect(only_problem(orifice(75, 1.5)), error, "orifices.0.width",
         {"the neck is 1.28 cells wide (must be at least 2; use >= 8: cells_x >= 800)"});
  expect(only_problem(orifice(75, 4 * 150. / 128)), warning, "orifices.0.width",
         {"neck is 4 cells wide; use >= 8 (cells_x >= 256)"});
  expect(only_problem(orifice(75, 18.75, Side::top)), error, "orifices.0.wall", {"top wall is open"});
  expect(only_problem([](Scene& s) {
           s.orifices.push_back({Side::bottom, 84.375, 18.75});
         }),
         error, "orifices.1.centre", {"overlaps orifice 0 by 9.375"});
  Scene s = sound_scene();
  s.orifices.push_back({Side::bottom, 93.75, 18.75});  // touches
  s.orifices.push_back({Side::left, 75, 18.75});
  CHECK(check(s).empty());
  s.orifices[0].centre = 74.7;  // off the cell edges is as good
  CHECK(check(s).empty());
}

TEST_CASE("walls: periodic sides come in a pair, left and right") {
  expect(only_problem([](Scene& s) { s.walls[0] = Wall::periodic; }), error, "walls.right",
         {"no_slip", "Make both periodic"});
  expect(only_problem([](Scene& s) { s.walls[3] = Wall::periodic; }), error, "walls.top",
         {"Only left and right can be periodic"});
  Scene s = sound_scene();
  s.walls[0] = s.walls[1] = Wall::periodic;
  CHECK(check(s).empty());
}

TEST_CASE("fills: at least one with grains inside the domain, convex") {
  expect(only_problem([](Scene& s) { s.fill.clear(); }), error, "fill", {"there is no fill", "box"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({-1, s.fill[0].points});
         }),
         error, "fill", {"no grains", "air does not paint over"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({0, {{200, 0}, {250, 0}, {250, 9}}});
         }),
         warning, "fill.1", {"outside the domain", "paints nothing"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({0, {{0, 0}, {9, 0}, {5, 1}, {5, 9}}});
         }),
         error, "fill.1", {"not convex"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({0, {{0, 0}, {9, 0}, {18, 0}}});
         }),
         error, "fill.1", {"no area"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({0, {{0, 0}, {9, 0}}});
         }),
         error, "fill.1", {"2 corners"});
  expect(only_problem([](Scene& s) {
           s.fill.push_back({1, s.fill[0].points});
         }),
         error, "fill.1.material", {"no material 1"});
  std::vector<std::array<double, 2>> pentagram;
  for (int k = 0; k < 5; ++k)
    pentagram.push_back({75 + 9 * std::cos(k * 0.8 * M_PI), 75 + 9 * std::sin(k * 0.8 * M_PI)});
  expect(only_problem([&](Scene& s) { s.fill.push_back({0, pentagram}); }), error, "fill.1", {"not convex"});
  Scene s = sound_scene();
  std::reverse(s.fill[0].points.begin(), s.fill[0].points.end());  // clockwise is as good
  CHECK(check(s).empty());
}

TEST_CASE("no material, and nothing that ends the run") {
  expect(only_problem([](Scene& s) {
           s.materials.clear();
           s.fill[0].material = -1;
         }),
         error, "materials", {"no material (at least one)"});
  expect(only_problem([](Scene& s) { s.time.end = 0; }), error, "time",
         {"nothing ends this run", "stop.mass_below"});
  for (const auto& end : std::vector<std::function<void(Scene&)>>{
           [](Scene& s) { s.time.max_steps = 1; }, [](Scene& s) { s.stop.mass_below = 0.5; },
           [](Scene& s) { s.stop.steady_discharge = 0.1; }}) {
    Scene s = sound_scene();
    s.time.end = 0;
    end(s);
    CHECK(check(s).empty());
  }
  Scene closed = sound_scene();  // grains cannot leave, so their mass stops nothing
  closed.orifices.clear();
  CHECK(check(closed).empty());
  closed.stop.mass_below = 0.5;
  REQUIRE(check(closed).size() == 1);
  expect(check(closed)[0], warning, "stop.mass_below", {"never comes true"});
  closed.time.end = 0;
  CHECK(check(closed).back().path == "time");
}

TEST_CASE("warnings on the rheology") {
  const auto medium = [](Scene& s) {
    s.materials[0].mu_s = 0.62, s.materials[0].delta_mu = 0.48, s.materials[0].I_0 = 0.6;
  };
  expect(only_problem(medium), warning, "materials.beads",
         {"ill-posed at every I", "smoothing_length = 0.5 is what keeps the run independent of the step"});
  expect(only_problem([&](Scene& s) {
           medium(s);
           s.rheology.smoothing_length = 0;
         }),
         warning, "materials.beads", {"nothing holds them"});
  Scene coulomb = sound_scene();
  coulomb.materials[0].delta_mu = 0;
  const std::vector<Problem> problems = check(coulomb);
  REQUIRE(problems.size() == 2);
  expect(problems[0], warning, "materials.beads.delta_mu", {"Coulomb"});
  expect(problems[1], warning, "materials.beads", {"ill-posed"});
}

TEST_CASE("several problems are all reported") {
  Scene s = sound_scene();
  s.time.cfl = 2;
  s.materials[0].mu_s = -1;
  s.orifices[0].width = 1.5;
  s.air.viscosity = 0;
  CHECK(check(s).size() == 4);
}
