// The modules of `physics:` together: free when a scene does not name them, sound in every combination.
#include <catch2/catch.hpp>
#include <map>
#include <string>
#include <tuple>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;

namespace {

/// The base silo with any of: 1 nonlocal, 2 dilatancy, 4 wall friction, 8 a slippery material on top.
Scene silo_with(int modules, int cells, double end) {
  Scene s = silo(cells, end);
  if (modules & 1) s.nonlocal = Nonlocal{};
  if (modules & 2) s.dilatancy = Dilatancy{};
  if (modules & 4) s.wall_friction = WallFriction{.F = 0.0167};
  if (modules & 8) {
    Material slippery = s.materials[0];
    slippery.name = "slippery";
    slippery.mu_s = 0.47;
    slippery.delta_mu = 0.38;
    s.materials.push_back(slippery);
    s.fill.push_back(fill_box(1, 0, s.width, 75, 135));
  }
  return s;
}

std::map<std::string, std::size_t> memory_of(const Scene& scene) {
  const auto table = Simulation(scene).memory();
  return {table.begin(), table.end()};
}

std::vector<std::string> stages_of(Scene scene) {
  scene.time.max_steps = 2;
  std::vector<std::string> names;
  for (const auto& [name, seconds] : Simulation(scene).run().stages) names.push_back(name);
  return names;
}

void every_combination_drains(int cells) {
  for (int modules : {1, 2, 4, 8, 3, 5, 9, 6, 10, 12, 15}) {
    Scene scene = silo_with(modules, cells, 400);
    scene.stop.mass_below = 0.25;
    scene.threads = 2;
    const Summary s = Simulation(scene).run();
    INFO("modules " << modules);
    CHECK(s.status == Status::stopped);
    CHECK(s.missed_tolerances == 0);
    CHECK(s.mass_error < 1e-6);
    figure("modules %2d, drain %d^2: rate %.4f, static %.4f, mass error %.1e, %ld steps", modules, cells,
           s.discharge_rate / code_unit, s.quasi_static_fraction, s.mass_error, s.steps);
  }
}

}  // namespace

TEST_CASE("what a scene does not name is neither stored nor timed") {
  const int n = 32;
  const auto plain = memory_of(silo_with(0, n, 1));
  CHECK(plain.count("fluidity") == 0);
  CHECK(plain.count("dilatancy") == 0);
  CHECK(plain.count("splitting") == 0);
  const std::vector<std::string> stages{"time step", "vof",     "mass",       "rheology",
                                        "momentum",  "viscous", "projection", "output and diagnostics"};
  CHECK(stages_of(silo_with(0, n, 1)) == stages);

  const auto grown = [&](const Scene& scene) {  // groups that are new, or larger than in the plain scene
    std::vector<std::string> names;
    for (const auto& [name, bytes] : memory_of(scene))
      if (!plain.count(name) || bytes > plain.at(name)) names.push_back(name);
    return names;
  };
  const std::size_t field = CellField(silo(n).patch()).bytes();
  CHECK(grown(silo_with(1, n, 1)) == std::vector<std::string>{"backup", "fields", "fluidity"});
  CHECK(memory_of(silo_with(1, n, 1)).at("fields") == plain.at("fields") + field);
  CHECK(grown(silo_with(2, n, 1)) == std::vector<std::string>{"backup", "dilatancy", "fields", "projection"});
  CHECK(grown(silo_with(4, n, 1)) == std::vector<std::string>{"rheology"});
  CHECK(memory_of(silo_with(4, n, 1)).at("rheology") == plain.at("rheology") + field);
  CHECK(grown(silo_with(8, n, 1)) == std::vector<std::string>{"backup", "fields", "volume of fluid"});

  Scene named = silo_with(0, n, 1);  // with everything that needs no memory of its own
  named.rheology.cap = Cap::smooth;
  named.materials[0].cohesion = 1;
  CHECK(grown(named).empty());
  named.accuracy.splitting = {2, 1, 1};
  CHECK(grown(named) == std::vector<std::string>{"splitting"});

  const auto has = [&](int modules, const char* stage) {
    const auto names = stages_of(silo_with(modules, n, 1));
    return std::count(names.begin(), names.end(), stage) == 1;
  };
  CHECK(has(1, "rheology and fluidity"));
  CHECK(has(2, "dilatancy"));
  CHECK(stages_of(silo_with(4, n, 1)) == stages);
  CHECK(stages_of(silo_with(8, n, 1)) == stages);
}

TEST_CASE("a module of strength zero changes nothing") {
  const int n = 32;
  const auto last_of = [](const Scene& scene) {
    Simulation s(scene);
    for (int k = 0; k < 40; ++k) s.step();
    return s.fields();
  };
  const Fields plain = last_of(silo(n, 100));
  const auto apart = [&](const Scene& scene) {
    const Fields f = last_of(scene);
    double most = 0;
    for (int j = 0; j < f.v.ny(); ++j)
      for (int i = 0; i < n; ++i) most = std::max(most, std::abs(f.v(i, j) - plain.v(i, j)));
    return most;
  };
  Scene s = silo(n, 100);
  s.wall_friction = WallFriction{.F = 0};
  CHECK(apart(s) < 1e-12);
  s = silo(n, 100);
  // Their shear rate is without the trace that the tolerance of the projection leaves.
  s.dilatancy = Dilatancy{.phi_g = 0, .mode = DilatancyMode::weight};
  CHECK(apart(s) < 3e-3);
  s.dilatancy = Dilatancy{.phi_g = 0};
  CHECK(apart(s) < 3e-3);
  s = silo(n, 100);
  s.nonlocal = Nonlocal{.A = 0, .walls = FluidityWall::no_flux};
  CHECK(apart(s) < 0.02);  // to the tolerances of two more solves
}

TEST_CASE("every combination of modules flows, keeps its mass and misses no tolerance") {
  for (int modules = 0; modules < 16; ++modules) {
    const Summary s = Simulation(silo_with(modules, 32, 11)).run();
    INFO("modules " << modules);
    CHECK(s.status == Status::finished);
    CHECK(s.missed_tolerances == 0);
    CHECK(s.mass_error < 1e-6);
    CHECK(s.warnings == std::vector<std::string>{});
    CHECK(s.discharge_rate / code_unit == Approx(0.45).margin(0.15));
  }
}

TEST_CASE("every combination of modules drains the base scene at 64^2", "[slow]") {
  every_combination_drains(64);
}

TEST_CASE("every combination of modules drains the base scene at 128^2", "[long]") {
  every_combination_drains(128);
}

TEST_CASE("grains are not crushed while they start to flow, nor after") {
  // Fluidity and wall friction put tension beside the walls when the pressure builds up; S must not answer to that.
  for (const auto& [modules, cells, most] : {std::tuple{2, 64, 0.601}, {7, 64, 0.61}, {7, 128, 0.66}}) {
    Simulation s(silo_with(modules, cells, 100));
    double highest = 0, lowest = 1;
    for (int k = 0; k < 60; ++k) {
      s.step();
      const CellField packing = s.derived("packing");
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          if (s.fields().grains(i, j) <= 0.99) continue;
          highest = std::max(highest, packing(i, j));
          lowest = std::min(lowest, packing(i, j));
        }
    }
    figure("packing in the first 60 steps, modules %d, %d cells: %.4f to %.4f", modules, cells, lowest,
           highest);
    CHECK(highest < most);
    CHECK(lowest > 0.2);
  }
}

TEST_CASE("with all modules the result does not depend on the number of threads") {
  Scene scene = silo_with(15, 32, 100);
  Simulation one(scene);
  scene.threads = 3;
  Simulation three(scene);
  for (int k = 0; k < 30; ++k) {
    one.step();
    three.step();
  }
  const Fields &a = one.fields(), &b = three.fields();
  CHECK(same_bits(a.u, b.u));
  CHECK(same_bits(a.v, b.v));
  CHECK(same_bits(a.p, b.p));
  CHECK(same_bits(a.fluidity, b.fluidity));
  CHECK(same_bits(a.solid[0], b.solid[0]));
  CHECK(same_bits(a.solid[1], b.solid[1]));
}

TEST_CASE("the rotational update finds the pressure of stiff grains at rest, the plain one does not") {
  // A closed silo at rest under eta_max whose pressure is off by 10 %: what is left of that.
  const auto left_after = [](int steps, double rotational, double eta_max) {
    const int n = 32;
    Scene s = silo(n, 1000);
    s.orifices.clear();
    s.start_pressure = StartPressure::hydrostatic;
    s.rheology.eta_max = eta_max;
    s.accuracy.splitting.rotational = rotational;
    s.accuracy.viscous_tolerance = 1e-6;
    s.accuracy.pressure_tolerance = 1e-10;
    Simulation simulation(s);
    CellField& p = simulation.fields().p;
    const CellField still = p;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) p(i, j) *= 1 + 0.1 * std::sin(2 * M_PI * i / n) * std::sin(M_PI * j / n);
    const auto error = [&] {
      double sum = 0;
      for (int j = 0; j < 26; ++j)
        for (int i = 0; i < n; ++i) sum += (p(i, j) - still(i, j)) * (p(i, j) - still(i, j));
      return std::sqrt(sum);
    };
    const double before = error();
    for (int k = 0; k < steps; ++k) simulation.step();
    return error() / before;
  };
  const double plain = left_after(20, 0, 1.643e6), half = left_after(20, 0.5, 1.643e6),
               full = left_after(20, 1, 1.643e6), soft = left_after(20, 1, 1.643e4);
  figure("error of p after 20 steps: omega 0 %.3f, 1/2 %.3f, 1 %.3f; 1 at eta_max / 100 %.3f", plain, half,
         full, soft);
  CHECK(plain > 0.8);
  CHECK(half < 0.1);
  CHECK(full < 0.02);
  CHECK(soft < 0.02);
}

TEST_CASE("a tolerance that the fluidity misses in any round of a step is a missed one") {
  Scene scene = silo_with(1, 32, 100);
  scene.accuracy.splitting = {2, 2, 1};
  CHECK(Simulation(scene).step().fluidity.converged);
  scene.accuracy.fluidity_tolerance = 1e-14;
  scene.accuracy.max_iterations = 3;
  const SolveStats missed = Simulation(scene).step().fluidity;
  CHECK(missed.iterations == 4 * scene.accuracy.max_iterations);
  CHECK_FALSE(missed.converged);
}

TEST_CASE("the static share does not depend on the number of steps") {
  const auto share = [](double dt_max) {
    Scene s = silo(64, 27.386);
    s.time.dt_max = dt_max;
    return Simulation(s).run().quasi_static_fraction;
  };
  const double whole = share(0.0548), quarter = share(0.0137);
  figure("static share at dt, dt/4: %.4f %.4f", whole, quarter);
  CHECK(whole == Approx(quarter).epsilon(0.03));
}
