// Plane channel flow of one and two Newtonian layers between walls, driven by gravity along the channel.
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/layered_flow.hpp"

using namespace hourglass;

namespace {

constexpr double gravity = 1e-8;  // slow: steps as long as the viscous time

/// L2 error over the channel relative to the fastest velocity.
double error_of(const std::vector<Layer>& layers, int cells, CornerMean mean = CornerMean::harmonic) {
  Scene s = layered_scene(layers, gravity, true, cells);
  s.rheology.corner_mean = mean;
  Simulation simulation(s);
  run_to_steady(simulation, 1e-11, 60);
  const LayeredFlow exact(layers, gravity, true);
  const Patch& p = simulation.fields().patch();
  double error = 0, fastest = 0;
  for (int j = 0; j < p.ny; ++j) {
    const double u = exact.velocity(p.y_centre(j));
    error += std::pow(simulation.fields().u(1, j) - u, 2);
    fastest = std::max(fastest, u);
  }
  return std::sqrt(error / p.ny) / fastest;
}

}  // namespace

TEST_CASE("the exact layered flow is what it should be") {
  const LayeredFlow one({{1, 2, 3}}, 0.5, true);  // parabola: rho g y (1 - y) / (2 eta)
  CHECK(one.velocity(0.3) == Approx(3 * 0.5 * 0.3 * 0.7 / 4));
  CHECK(one.velocity(1) == Approx(0).margin(1e-15));
  const LayeredFlow two({{0.4, 1, 1}, {0.6, 100, 1}}, 1, true);
  CHECK(two.velocity(1) == Approx(0).margin(1e-15));
  CHECK(LayeredFlow({{1, 2, 3}}, 0.5, false).velocity(1) == Approx(3 * 0.5 / 4));
}

TEST_CASE("Poiseuille flow: second order, from the wall's half cell alone") {
  std::vector<double> errors;
  for (int n : {8, 16, 32, 64}) errors.push_back(error_of({{1, 1, 1}}, n));
  figure("Poiseuille: %s orders %s", listed(errors).c_str(), listed(orders(errors)).c_str());
  expect_order(errors, 2.0, 0.05);
  // rho g h^2 / (8 eta) everywhere, over the fastest rho g / (8 eta)
  CHECK(errors.back() == Approx(1.0 / (64 * 64)).epsilon(0.01));
}

TEST_CASE("two-layer Poiseuille flow up to contrast 1e8: second order where the interface is a grid line") {
  for (double contrast : {1e2, 1e4, 1e6, 1e8})
    for (bool stiff_above : {true, false}) {
      const Layer soft{0.5, 1, 1}, stiff{0.5, contrast, 1};
      const std::vector<Layer> layers = stiff_above ? std::vector{soft, stiff} : std::vector{stiff, soft};
      std::vector<double> errors;
      for (int n : {16, 32, 64}) errors.push_back(error_of(layers, n));
      INFO("contrast " << contrast << (stiff_above ? ", stiff above" : ", stiff below"));
      figure("two-layer Poiseuille, contrast %.0e, stiff %s: %s orders %s", contrast,
             stiff_above ? "above" : "below", listed(errors).c_str(), listed(orders(errors)).c_str());
      expect_order(errors, 2.0, 0.1);
      CHECK(errors.back() < 1e-3);
    }
}

TEST_CASE("two-layer Poiseuille flow with the interface inside of cells: first order") {
  const double contrast = 1e4;
  std::vector<double> harmonic, arithmetic;
  for (int n : {16, 32, 64, 128}) {
    const double below = 0.5 + 0.25 / n;  // in the same place of its cell on every grid
    const std::vector<Layer> layers{{below, 1, 1}, {1 - below, contrast, 1}};
    harmonic.push_back(error_of(layers, n));
    arithmetic.push_back(error_of(layers, n, CornerMean::arithmetic));
  }
  figure("two-layer Poiseuille, interface inside of cells: harmonic %s orders %s; arithmetic %s orders %s",
         listed(harmonic).c_str(), listed(orders(harmonic)).c_str(), listed(arithmetic).c_str(),
         listed(orders(arithmetic)).c_str());
  expect_order(harmonic, 1.0, 0.15);
  CHECK(harmonic.back() < 0.02);
}
