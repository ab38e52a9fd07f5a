// Scenes that are images of each other have flows that are images of each other; threads change nothing.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/asymmetry.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;

namespace {

void run(Simulation& simulation, int steps) {
  for (int n = 0; n < steps; ++n) {
    const StepReport report = simulation.step();
    REQUIRE(report.viscous.converged);
    REQUIRE(report.pressure.converged);
  }
}

/// All air: one fluid falls through orifices. No free surface, whose directional sweeps know x from y.
Scene fluid_alone() {
  Scene s;
  s.width = s.height = 32;
  s.cells_x = 32;
  s.air = {1, 2};
  s.threads = 1;
  s.accuracy.viscous_tolerance = 1e-10;
  s.accuracy.pressure_tolerance = 1e-11;
  s.accuracy.precision = Precision::full;
  return s;
}

}  // namespace

TEST_CASE("a scene turned by a quarter has a flow turned by a quarter") {
  Scene down = fluid_alone();
  down.orifices = {{Side::bottom, 11, 6}};
  Scene left = down;
  left.gravity = {-1, 0};
  left.walls = {Wall::no_slip, Wall::open, Wall::no_slip, Wall::no_slip};
  left.orifices = {{Side::left, 11, 6}};
  Simulation a(down), b(left);
  run(a, 100);
  run(b, 100);
  double worst = 0, fastest = 0;
  for (int j = 0; j <= 32; ++j)
    for (int i = 0; i < 32; ++i) {
      worst = std::max(worst, std::abs(a.fields().v(i, j) - b.fields().u(j, i)));
      fastest = std::max(fastest, std::abs(a.fields().v(i, j)));
    }
  figure("quarter turn: largest difference %.1e of %.2f", worst, fastest);
  CHECK(worst < 1e-8 * fastest);
  CHECK(fastest > 1);
}

TEST_CASE("a mirrored scene has a mirrored flow: to rounding where there is no free surface") {
  Scene scene = fluid_alone();
  scene.orifices = {{Side::bottom, 11, 6}};
  Scene image = scene;
  image.orifices[0].centre = scene.width - 11;
  Simulation a(scene), b(image);
  run(a, 500);
  run(b, 500);
  const double difference = asymmetry(a.fields(), b.fields(), 0);
  figure("mirror, one fluid, 500 steps: %.1e", difference);
  CHECK(difference < 1e-9);
}

TEST_CASE("a symmetric silo stays symmetric through 1000 steps", "[slow]") {
  // The default grains are ill-posed at every inertial number; smoothing keeps that from growing. What grows all the same
  // does so for well-posed ones too: where two lines fit a nearly flat surface equally well, rounding decides which one is
  // taken, and the two sides of the silo may differ.
  for (bool well_posed : {false, true})
    for (Precision precision : {Precision::mixed, Precision::full}) {
      Scene scene = silo(64);
      if (well_posed) scene.materials = {well_posed_grains()};
      scene.accuracy.precision = precision;
      Simulation simulation(scene);
      const auto now = [&] { return asymmetry(simulation.fields(), simulation.fields()); };
      run(simulation, 7);  // before the surface leaves its first row of cells
      const double early = now();
      run(simulation, 93);
      const double middle = now();
      run(simulation, 900);
      const double late = now();
      figure(
          "mirror, base silo 64^2, %s, %s: asymmetry of v in the grains %.1e, %.1e, %.1e after 7, 100, 1000 "
          "steps",
          well_posed ? "well-posed grains" : "default grains", precision_names[static_cast<int>(precision)],
          early, middle, late);
      CHECK(early < (precision == Precision::full ? 1e-12 : 2e-6));
      CHECK(middle < 2e-5);
      CHECK(late < (well_posed ? 1e-4 : 1e-3));
    }
}

TEST_CASE("a mirrored orifice gives the mirrored flow") {
  const double h = 150.0 / 64;
  for (bool well_posed : {true, false}) {
    Scene scene = silo(64, 0, 20.5 * h, 9 * h);
    if (well_posed) scene.materials = {well_posed_grains()};
    Scene image = scene;
    image.orifices[0].centre = scene.width - scene.orifices[0].centre;
    Simulation a(scene), b(image);
    run(a, 500);
    run(b, 500);
    const double difference = asymmetry(a.fields(), b.fields());
    figure("mirror, orifice off the middle, %s: %.1e in the grains after 500 steps, discharged %.9g and %.9g",
           well_posed ? "well-posed grains" : "default grains", difference, a.orifice_mass()[0],
           b.orifice_mass()[0]);
    CHECK(difference < (well_posed ? 1e-4 : 1e-3));
    CHECK(a.orifice_mass()[0] == Approx(b.orifice_mass()[0]).epsilon(1e-6));
  }
}

TEST_CASE("one thread and several give the same bits", "[slow]") {
  Scene scene = silo(96);
  scene.materials.push_back(scene.materials[0]);  // a layer of other grains
  scene.materials[1].name = "layer";
  scene.materials[1].mu_s = 0.5;
  scene.fill.push_back(fill_box(1, 0, 150, 30, 60));
  Simulation alone(scene);
  run(alone, 200);
  for (int threads : {2, 3}) {
    scene.threads = threads;
    Simulation team(scene);
    run(team, 200);
    INFO(threads << " threads");
    const Fields &a = alone.fields(), &b = team.fields();
    CHECK(team.t() == alone.t());
    CHECK(same_bits(a.u, b.u));
    CHECK(same_bits(a.v, b.v));
    CHECK(same_bits(a.p, b.p));
    CHECK(same_bits(a.grains, b.grains));
    CHECK(same_bits(a.tracers[0], b.tracers[0]));
    CHECK(team.orifice_mass() == alone.orifice_mass());
  }
}

TEST_CASE("a blob of grains in a uniform stream moves with it: density 1000 : 1, nothing pushes") {
  Scene scene;
  scene.width = scene.height = 32;
  scene.cells_x = 32;
  scene.gravity = {0, 0};
  scene.walls = {Wall::periodic, Wall::periodic, Wall::free_slip, Wall::free_slip};
  scene.fill = {{0, {{9, 12}, {15, 8}, {22, 14}, {18, 23}, {11, 20}}}};
  scene.time.dt_max = 0.4;
  scene.threads = 1;
  Simulation simulation(scene);
  simulation.fields().u.fill(1);
  run(simulation, 100);  // 40 d: around once and more
  double worst = 0;
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i <= 32; ++i) worst = std::max(worst, std::abs(simulation.fields().u(i, j) - 1));
  for (int j = 0; j <= 32; ++j)
    for (int i = 0; i < 32; ++i) worst = std::max(worst, std::abs(simulation.fields().v(i, j)));
  figure("blob in a stream: largest change of velocity %.1e", worst);
  CHECK(worst < 1e-10);
}
