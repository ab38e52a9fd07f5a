// Two-layer Couette flow, up to contrast 1e8. Scenes have no moving lid, so a heavy layer on top drives: gravity along x pulls
// it, and the two light layers below (density 1e-9) carry its weight down as a constant stress tau = rho g h_lid. Exact:
// u = tau y / eta_1 in the lowest, then tau (h_1 / eta_1 + (y - h_1) / eta_2).
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/layered_flow.hpp"

using namespace hourglass;

namespace {

constexpr double gravity = 1e-8;

/// Largest error in the two light layers, relative to the fastest velocity there.
double error_of(double contrast, double interface_at, bool stiff_above, int cells) {
  const Layer soft{stiff_above ? interface_at : 0.75 - interface_at, 1, 1e-9};
  const Layer stiff{0.75 - soft.thickness, contrast, 1e-9};
  const Layer lid{0.25, 1, 1};
  const std::vector<Layer> layers =
      stiff_above ? std::vector{soft, stiff, lid} : std::vector{stiff, soft, lid};
  Simulation simulation(layered_scene(layers, gravity, false, cells));
  run_to_steady(simulation, 1e-12, 60);
  const LayeredFlow exact(layers, gravity, false);
  const Patch& p = simulation.fields().patch();
  double error = 0;
  for (int j = 0; p.y_centre(j) < 0.75; ++j)
    error = std::max(error, std::abs(simulation.fields().u(1, j) - exact.velocity(p.y_centre(j))));
  return error / exact.velocity(0.75);
}

}  // namespace

TEST_CASE("two-layer Couette flow up to contrast 1e8 is exact where the interface is a grid line") {
  double worst = 0;
  for (double contrast : {1.0, 1e2, 1e4, 1e6, 1e8})
    for (bool stiff_above : {true, false})
      for (int n : {16, 32}) {
        const double error = error_of(contrast, 0.375, stiff_above, n);
        INFO("contrast " << contrast << ", " << n << " cells, stiff " << (stiff_above ? "above" : "below"));
        CHECK(error < 1e-7);
        worst = std::max(worst, error);
      }
  figure("two-layer Couette, aligned: worst relative error %.1e", worst);
}

TEST_CASE("two-layer Couette flow with the interface inside of cells: first order") {
  std::vector<double> errors;
  for (int n : {16, 32, 64, 128}) errors.push_back(error_of(1e4, 0.375 + 0.25 / n, true, n));
  figure("two-layer Couette, interface inside of cells: %s orders %s", listed(errors).c_str(),
         listed(orders(errors)).c_str());
  expect_order(errors, 1.0, 0.15);
  CHECK(errors.back() < 0.01);
}
