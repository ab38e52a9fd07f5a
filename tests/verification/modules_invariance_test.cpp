// Every module, law and splitting in a silo: threads change nothing, a mirrored silo flows mirrored.
#include <catch2/catch.hpp>
#include <functional>

#include "tests/support/asymmetry.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;

namespace {

struct Variant {
  const char* name;
  std::function<void(Scene&)> set;
};
const std::vector<Variant>& variants() {
  static const std::vector<Variant> list{
      {"nonlocal thesis", [](Scene& s) { s.nonlocal = Nonlocal{}; }},
      {"nonlocal kamrin",
       [](Scene& s) { s.nonlocal = Nonlocal{.closure = Closure::kamrin, .walls = FluidityWall::no_flux}; }},
      {"dilatancy source", [](Scene& s) { s.dilatancy = Dilatancy{}; }},
      {"dilatancy relax", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::relax}; }},
      {"dilatancy weight", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::weight}; }},
      {"friction implicit", [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167}; }},
      {"friction limiter",
       [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167, .mode = FrictionMode::limiter}; }},
      {"regularised", [](Scene& s) { s.rheology.law = Law::mu_I_regularised; }},
      {"cohesion, smooth cap",
       [](Scene& s) {
         for (Material& m : s.materials) m.cohesion = 0.5;
         s.rheology.cap = Cap::smooth;
       }},
      {"splitting", [](Scene& s) { s.accuracy.splitting = {.outer = 2, .picard = 2, .rotational = 0.5}; }},
      {"all",
       [](Scene& s) {
         s.nonlocal = Nonlocal{};
         s.dilatancy = Dilatancy{};
         s.wall_friction = WallFriction{.F = 0.0167};
         s.rheology.law = Law::mu_I_regularised;
         s.materials[0].cohesion = 0.2;
         s.accuracy.splitting.outer = 2;
       }},
  };
  return list;
}

/// Well-posed grains, so that the regularised law has a solution and noise does not grow.
Scene grains_in_silo(int cells) {
  Scene s = silo(cells);
  s.materials = {well_posed_grains()};
  return s;
}

int run(Simulation& simulation, int steps) {
  int missed = 0;
  for (int n = 0; n < steps; ++n) {
    const StepReport r = simulation.step();
    missed +=
        !r.viscous.converged + !r.pressure.converged + !(r.fluidity.converged || r.fluidity.iterations == 0);
  }
  return missed;
}

}  // namespace

TEST_CASE("modules: one thread and two give the same bits", "[slow]") {
  for (const Variant& variant : variants()) {
    Scene scene = grains_in_silo(64);
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].name = "layer";
    scene.materials[1].mu_s = 0.36;
    scene.materials[1].density = 1.5;
    scene.fill.push_back(fill_box(1, 0, 150, 30, 60));
    variant.set(scene);
    Simulation alone(scene);
    CHECK(run(alone, 12) == 0);
    INFO(variant.name);
    scene.threads = 2;
    Simulation team(scene);
    CHECK(run(team, 12) == 0);
    const Fields &a = alone.fields(), &b = team.fields();
    CHECK(same_bits(a.u, b.u));
    CHECK(same_bits(a.v, b.v));
    CHECK(same_bits(a.p, b.p));
    CHECK(same_bits(a.grains, b.grains));
    if (scene.nonlocal) CHECK(same_bits(a.fluidity, b.fluidity));
    for (std::size_t k = 0; k < a.solid.size(); ++k) CHECK(same_bits(a.solid[k], b.solid[k]));
    CHECK(team.orifice_mass() == alone.orifice_mass());
  }
}

// Closure kamrin loses this later: where xi is not resolved what rounding differs by grows from step to step, whatever the
// step, and after 120 steps it stands at 1e-3 of the velocity, from where it does not grow.
TEST_CASE("modules: a mirrored orifice gives the mirrored flow") {
  const double h = 150.0 / 64;
  for (const Variant& variant : variants()) {
    Scene scene = grains_in_silo(64);
    scene.orifices = {{Side::bottom, 20.5 * h, 9 * h}};
    variant.set(scene);
    Scene image = scene;
    image.orifices[0].centre = scene.width - scene.orifices[0].centre;
    Simulation a(scene), b(image);
    INFO(variant.name);
    CHECK(run(a, 80) == 0);
    CHECK(run(b, 80) == 0);
    const double difference = asymmetry(a.fields(), b.fields());
    figure("mirror, %s: %.1e in the grains after 80 steps", variant.name, difference);
    CHECK(difference < 1e-4);
    CHECK(a.orifice_mass()[0] == Approx(b.orifice_mass()[0]).epsilon(1e-5));
  }
}

TEST_CASE(
    "modules: wall friction of no strength, cohesion of none and a splitting of one round are the plain "
    "run") {
  const Scene plain = grains_in_silo(64);
  Simulation without(plain);
  run(without, 100);
  for (const Variant& variant :
       {Variant{"friction implicit", [](Scene& s) { s.wall_friction = WallFriction{.F = 0}; }},
        Variant{"friction limiter",
                [](Scene& s) { s.wall_friction = WallFriction{.F = 0, .mode = FrictionMode::limiter}; }},
        // Through the row of every law, with the same numbers.
        Variant{"layer of the same grains", [](Scene& s) {
                  s.materials.push_back(s.materials[0]);
                  s.materials[1].name = "layer";
                  s.fill.push_back(fill_box(1, 0, 150, 30, 60));
                  s.materials[1].cohesion = 1e-300;
                }}}) {
    Scene scene = plain;
    variant.set(scene);
    Simulation with(scene);
    run(with, 100);
    double worst = 0;
    for (int j = 0; j <= 64; ++j)
      for (int i = 0; i < 64; ++i)
        worst = std::max(worst, std::abs(with.fields().v(i, j) - without.fields().v(i, j)));
    figure("%s against the plain run: velocity off by %.1e", variant.name, worst);
    CHECK(worst < 1e-6);
  }
}
