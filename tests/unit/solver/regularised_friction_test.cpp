// The regularised friction law of Barker & Gray 2017: its published constants, continuity, and where it is well posed.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/scene.hpp"
#include "tests/support/figures.hpp"

using namespace hourglass;

namespace {

struct Case {
  double mu_s, delta_mu, I_0, I_1, A;  // the last two: what they must come to
};
constexpr Case cases[] = {{0.342, 0.215, 0.069, 0.00397, 1.56e4},
                          {0.32, 0.28, 0.4, 0.01363, 5.58e5},
                          {0.47, 0.38, 0.6, 0.0623, 104}};

Material material(const Case& c) {
  Material m;
  m.mu_s = c.mu_s;
  m.delta_mu = c.delta_mu;
  m.I_0 = c.I_0;
  return m;
}

}  // namespace

TEST_CASE("regularised friction: I_1 and A of Barker & Gray for three sets of grains") {
  for (const Case& c : cases) {
    const auto law = regularised_friction(material(c), Rheology{});
    REQUIRE(law);
    figure("regularised mu(I), (%.3f, %.3f, %.3f): I_1 %.6f, A %.4e", c.mu_s, c.delta_mu, c.I_0, law->I_1,
           std::exp(law->log_A));
    CHECK(law->I_1 == Approx(c.I_1).epsilon(2e-3));
    CHECK(std::exp(law->log_A) == Approx(c.A).epsilon(1e-2));
  }
  Material steep;  // the default set: well posed nowhere
  CHECK_FALSE(regularised_friction(steep, Rheology{}));
}

TEST_CASE("regularised friction is continuous, rises, and goes to zero with I") {
  for (const Case& c : cases) {
    const RegularisedFriction law = *regularised_friction(material(c), Rheology{});
    const Grain g = grain_of(material(c));
    const double jump = law.mu(law.I_1 * (1 + 1e-12), g) - law.mu(law.I_1 * (1 - 1e-12), g);
    CHECK(std::abs(jump) < 1e-10);
    double before = 0;
    for (double I = 1e-30; I < 1e3; I *= 1.1) {
      const double mu = law.mu(I, g);
      CHECK(mu > before);
      before = mu;
    }
    CHECK(law.mu(1e-300, g) < 0.06);
    CHECK(law.mu(0, g) == law.mu(1e-300, g));
    // By mu_inf and no more above I_1.
    const double I = 10 * law.I_1;
    CHECK(law.mu(I, g) == Approx(mu_of_I(I, g) + law.mu_inf * I * I / (c.I_0 + I)).epsilon(1e-12));
  }
}

// C = 4 nu^2 - 4 nu + mu^2 (1 - nu/2)^2 with nu = dln mu / dln I, by differences of the law as it is coded. On the branch of
// the logarithm nu = mu^2 / (2 alpha), and C <= 0 for every mu as long as alpha < 2.
TEST_CASE("regularised friction is well posed at every I up to 5, plain mu(I) is not at small ones") {
  for (const Case& c : cases) {
    const RegularisedFriction law = *regularised_friction(material(c), Rheology{});
    const Grain g = grain_of(material(c));
    double worst = -1e300;
    for (double I = 1e-12; I < 5; I *= 1.07) {
      const double step = 1e-4;
      if (std::abs(std::log(I / law.I_1)) < 2 * step) continue;  // the kink
      const double mu = law.mu(I, g);
      const double nu =
          (std::log(law.mu(I * std::exp(step), g)) - std::log(law.mu(I * std::exp(-step), g))) / (2 * step);
      const double C = 4 * nu * nu - 4 * nu + mu * mu * (1 - nu / 2) * (1 - nu / 2);
      if (I < law.I_1) {
        CHECK(nu == Approx(mu * mu / (2 * law.alpha)).epsilon(1e-5));
        CHECK(C <= 0);
      }
      worst = std::max(worst, C / (mu * mu));
    }
    figure("regularised mu(I), (%.3f, %.3f, %.3f): largest C / mu^2 up to I = 5: %.3f", c.mu_s, c.delta_mu,
           c.I_0, worst);
    CHECK(worst < 0);
    CHECK(well_posedness(0.5 * law.I_1, g) > 0);
    CHECK(well_posedness(2 * law.I_1, g) < 0);
  }
}
