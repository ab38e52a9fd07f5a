#include "studies/beverloo.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace hourglass;

namespace {

const std::vector<double> widths{4, 6, 8, 10, 12, 15, 18.75, 25, 37.5};

/// Rates of C = 1.3, k = 1.92 with the exponent; relative noise.
std::vector<DischargePoint> data(double n, double noise = 0, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<DischargePoint> points;
  for (const double w : widths) points.push_back({{w}, 1.3 * std::pow(w - 1.92, n) + noise * normal(random)});
  return points;
}

}  // namespace

TEST_CASE("Beverloo: exact data give back C, k and n") {
  const BeverlooFit held = fit_beverloo(data(1.5), {{}, 1.5});
  CHECK(held.value[0] == Approx(1.3).epsilon(1e-9));
  CHECK(held.value[1] == Approx(1.92).epsilon(1e-9));
  CHECK(held.value[2] == 1.5);
  CHECK(held.interval[2] == 0);
  const BeverlooFit all = fit_beverloo(data(1.37), {});
  CHECK(all.value[0] == Approx(1.3).epsilon(1e-8));
  CHECK(all.value[1] == Approx(1.92).epsilon(1e-8));
  CHECK(all.value[2] == Approx(1.37).epsilon(1e-8));
  const BeverlooFit zero = fit_beverloo(data(1.5), {0.0, 1.5});  // linear: the projection
  double qw = 0, ww = 0;
  for (const DischargePoint& p : data(1.5)) {
    const double w = std::pow(p.widths[0], 1.5);
    qw += p.rate * w, ww += w * w;
  }
  CHECK(zero.value[0] == Approx(qw / ww).epsilon(1e-14));
  CHECK(zero.value[1] == 0);
  CHECK(zero.residual > 1000 * held.residual);
}

TEST_CASE("Beverloo: equal orifices discharge together") {
  std::vector<DischargePoint> points = data(1.5);
  for (DischargePoint& p : points) {
    p.widths.push_back(p.widths[0]);
    p.rate *= 2;
  }
  const BeverlooFit fit = fit_beverloo(points, {{}, 1.5});
  CHECK(fit.value[0] == Approx(1.3).epsilon(1e-9));
  CHECK(fit.value[1] == Approx(1.92).epsilon(1e-9));
  CHECK(fit.rate({10, 10}) == Approx(2 * 1.3 * std::pow(8.08, 1.5)).epsilon(1e-9));
}

TEST_CASE("Beverloo: intervals cover the truth in 95 of 100 noisy sets, and the band widens outwards") {
  int C = 0, k = 0, rate = 0;
  constexpr int sets = 1000;
  const double truth = 1.3 * std::pow(20 - 1.92, 1.5);
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const BeverlooFit fit = fit_beverloo(data(1.5, 0.5, seed), {{}, 1.5});
    C += std::abs(fit.value[0] - 1.3) < fit.interval[0];
    k += std::abs(fit.value[1] - 1.92) < fit.interval[1];
    rate += std::abs(fit.rate({20}) - truth) < fit.rate_interval({20});
  }
  for (const int covered : {C, k, rate}) {  // four standard deviations of a share of 0.95
    CHECK(covered > sets * 0.95 - 28);
    CHECK(covered < sets * 0.95 + 28);
  }
  const BeverlooFit fit = fit_beverloo(data(1.5, 0.5), {{}, 1.5});
  CHECK(fit.rate_interval({60}) > fit.rate_interval({20}));
}

TEST_CASE("Beverloo: Student's t, and what cannot be fitted") {
  CHECK(student_t(1) == Approx(12.7062047364).epsilon(1e-9));
  CHECK(student_t(2) == Approx(4.3026527297).epsilon(1e-9));
  CHECK(student_t(5) == Approx(2.5705818366).epsilon(1e-9));
  CHECK(student_t(10) == Approx(2.2281388520).epsilon(1e-9));
  CHECK(student_t(1000) == Approx(1.9623390808).epsilon(1e-9));
  CHECK_THROWS_AS(fit_beverloo({{{4}, 1}, {{5}, 2}}, {}), std::invalid_argument);
  CHECK_THROWS_AS(fit_beverloo({{{4}, 1}, {{0}, 2}}, {0.0, 1.5}), std::invalid_argument);
  CHECK(std::isnan(fit_beverloo({{{4}, 1}, {{5}, 2}}, {{}, 1.5}).interval[0]));
}
