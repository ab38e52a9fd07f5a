// Scenes of models in closed form: defaults, fields on the grid, half domains, and what check() refuses.
#include "solver/steady_flow.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/diagnostics.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Scene scene_of(Model model, int cells = 32) {
  Scene s = silo(cells);
  s.model = model;
  s.output = Output{};
  if (model != Model::radial) return s;
  s.radial.emplace();
  s.radial->phi = 30;
  s.radial->phi_w = 15;
  s.radial->half_angle = 15;
  return s;
}

bool refused(const Scene& s, const std::string& path, const std::string& words = "") {
  const auto problems = check(s);
  return std::ranges::any_of(problems, [&](const Problem& p) {
    return p.fatal && p.path == path && p.message.find(words) != std::string::npos;
  });
}

bool warned(const Scene& s, const std::string& path, const std::string& words) {
  const auto problems = check(s);
  return std::ranges::any_of(problems, [&](const Problem& p) {
    return !p.fatal && p.path == path && p.message.find(words) != std::string::npos;
  });
}

}  // namespace

TEST_CASE("what a model leaves open follows from grains, orifices and gravity") {
  Scene s = silo(32);
  s.materials[0].diameter = 0.5;
  s.materials[0].density = 3;
  s.gravity = {0, -4};
  s.materials[0].mu_s = 0.5;
  const double Q = 3 * 2 * std::pow(18.75, 1.5);
  for (const Model model : {Model::mu_I, Model::kinematic, Model::stochastic, Model::radial}) {
    Scene one = s;
    one.model = model;
    resolve_model(one);
    CHECK(one.kinematic.has_value() == (model == Model::kinematic));
    CHECK(one.stochastic.has_value() == (model == Model::stochastic));
    CHECK(one.radial.has_value() == (model == Model::radial));
    if (one.kinematic) {
      CHECK(*one.kinematic->B == 1);
      CHECK(*one.kinematic->Q == Approx(Q).epsilon(1e-14));
    } else if (one.stochastic) {
      CHECK(*one.stochastic->L_s == 2);
    } else if (one.radial) {
      CHECK(*one.radial->phi == Approx(30).epsilon(1e-14));
      CHECK(*one.radial->phi_w == Approx(15).epsilon(1e-14));
      CHECK(*one.radial->half_angle == Approx(60).epsilon(1e-14));
    }
  }
}

TEST_CASE("each model gives one field, its discharge, and no step") {
  for (const Model model : {Model::kinematic, Model::stochastic, Model::radial}) {
    const Scene s = scene_of(model);
    INFO(model_names[static_cast<int>(model)]);
    const auto problems = check(s);
    CHECK(std::ranges::none_of(problems, [](const Problem& p) { return p.fatal; }));
    const SteadyFlow flow = steady_flow(s);
    const SteadyModel exact(s);
    const Patch patch = s.patch();
    const PointVelocity w = exact.velocity(patch.x_centre(17), patch.y_centre(9));
    CHECK(flow.velocity_x(17, 9) == w.u);
    CHECK(flow.velocity_y(17, 9) == w.v);
    CHECK(flow.derived("speed")(17, 9) == std::hypot(w.u, w.v));
    CHECK(flow.velocity_y(17, 31) == 0);  // above the fill
    CHECK(flow.row.mass == Approx(150.0 * 135).epsilon(1e-12));
    CHECK(flow.summary.status == Status::finished);
    CHECK(flow.summary.steps == 0);
    CHECK(flow.summary.discharge_rate == Approx(discharge_scale(s, 18.75)).epsilon(1e-14));
    CHECK(flow.summary.discharge_constant == Approx(1).epsilon(1e-14));
    CHECK(flow.pressure.allocated() == (model == Model::radial));
    CHECK_THROWS_AS(flow.derived("viscosity"), std::invalid_argument);
    CHECK_THROWS_AS(Simulation(s), std::invalid_argument);
  }
  CHECK_THROWS_AS(SteadyModel(silo(32)), std::invalid_argument);
}

TEST_CASE("the radial field lets out its discharge through every arc, in a wedge and in a cone") {
  for (const bool cone : {false, true}) {
    Scene s = scene_of(Model::radial);
    if (cone) {
      s.coordinates = Coordinates::axisymmetric;
      s.width = 75;
      s.orifices[0].centre = 0;
    }
    s.radial->Q = 40;
    const SteadyModel model(s);
    const double apex = -0.5 * 18.75 / std::tan(15 * M_PI / 180), x0 = s.orifices[0].centre;
    for (const double r : {40.0, 90.0}) {
      double sum = 0;
      const int n = 4000;
      for (int k = 0; k < n; ++k) {  // middle rule
        const double theta = (k + 0.5) / n * 15 * M_PI / 180, d = 15 * M_PI / 180 / n;
        const auto [u, v] = model.velocity(x0 + r * std::sin(theta), apex + r * std::cos(theta));
        CHECK(std::abs(u * std::cos(theta) - v * std::sin(theta)) < 1e-12);  // radial
        sum += std::hypot(u, v) * r * d * (cone ? 2 * M_PI * r * std::sin(theta) : 2);
      }
      CHECK(sum == Approx(40).epsilon(1e-6));
    }
    CHECK(model.velocity(x0 + 30, 20).v == 0);  // outside of it
    CHECK(model.pressure(x0, 20) > model.pressure(x0, 10));
  }
}

TEST_CASE("half a silo has the field of the whole one") {
  for (const Model model : {Model::kinematic, Model::stochastic, Model::radial})
    for (const OrificeForm form : {OrificeForm::slot, OrificeForm::point}) {
      Scene whole = scene_of(model);
      if (model == Model::kinematic) whole.kinematic.emplace().orifices = form;
      if (model == Model::stochastic) whole.stochastic.emplace().orifices = form;
      if (model != Model::radial)
        whole.orifices = {{Side::bottom, 75, 12}, {Side::bottom, 30, 6}, {Side::bottom, 120, 6}};
      Scene half = whole;
      half.symmetry = Symmetry::mirror;
      half.width = 75;
      half.cells_x = 16;
      half.walls[0] = Wall::free_slip;
      half.fill = {fill_box(0, 0, 75, 0, 135)};
      half.orifices = {{Side::bottom, 0, model == Model::radial ? 18.75 : 12}};
      if (model != Model::radial) half.orifices.push_back({Side::bottom, 45, 6});
      const SteadyFlow a = steady_flow(whole), b = steady_flow(half);
      CHECK(b.summary.discharge_rate == Approx(a.summary.discharge_rate).epsilon(1e-13));
      CHECK(b.row.mass == Approx(a.row.mass).epsilon(1e-13));
      double worst = 0;
      for (int j = 0; j < 32; ++j)
        for (int i = 0; i < 16; ++i) {
          worst = std::max(worst, std::abs(a.velocity_x(16 + i, j) - b.velocity_x(i, j)));
          worst = std::max(worst, std::abs(a.velocity_y(16 + i, j) - b.velocity_y(i, j)));
        }
      CHECK(worst < 1e-11);
    }
}

TEST_CASE("orifices share the discharge by W^1.5") {
  Scene s = scene_of(Model::kinematic);
  s.orifices = {{Side::bottom, 40, 10}, {Side::bottom, 110, 20}};
  const Floor floor = floor_of(s, 7, OrificeForm::slot);
  CHECK(floor.sources[0].rate + floor.sources[1].rate == Approx(7).epsilon(1e-14));
  CHECK(floor.sources[1].rate / floor.sources[0].rate == Approx(std::pow(2, 1.5)).epsilon(1e-14));
  const SteadyFlow flow = steady_flow(s);
  CHECK(flow.row.orifice_outflow[0] + flow.row.orifice_outflow[1] == Approx(flow.row.outflow).epsilon(1e-14));
}

TEST_CASE("what a model cannot honour is refused, what it does not use is said") {
  for (const Model model : {Model::kinematic, Model::stochastic}) {
    const Scene sound = scene_of(model);
    Scene s = sound;
    s.inserts.push_back({Shape::circle, {75, 60}, 10, 10, {}});
    CHECK(refused(s, "inserts", "cannot have solids"));
    s = sound;
    s.hopper.emplace();
    CHECK(refused(s, "hopper"));
    s = sound;
    s.coordinates = Coordinates::axisymmetric;
    CHECK(refused(s, "domain.coordinates"));
    s = sound;
    s.materials.push_back(Material{});
    s.materials[1].name = "other";
    CHECK(refused(s, "materials", "2 materials"));
    s = sound;
    s.nonlocal.emplace();
    s.dilatancy.emplace();
    s.wall_friction.emplace().F = 0.1;
    s.feed = Feed{0, 135};
    for (const char* path : {"physics.nonlocal", "physics.dilatancy", "physics.wall_friction", "feed"})
      CHECK(refused(s, path));
    s = sound;
    s.orifices[0].wall = Side::left;
    CHECK(refused(s, "orifices.0.wall"));
    s = sound;
    s.orifices.clear();
    CHECK(refused(s, "orifices", "needs an orifice"));
    s = sound;
    s.gravity = {0.1, -1};
    CHECK(refused(s, "gravity"));
  }
  Scene s = scene_of(Model::kinematic);
  s.kinematic.emplace().B = -1;
  CHECK(refused(s, "kinematic.B", "> 0"));
  s.kinematic = Kinematic{2, 0, OrificeForm::slot};
  CHECK(refused(s, "kinematic.Q"));
  s = scene_of(Model::stochastic);
  s.stochastic.emplace().spot = -1;
  CHECK(refused(s, "stochastic.spot"));

  s = scene_of(Model::radial);
  s.orifices.push_back({Side::bottom, 110, 8});
  CHECK(refused(s, "orifices", "one apex"));
  s = scene_of(Model::radial);
  s.radial->phi_w = 31;
  CHECK(refused(s, "radial.phi_w", "at most phi"));
  s.radial->phi_w = 15;
  s.radial->half_angle = 62;
  s.coordinates = Coordinates::axisymmetric;
  s.orifices[0].centre = 0;
  CHECK(refused(s, "radial.half_angle", "beyond the mass-flow limit, 38.0 degrees"));

  s = scene_of(Model::radial);
  s.hopper.emplace();
  s.hopper->half_angle = 15;  // up to y = 245
  CHECK_FALSE(warned(s, "fill", "hopper's walls end"));
  s.hopper->half_angle = *(s.radial->half_angle = 45);
  CHECK(warned(s, "fill", "grains reach y = 135, but the hopper's walls end at 65.625"));
  s.fill = {fill_box(0, 0, 150, 0, 65)};
  CHECK_FALSE(warned(s, "fill", "hopper's walls end"));

  s = scene_of(Model::kinematic);
  CHECK(check(s).empty());
  s.time.end = 10;
  s.stop.mass_below = 0.3;
  s.rheology.cap = Cap::smooth;
  CHECK(warned(s, "model", "does not use physics.rheology, time, stop"));
  s.output.fields = {"speed", "viscosity"};
  CHECK(warned(s, "output.fields.1", "has no viscosity"));
  s = silo(32, 1);
  s.kinematic.emplace();
  CHECK(warned(s, "kinematic", "is not used"));
}

TEST_CASE("a grid that no multigrid could halve is fine for a field in closed form") {
  Scene s = scene_of(Model::kinematic, 75);
  CHECK(check(s).empty());
  s.model = Model::mu_I;
  s.time.end = 1;
  CHECK(refused(s, "grid.cells_x"));
}
