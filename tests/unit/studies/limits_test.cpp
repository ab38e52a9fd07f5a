#include "studies/limits.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

ShearProbe probe_of(double mu_s, double delta_mu, double I) {
  ShearProbe probe = bare_probe(silo(128), I);
  probe.scene.materials[0].mu_s = mu_s;
  probe.scene.materials[0].delta_mu = delta_mu;
  return probe;
}

double lag_of(const ShearProbe& p) {
  return lag_factor(friction_at(p.I, p.scene.materials[0], p.scene.rheology));
}

}  // namespace

TEST_CASE("the analytic border: where C(I) = 0, lagging the viscosity neither lets waves grow nor decay") {
  for (const double I : {0.01, 0.0623, 0.3})
    for (const double delta_mu : {0.2, 0.38, 0.9}) {
      const auto mu_s = analytic_border(delta_mu, 0.6, I);
      REQUIRE(mu_s);
      const ShearProbe at = probe_of(*mu_s, delta_mu, I);
      CHECK(well_posedness(I, grain_of(at.scene.materials[0])) == Approx(0).margin(1e-6));
      CHECK(lag_of(at) == Approx(1).margin(1e-6));
      CHECK(lag_of(probe_of(*mu_s + 0.02, delta_mu, I)) > 1);
      CHECK(lag_of(probe_of(*mu_s - 0.02, delta_mu, I)) < 1);
    }
  // The range of I in which the thesis's low set is well posed begins where its mu_s is the border.
  const double first = (*well_posed_range(probe_of(0.47, 0.38, 0.01).scene.materials[0]))[0];
  CHECK(*analytic_border(0.38, 0.6, first) == Approx(0.47).epsilon(1e-4));
}

TEST_CASE(
    "a short wave in a shear flow grows on one side of the border and decays on the other, as fast as theory "
    "says") {
  const auto [mu_s, delta_mu, I] = GENERATE(std::array{0.62, 0.48, 0.01}, std::array{0.62, 0.48, 0.3},
                                            std::array{0.25, 0.48, 0.01}, std::array{0.47, 0.38, 0.3});
  const ShearProbe probe = probe_of(mu_s, delta_mu, I);
  const bool ill_posed = well_posedness(I, grain_of(probe.scene.materials[0])) > 0;
  const Growth measured = measured_growth(probe), theory = predicted_growth(probe);
  CAPTURE(mu_s, delta_mu, I, measured.per_step, theory.per_step);
  CHECK((measured.per_step > 0) == ill_posed);
  CHECK(measured.per_step == Approx(theory.per_step).margin(5e-4));  // the walls and the finite amplitude
  CHECK(measured.per_shear ==
        Approx(measured.per_step / (probe.time_step() * probe.shear_rate())).epsilon(1e-12));
}

TEST_CASE(
    "growth is per step: a smaller one only slows it by what the wave moves less, and smoothing or a cap "
    "stops it") {
  const ShearProbe bare = probe_of(0.62, 0.48, 0.01);
  ShearProbe stiff = bare, smooth = bare, capped = bare;
  stiff.stiffness = 4;
  smooth.scene.rheology.smoothing_length = 1;
  capped.scene.rheology.eta_max = 0.2 * bare.viscosity();
  const double growth = measured_growth(bare).per_step;
  CHECK(measured_growth(stiff).per_step > growth);
  CHECK(measured_growth(smooth).per_step < 0);
  CHECK(measured_growth(smooth).per_step == Approx(predicted_growth(smooth).per_step).margin(2e-3));
  CHECK(measured_growth(capped).per_step == Approx(-std::log(1.2)).margin(2e-3));
}

TEST_CASE("where a row of samples passes 0 upwards") {
  CHECK(*first_crossing({1, 2, 4}, {-1, -1, 3}) == Approx(2.5));
  CHECK(*first_crossing({1, 2, 3, 4}, {-1, NAN, 1, -5}) == Approx(2));
  CHECK_FALSE(first_crossing({1, 2, 3}, {3, 2, 1}));
  CHECK_FALSE(first_crossing({1, 2}, {NAN, 1}));
}

TEST_CASE("limits of a fluid without friction are refused") {
  CHECK_THROWS_AS(bare_probe(newtonian(1, 1, 8, {1}), 0.01), std::invalid_argument);
}
