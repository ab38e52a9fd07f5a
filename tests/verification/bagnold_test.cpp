// Exact flows of the mu(I) rheology: Bagnold flow down an incline, and the vertical chute with its plug.
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/granular_channel.hpp"

using namespace hourglass;

namespace {

// Depth or half width, g and density are 1. The steps that the Courant number allows, in viscous times, grow as d^2: fine
// grains (d = 1/30) take minutes to settle, coarse ones (1/4) seconds.

struct Errors {
  double l2, largest;
};
template <class Velocity>
Errors errors_of(const Fields& f, Velocity&& velocity) {
  Errors e{0, 0};
  for (int j = 0; j < f.u.ny(); ++j) {
    const double error = std::abs(f.u(1, j) - velocity(f.patch().y_centre(j)));
    e.l2 += error * error / f.u.ny();
    e.largest = std::max(e.largest, error);
  }
  e.l2 = std::sqrt(e.l2);
  return e;
}

// Bagnold: tan alpha = mu(I_alpha), P = rho g cos alpha (h - y),
// u = (2/3) (I_alpha / d) sqrt(g cos alpha) (h^1.5 - (h - y)^1.5).
constexpr double alpha = 0.40;
double bagnold(double y, double d) {
  const double I = 0.4 * (std::tan(alpha) - 0.32) / (0.32 + 0.28 - std::tan(alpha));
  return 2.0 / 3 * I / d * std::sqrt(std::cos(alpha)) * (1 - std::pow(1 - y, 1.5));
}

// Vertical chute of half width W at constant pressure P, plug |x| < mu_s / a, a = rho g / P; x from the centre:
// v = (I_0/d) sqrt(P/rho) (-(W - x) + (delta_mu / a) ln[(mu_2 - a x) / (mu_2 - a W)]) outside of the plug.
constexpr double W = 0.5;
double chute(double x, double d) {
  const double mu_s = 0.32, delta_mu = 0.28, mu_2 = mu_s + delta_mu, outside = std::max(x, mu_s);
  return 0.4 / d * (-(W - outside) + delta_mu * std::log((mu_2 - outside) / (mu_2 - W)));
}

std::vector<double> bagnold_errors(double d, CornerMean mean, double end, const std::vector<int>& grids) {
  std::vector<double> errors, largest;
  for (int n : grids) {
    Scene scene = granular_channel(1, n, {std::sin(alpha), -std::cos(alpha)}, d, Wall::open);
    scene.rheology.corner_mean = mean;
    Simulation simulation(scene);
    Fields& f = simulation.fields();
    const auto exact = [&](double y) { return bagnold(y, d); };
    start(f, exact);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < 4; ++i) f.p(i, j) = std::cos(alpha) * (1 - f.patch().y_centre(j));
    while (simulation.t() < end) simulation.step(end);
    const Errors e = errors_of(f, exact);
    errors.push_back(e.l2);
    largest.push_back(e.largest);
    double across = 0;
    for (int j = 0; j <= n; ++j) across = std::max(across, std::abs(f.v(1, j)));
    CHECK(across < 1e-5);  // of 4.4: what the tolerances leave
    figure("Bagnold d %.4f, %d cells: surface cell %.5f, exact there %.5f", d, n, f.u(1, n - 1),
           exact(f.patch().y_centre(n - 1)));
  }
  figure("Bagnold d %.4f, %s: L2 %s orders %s; largest %s orders %s", d,
         corner_mean_names[static_cast<int>(mean)], listed(errors).c_str(), listed(orders(errors)).c_str(),
         listed(largest).c_str(), listed(orders(largest)).c_str());
  return errors;
}

}  // namespace

TEST_CASE("the exact granular flows have the published speeds") {
  CHECK(bagnold(1, 1.0 / 30) == Approx(4.45367).epsilon(1e-5));
  CHECK(chute(0, 1.0 / 30) == Approx(1.29952).epsilon(1e-5));
  CHECK(chute(0.4, 1.0 / 30) == Approx(1.12897).epsilon(1e-5));
}

// The exact shear is sqrt(s), s the depth below the surface, and a difference of second order misses it by c (h/s)^2 of
// itself; what this adds to the velocity between the floor and s grows as h^2 / sqrt(s). With arithmetic corner means
// c = 0. With harmonic ones c = 1/16, and the square of the L2 norm, the integral of h^4 / s from the first cell on, is
// h^4 (a + b ln(1/h)): second order but for a logarithm, whose law is the sharper test.
TEST_CASE("Bagnold flow of coarse grains, arithmetic corner means: second order in L2", "[slow]") {
  const std::vector<double> errors = bagnold_errors(0.25, CornerMean::arithmetic, 40, {16, 32, 64, 128});
  expect_order(errors, 2.0, 0.08);
  CHECK(errors.back() < 1e-4 * bagnold(1, 0.25));
}

TEST_CASE("Bagnold flow of coarse grains, harmonic corner means: second order and a logarithm in L2", "[slow]") {
  const std::vector<int> grids{16, 32, 64, 128};
  const std::vector<double> errors = bagnold_errors(0.25, CornerMean::harmonic, 40, grids);
  std::vector<double> growth;  // of (error / h^2)^2 from grid to grid: b ln 2
  for (std::size_t k = 1; k < grids.size(); ++k)
    growth.push_back(std::pow(errors[k] * grids[k] * grids[k], 2) -
                     std::pow(errors[k - 1] * grids[k - 1] * grids[k - 1], 2));
  figure("Bagnold, harmonic: growth of (error / h^2)^2 per doubling %s", listed(growth).c_str());
  for (double g : growth) CHECK(g == Approx(growth.back()).epsilon(0.1));
  CHECK(errors.back() < 2e-4 * bagnold(1, 0.25));
}

TEST_CASE("Bagnold flow of fine grains: second order in L2", "[long]") {
  const std::vector<double> errors = bagnold_errors(1.0 / 30, CornerMean::arithmetic, 300, {16, 32, 64});
  expect_order(errors, 2.0, 0.1);
  CHECK(errors.back() < 1e-3 * bagnold(1, 1.0 / 30));
}

// Not second order: |γ̇| in a cell is a mean over its corners and 1/eta at a corner a mean over its cells, so that at the
// edge of the plug, where tau = mu_s P, γ̇ obeys (1 - tau / (mu_s P)) γ̇ = (h/2)^2 γ̇'': an Airy layer of width h^(2/3), in which
// γ̇ grows linearly. The plug's speed is off by its square, h^(4/3).
TEST_CASE("vertical chute at constant pressure: order 4/3, from the edge of the plug") {
  const double d = 0.25;
  std::vector<double> errors, plug;
  for (int n : {16, 32, 64, 128}) {
    // y from the wall at rest to the centre line; the pressure is that of the background alone.
    Scene s = granular_channel(W, n, {1, 0}, d, Wall::free_slip);
    s.rheology.background_pressure = 1;
    Simulation simulation(s);
    const auto exact = [&](double y) { return chute(W - y, d); };
    start(simulation.fields(), exact);
    while (simulation.t() < 10) simulation.step(10);
    errors.push_back(errors_of(simulation.fields(), exact).l2);
    plug.push_back(simulation.fields().u(1, n - 1));
  }
  figure("chute: L2 %s orders %s; plug %s, exact %.5f", listed(errors).c_str(),
         listed(orders(errors)).c_str(), listed(plug).c_str(), chute(0, d));
  expect_order(errors, 4.0 / 3, 0.15);
  CHECK(errors.back() < 3e-3 * chute(0, d));
  CHECK(plug.back() == Approx(chute(0, d)).epsilon(5e-3));
}
