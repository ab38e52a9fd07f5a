// Findings of the silo thesis at 128^2, and the comparison with an independent solver; where hourglass differs, how.
#include <catch2/catch.hpp>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

double rate_of(Scene scene) {
  scene.threads = 2;
  const Summary s = Simulation(scene).run();
  CHECK(s.status == Status::finished);
  CHECK(s.missed_tolerances == 0);
  figure("  rate %.4f in %ld steps, %.1f s", s.discharge_rate / code_unit, s.steps, s.wall_seconds);
  return s.discharge_rate / code_unit;
}

}  // namespace

TEST_CASE("nonlocality, dilatancy and strong wall friction lower the discharge, low friction raises it",
          "[slow]") {
  const Scene base = silo(128, 27.386);
  const double plain = rate_of(base);
  const auto with = [&](auto&& change) {
    Scene scene = base;
    change(scene);
    return rate_of(scene) / plain;
  };
  const double nonlocal = with([](Scene& s) { s.nonlocal = Nonlocal{}; });
  const double no_flux = with([](Scene& s) { s.nonlocal = Nonlocal{.walls = FluidityWall::no_flux}; });
  const double dilatant = with([](Scene& s) { s.dilatancy = Dilatancy{}; });
  const double weight = with([](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::weight}; });
  const double weak_friction = with([](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167}; });
  const double friction = with([](Scene& s) { s.wall_friction = WallFriction{.F = 0.05}; });
  const double low = with([](Scene& s) {
    s.materials[0].mu_s = 0.47;
    s.materials[0].delta_mu = 0.38;
  });
  figure(
      "rate over %.4f: nonlocal %.3f (no flux %.3f), dilatancy %.3f (weight %.3f), F = 0.0167 %.3f, 0.05 "
      "%.3f, low %.3f",
      plain, nonlocal, no_flux, dilatant, weight, weak_friction, friction, low);
  CHECK(nonlocal == Approx(0.955).margin(0.015));
  CHECK(no_flux == Approx(0.875).margin(0.02));
  CHECK(no_flux < nonlocal);
  CHECK(dilatant == Approx(0.807).margin(0.02));
  CHECK(weight ==
        Approx(0.958).margin(0.015));  // the thesis's model: nonlocality lowers the rate more than that
  CHECK(nonlocal < weight + 0.005);
  CHECK(weak_friction == Approx(1.025).margin(0.01));  // it carries weight: docs/physics.md
  CHECK(friction < 0.85);
  CHECK(low > 1.03);
}

TEST_CASE("a tracer above half of the height breaks through when a fifth has drained", "[slow]") {
  Scene scene = silo(128, 60);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "tracer";
  scene.fill.push_back(fill_box(1, 0, scene.width, 75, 135));
  scene.threads = 2;
  Simulation s(scene);
  const double all = s.grain_mass(), coloured = s.material_mass()[1];
  double drained = 0, tracer_out = 0;
  while (s.t() < scene.time.end && tracer_out < 1e-4 * coloured) {
    s.step();
    drained = s.orifice_mass()[0] / all;
    tracer_out = coloured - s.material_mass()[1];
  }
  figure("tracer breaks through at t = %.1f when %.1f %% have drained", s.t(), 100 * drained);
  CHECK(drained > 0.15);
  CHECK(drained < 0.22);
}

TEST_CASE("nonlocal over base discharge beside an independent solver", "[slow]") {
  // Basilisk (collocated, arithmetic face means) at 128^2: 0.4120 / 0.5502 = 0.749 for the closure `thesis` with g = 0 on
  // walls. hourglass comes no nearer than 0.87 with arithmetic corner means, and with grids tends to 0.95: the difference
  // is the reference's grid (docs/physics.md, Nonlocal fluidity).
  const auto ratio = [](CornerMean mean, FluidityWall walls, int cells) {
    Scene scene = silo(cells, 21.9);
    scene.rheology.corner_mean = mean;
    const double base = rate_of(scene);
    scene.nonlocal = Nonlocal{.walls = walls};
    return rate_of(scene) / base;
  };
  const double arithmetic = ratio(CornerMean::arithmetic, FluidityWall::zero, 128),
               harmonic = ratio(CornerMean::harmonic, FluidityWall::zero, 128),
               coarse = ratio(CornerMean::arithmetic, FluidityWall::zero, 64);
  figure("nonlocal over base: harmonic 128^2 %.3f; arithmetic 64^2, 128^2: %.3f %.3f; reference 0.749",
         harmonic, coarse, arithmetic);
  CHECK(arithmetic == Approx(0.87).margin(0.02));
  CHECK(coarse < arithmetic);
  CHECK(arithmetic < harmonic);
  CHECK(harmonic == Approx(0.955).margin(0.02));
}
