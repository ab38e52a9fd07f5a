#include "studies/outflow.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace hourglass;

namespace {

/// Steady outflow 2 of a silo that holds 100; the tracer's cumulative outflow is given.
template <class Cumulative>
OutflowSeries series(int n, double end, double tracer_mass, Cumulative cumulative) {
  OutflowSeries s{{0}, {0}, {0}, 100, tracer_mass};
  for (int k = 1; k <= n; ++k) {
    const double t = end * k / n;
    s.all.push_back(2);
    s.of_tracer.push_back((cumulative(t) - cumulative(s.t.back())) / (t - s.t.back()));
    s.t.push_back(t);
  }
  return s;
}

}  // namespace

TEST_CASE("rate: exact on a straight line, and its standard error is that of the noise") {
  History mass;
  for (int k = 0; k <= 100; ++k) mass.push_back({0.1 * k, 50 - 3 * 0.1 * k});
  const RateEstimate exact = rate_with_error(mass, 2, 8);
  CHECK(exact.rate == Approx(3).epsilon(1e-12));
  CHECK(exact.batches == 10);
  CHECK(*exact.standard_error < 1e-12);
  CHECK_FALSE(rate_with_error(mass, 2, 2.25).standard_error);  // two intervals: one part

  // Outflows with independent noise s: the error of their mean is s / sqrt(n).
  double sum = 0;
  constexpr int sets = 200, n = 400;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    History noisy{{0, 1000}};
    for (int k = 1; k <= n; ++k) noisy.push_back({1.0 * k, noisy.back()[1] - 1 - 0.2 * normal(random)});
    sum += std::pow(*rate_with_error(noisy, 0, n).standard_error, 2);
  }
  CHECK(std::sqrt(sum / sets) == Approx(0.2 / std::sqrt(n)).epsilon(0.15));
}

TEST_CASE("step change: first in, first out is a sharp step and does not mix") {
  const StepResponse r =
      step_response(series(50, 50, 60, [](double t) { return 2 * std::max(0.0, t - 20); }));
  REQUIRE(r.F.size() == 50);
  CHECK(r.F[19] == 0);
  CHECK(r.F[20] == Approx(1).epsilon(1e-14));
  CHECK(r.drained[24] == Approx(0.49));
  CHECK(r.mean == Approx(20).epsilon(1e-12));
  CHECK(r.variance == Approx(0).margin(1e-10));
  CHECK(r.mixing_index == Approx(0).margin(1e-12));
}

TEST_CASE("step change: a perfectly mixed silo has the index 1") {
  const StepResponse r = step_response(series(50, 50, 60, [](double t) { return 1.2 * t; }));
  for (const double F : r.F) CHECK(F == Approx(0.6).epsilon(1e-12));
  CHECK(r.mixing_index == Approx(1).epsilon(1e-12));
}

TEST_CASE(
    "step change: a stirred tank behind a plug has mean delay + tau and variance tau^2, at second order") {
  constexpr double tau = 4, delay = 10;
  const auto cumulative = [](double t) {
    return t < delay ? 0 : 2 * (t - delay - tau * (1 - std::exp(-(t - delay) / tau)));
  };
  double before = 0;
  for (const int n : {500, 1000}) {
    const StepResponse r = step_response(series(n, 100, 60, cumulative));
    const double mean_error = std::abs(r.mean - delay - tau),
                 variance_error = std::abs(r.variance - tau * tau);
    CHECK(mean_error < 1e-6);
    REQUIRE(r.E.size() == 50);
    double area = 0;
    for (const double E : r.E) area += E * 2;
    CHECK(area == Approx(1).epsilon(1e-2));  // the parts are 2 long, but for what F is apart from the ends
    // The mean of E over such a part.
    for (std::size_t p = 0; p < r.E.size(); ++p)
      if (r.E_t[p] > delay + 2 && r.E_t[p] < delay + 4 * tau)
        CHECK(r.E[p] == Approx(std::exp(-(r.E_t[p] - delay) / tau) * std::sinh(1 / tau)).epsilon(0.03));
    if (before > 0) CHECK(before / variance_error == Approx(4).epsilon(0.05));
    before = variance_error;
  }
}

TEST_CASE("step change: a trickle at the end says nothing") {
  OutflowSeries s = series(50, 50, 60, [](double t) { return 2 * std::max(0.0, t - 20); });
  s.t.push_back(51);
  s.all.push_back(0.001);
  s.of_tracer.push_back(0);
  const StepResponse r = step_response(s);
  CHECK(r.F.size() == 50);
  CHECK(r.mean == Approx(20).epsilon(1e-12));
}
