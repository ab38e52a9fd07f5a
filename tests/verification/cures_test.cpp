// What each cure of ill-posedness does to the base silo: the table of docs/physics.md.
//
//   HOURGLASS_FIGURES=1 build/release/tests/verification "[cures]"
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tests/support/asymmetry.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

struct Outcome {
  double rate, static_share, corner_pressure, asymmetry, roughness;
  double viscous_iterations;
};

Outcome outcome(Scene scene) {
  scene.threads = 2;
  struct Count : Observer {
    double viscous = 0, steps = 0;
    void on_step(const StepReport& r, double) override {
      viscous += r.viscous.iterations;
      steps += 1;
    }
  } count;
  Simulation s(scene);
  const Summary summary = s.run({&count});
  CHECK(summary.missed_tolerances == 0);
  const Fields& f = s.fields();
  const int n = f.p.nx();
  double corner = 0, checker = 0, cells = 0;
  const int near = n / 10;
  for (int j = 0; j < near; ++j)
    for (int i = 0; i < near; ++i) corner += 0.5 * (f.p(i, j) + f.p(n - 1 - i, j));
  corner /= near * near;
  const CellField eta = s.derived("viscosity"), rate = s.derived("shear_rate");
  for (int j = 1; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (f.grains(i, j) + f.grains(i, j - 1) < 1.999) continue;
      if (i + 1 == n || f.grains(i + 1, j) < 1 || f.grains(i + 1, j - 1) < 1 || rate(i, j) < 0.02) continue;
      const double x = std::log(eta(i, j)) - std::log(eta(i + 1, j)) - std::log(eta(i, j - 1)) +
                       std::log(eta(i + 1, j - 1));
      checker += x * x / 16;
      cells += 1;
    }
  return {
      summary.discharge_rate / code_unit,        summary.quasi_static_fraction, corner / 135, asymmetry(f, f),
      std::sqrt(checker / std::max(cells, 1.0)), count.viscous / count.steps};
}

}  // namespace

TEST_CASE("cures of ill-posedness, measured", "[cures][long]") {
  struct Cure {
    const char* name;
    std::function<void(Scene&)> apply;
  };
  const std::vector<Cure> cures{
      {"none (smoothing_length 0)", [](Scene& s) { s.rheology.smoothing_length = 0; }},
      {"smoothing_length d/2 (default)", [](Scene&) {}},
      {"smoothing_length d", [](Scene& s) { s.rheology.smoothing_length = 1; }},
      {"smoothing_length 2 d", [](Scene& s) { s.rheology.smoothing_length = 2; }},
      {"cap: smooth, no smoothing",
       [](Scene& s) {
         s.rheology.smoothing_length = 0;
         s.rheology.cap = Cap::smooth;
       }},
      {"eta_max / 100, no smoothing",
       [](Scene& s) {
         s.rheology.smoothing_length = 0;
         s.rheology.eta_max = 1.643e4;
       }},
      {"nonlocal, thesis, no smoothing",
       [](Scene& s) {
         s.rheology.smoothing_length = 0;
         s.nonlocal = Nonlocal{};
       }},
      {"nonlocal, kamrin, no smoothing",
       [](Scene& s) {
         s.rheology.smoothing_length = 0;
         s.nonlocal = Nonlocal{.closure = Closure::kamrin};
       }},
      {"well-posed set, no smoothing",
       [](Scene& s) {
         s.materials[0] = well_posed_grains();
         s.rheology.smoothing_length = 0;
       }},
      {"low friction, no smoothing",
       [](Scene& s) {
         s.materials[0].mu_s = 0.47;
         s.materials[0].delta_mu = 0.38;
         s.rheology.smoothing_length = 0;
       }},
      {"low friction, mu_I_regularised, no smoothing",
       [](Scene& s) {
         s.materials[0].mu_s = 0.47;
         s.materials[0].delta_mu = 0.38;
         s.rheology.law = Law::mu_I_regularised;
         s.rheology.smoothing_length = 0;
       }},
  };
  for (const Cure& cure : cures) {
    Scene scene = silo(128, 27.386);
    cure.apply(scene);
    const Outcome whole = outcome(scene);
    scene.time.dt_max /= 4;
    const Outcome quarter = outcome(scene);
    figure("| %s | %.4f, %.4f | %.3f, %.3f | %.3f, %.3f | %.0e, %.0e | %.3f, %.3f | %.1f, %.1f |", cure.name,
           whole.rate, quarter.rate, whole.static_share, quarter.static_share, whole.corner_pressure,
           quarter.corner_pressure, whole.asymmetry, quarter.asymmetry, whole.roughness, quarter.roughness,
           whole.viscous_iterations, quarter.viscous_iterations);
  }
}
