// The decaying vortex of Taylor & Green 1937 in a box with free-slip walls, [0, pi]^2:
//   u = sin x cos y e, v = -cos x sin y e, p = rho/4 (cos 2x + cos 2y) e^2 with e = exp(-2 eta t / rho).
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

constexpr double pi = 3.14159265358979323846, eta = 0.1;

Scene box(int n, double dt) {
  Scene s = newtonian(pi, pi, n, {eta});
  s.walls = {Wall::free_slip, Wall::free_slip, Wall::free_slip, Wall::free_slip};
  s.time.dt_max = dt;
  return s;
}

void start_vortex(Fields& f, int n) {
  const Patch& p = f.patch();
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= n; ++i) f.u(i, j) = std::sin(p.x_corner(i)) * std::cos(p.y_centre(j));
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < n; ++i) f.v(i, j) = -std::cos(p.x_centre(i)) * std::sin(p.y_corner(j));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      f.p(i, j) = 0.25 * (std::cos(2 * p.x_centre(i)) + std::cos(2 * p.y_centre(j)));
}

struct Errors {
  double velocity, pressure;  // L2
};

Errors errors_at(double end, int n, double dt) {
  Simulation simulation(box(n, dt));
  start_vortex(simulation.fields(), n);
  while (simulation.t() < end) simulation.step(end);
  const Fields& f = simulation.fields();
  const Patch& p = f.patch();
  const double decay = std::exp(-2 * eta * end);
  double velocity = 0, pressure = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double u = std::sin(p.x_corner(i)) * std::cos(p.y_centre(j)) * decay;
      const double v = -std::cos(p.x_centre(i)) * std::sin(p.y_corner(j)) * decay;
      const double q = 0.25 * (std::cos(2 * p.x_centre(i)) + std::cos(2 * p.y_centre(j))) * decay * decay;
      velocity += std::pow(f.u(i, j) - u, 2) + std::pow(f.v(i, j) - v, 2);
      pressure += std::pow(f.p(i, j) - q, 2);
    }
  return {std::sqrt(velocity) * p.h / pi, std::sqrt(pressure) * p.h / pi};
}

}  // namespace

TEST_CASE("Taylor-Green vortex: second order in space") {
  std::vector<double> velocity, pressure;
  for (int n : {16, 32, 64}) {
    const Errors e = errors_at(0.5, n, 0.04 * std::pow(16.0 / n, 2));
    velocity.push_back(e.velocity);
    pressure.push_back(e.pressure);
  }
  figure("Taylor-Green, space: velocity %s orders %s; pressure %s orders %s", listed(velocity).c_str(),
         listed(orders(velocity)).c_str(), listed(pressure).c_str(), listed(orders(pressure)).c_str());
  expect_order(velocity, 2.0, 0.15);
  CHECK(velocity.back() < 1e-3);
}

TEST_CASE("Taylor-Green vortex: first order in time") {
  std::vector<double> velocity;
  for (double dt : {0.04, 0.02, 0.01, 0.005}) velocity.push_back(errors_at(0.8, 32, dt).velocity);
  // What is left at dt -> 0 is the grid's error; differences of successive solutions do not see it.
  std::vector<double> differences;
  for (std::size_t k = 1; k < velocity.size(); ++k)
    differences.push_back(std::abs(velocity[k - 1] - velocity[k]));
  figure("Taylor-Green, time: velocity %s orders of the differences %s", listed(velocity).c_str(),
         listed(orders(differences)).c_str());
  expect_order(differences, 1.0, 0.2);
}
