// Scenes that are images of each other have flows that are images of each other; threads change nothing.
#include <catch2/catch.hpp>
#include <cstring>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

void run(Simulation& simulation, int steps) {
  for (int n = 0; n < steps; ++n) {
    const StepReport report = simulation.step();
    REQUIRE(report.viscous.converged);
    REQUIRE(report.pressure.converged);
  }
}

/// L1 difference of v and its mirror image in `b`, over the L1 norm of v.
double asymmetry(const Simulation& a, const Simulation& b) {
  const YFaceField &v = a.fields().v, &w = b.fields().v;
  double difference = 0, size = 0;
  for (int j = 0; j < v.ny(); ++j)
    for (int i = 0; i < v.nx(); ++i) {
      difference += std::abs(v(i, j) - w(v.nx() - 1 - i, j));
      size += std::abs(v(i, j));
    }
  return difference / size;
}

template <class F>
bool same_bits(const F& a, const F& b) {
  for (int j = 0; j < a.ny(); ++j)
    if (std::memcmp(a.row(j), b.row(j), sizeof(typename F::value_type) * a.nx()) != 0) return false;
  return true;
}

}  // namespace

TEST_CASE("a scene turned by a quarter has a flow turned by a quarter") {
  // All air: no free surface, whose directional sweeps know x from y. One fluid falls through an orifice off the middle.
  Scene down;
  down.width = down.height = 32;
  down.cells_x = 32;
  down.air = {1, 2};
  down.threads = 1;
  down.accuracy.viscous_tolerance = 1e-10;
  down.accuracy.pressure_tolerance = 1e-11;
  down.accuracy.precision = Precision::full;
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
