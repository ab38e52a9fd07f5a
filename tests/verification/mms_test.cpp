// Manufactured solution of the implicit viscous solve, rho u - dt div(2 eta D(u)) = rho u*, between no-slip walls on
// [0, 2 pi]^2: u = sin^2 x sin 2y, v = -sin 2x sin^2 y, eta = exp(B sin x sin y) with eta_max / eta_min = exp(2 B) = 1e4.
#include "solver/boundary_of.hpp"
#include "solver/viscous_solve.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

const double B = 0.5 * std::log(1e4);
constexpr double pi = 3.14159265358979323846, rho = 0.8, dt = 0.5;

double eta(double x, double y) { return std::exp(B * std::sin(x) * std::sin(y)); }
double u(double x, double y) { return std::sin(x) * std::sin(x) * std::sin(2 * y); }
double v(double x, double y) { return -std::sin(2 * x) * std::sin(y) * std::sin(y); }

// 2 D:  (2 a, s; s, -2 a)
double a(double x, double y) { return std::sin(2 * x) * std::sin(2 * y); }
double s(double x, double y) {
  return 2 * (std::sin(x) * std::sin(x) * std::cos(2 * y) - std::cos(2 * x) * std::sin(y) * std::sin(y));
}
double eta_x(double x, double y) { return B * std::cos(x) * std::sin(y) * eta(x, y); }
double eta_y(double x, double y) { return B * std::sin(x) * std::cos(y) * eta(x, y); }
double force_x(double x, double y) {
  const double s_y = -4 * std::sin(x) * std::sin(x) * std::sin(2 * y) - 2 * std::cos(2 * x) * std::sin(2 * y);
  return 2 * eta_x(x, y) * a(x, y) + 4 * eta(x, y) * std::cos(2 * x) * std::sin(2 * y) +
         eta_y(x, y) * s(x, y) + eta(x, y) * s_y;
}
double force_y(double x, double y) {
  const double s_x = 2 * std::sin(2 * x) * std::cos(2 * y) + 4 * std::sin(2 * x) * std::sin(y) * std::sin(y);
  return eta_x(x, y) * s(x, y) + eta(x, y) * s_x - 2 * eta_y(x, y) * a(x, y) -
         4 * eta(x, y) * std::sin(2 * x) * std::cos(2 * y);
}

template <class T>
double error_of(int n, bool harmonic) {
  Scene scene = newtonian(2 * pi, 2 * pi, n, {1});
  scene.walls = {Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::no_slip};
  const Patch p = scene.patch();
  CellField viscosity(p), density(p, rho);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) viscosity(i, j) = eta(p.x_centre(i), p.y_centre(j));
  Velocity star(p), w(p);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = p.x_corner(i), y = p.y_centre(j);
      star.u(i, j) = u(x, y) - dt / rho * force_x(x, y);
    }
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = p.x_centre(i), y = p.y_corner(j);
      star.v(i, j) = v(x, y) - dt / rho * force_y(x, y);
    }
  ViscousSolve<T> solve(p, boundary_of(scene));
  Team alone;
  solve.assemble(alone, viscosity, harmonic, density, dt);
  const SolveStats stats = solve.solve(alone, star, w, 1e-9, 0, 200);
  CHECK(stats.converged);
  double error = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      error += std::pow(w.u(i, j) - u(p.x_corner(i), p.y_centre(j)), 2) +
               std::pow(w.v(i, j) - v(p.x_centre(i), p.y_corner(j)), 2);
  return std::sqrt(error) * p.h / (2 * pi);
}

}  // namespace

TEST_CASE("manufactured solution with viscosities over 1e4 : 1: second order, either corner mean") {
  for (bool harmonic : {true, false}) {
    std::vector<double> errors;
    for (int n : {32, 64, 128, 256}) errors.push_back(error_of<double>(n, harmonic));
    INFO((harmonic ? "harmonic" : "arithmetic"));
    figure("manufactured solution, %s: %s orders %s", harmonic ? "harmonic" : "arithmetic",
           listed(errors).c_str(), listed(orders(errors)).c_str());
    expect_order(errors, 2.0, 0.1);
    CHECK(error_of<float>(128, harmonic) ==
          Approx(errors[2]).epsilon(1e-5));  // mixed precision: the same answer
  }
}
