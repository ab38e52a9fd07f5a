// Annular Couette flow of mu(I) at constant pressure: rheology and viscous solve alone, on a flow whose shear is along no
// direction of the grid.
#include "solver/boundary_of.hpp"
#include "solver/rheology.hpp"
#include "solver/viscous_solve.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

// Torque makes the stress fall as tau / P = s / r^2; grains yield up to r_c = sqrt(s / mu_s). P = rho = 1.
constexpr double mu_s = 0.32, delta_mu = 0.28, mu_2 = mu_s + delta_mu, I_0 = 0.4, d = 0.25;
constexpr double r_in = 0.6, r_out = 0.9, s = 0.5 * r_in * r_in;
double speed(double r) {
  const double r_c = std::sqrt(s / mu_s);
  if (r >= r_c) return 0;
  r = std::max(r, 0.95 * r_in);  // goes on smoothly within the inner wall, to where the stress would be mu_2
  return r * I_0 / d *
         (delta_mu / (2 * mu_2) * std::log(s * delta_mu / (mu_s * (mu_2 * r * r - s))) - std::log(r_c / r));
}

/// L2 error over the speed of the inner wall, of a quarter of the annulus about the corner of the unit square.
double error_of(int n) {
  Scene scene;
  scene.width = scene.height = 1;
  scene.cells_x = n;
  scene.materials = {well_posed_grains()};
  scene.materials[0].diameter = d;
  scene.walls = {Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::no_slip};
  scene.rheology.eta_min = 1e-6;
  scene.rheology.eta_max = 1e4;
  scene.rheology.smoothing_length = 0;
  scene.rheology.background_pressure = 1;
  const Patch patch = scene.patch();
  const Boundary boundary = boundary_of(scene);
  RheologyStage rheology(scene, patch, boundary);
  ViscousSolve<double> viscous(patch, boundary);
  Fields fields(patch, 1);
  fields.grains.fill(1);
  // Cells beyond the annulus, and some along its cuts, are too heavy to leave the exact velocity.
  CellField density(patch), eta(patch);
  const double margin = 0.1;
  const auto held = [&](double x, double y) {
    const double r = std::hypot(x, y);
    return r < r_in || r > r_out || x < margin || y < margin;
  };
  for (int j = -halo; j < n + halo; ++j)
    for (int i = -halo; i < n + halo; ++i)
      density(i, j) = held(patch.x_centre(i), patch.y_centre(j)) ? 1e10 : 1e-6;
  Velocity exact(patch);
  const auto set = [&](double x, double y, bool along_x) {
    const double r = std::max(std::hypot(x, y), 1e-12);
    return speed(r) * (along_x ? -y : x) / r;
  };
  for (int j = 0; j < n; ++j)
    for (int i = 1; i < n; ++i) exact.u(i, j) = set(patch.x_corner(i), patch.y_centre(j), true);
  for (int j = 1; j < n; ++j)
    for (int i = 0; i < n; ++i) exact.v(i, j) = set(patch.x_centre(i), patch.y_corner(j), false);
  fields.u = exact.u;
  fields.v = exact.v;
  double change = 1;
  int rounds = 0;
  for (; change > 1e-5 && rounds < 400; ++rounds) {
    fill_velocity_halo(boundary, fields.u, fields.v);
    rheology.update(fields, 1, eta, {});
    Team alone;
    viscous.assemble(alone, eta, true, density, 1);
    Velocity star = exact, x = fields;
    clear_halo(alone, x);
    viscous.solve(alone, star, x, 1e-12, 0, 200);
    change = 0;
    for (int k = 0; k < row_count(x); ++k)
      for (int i = 0; i < row_of(x, k).n; ++i)
        change = std::max(change,
                          std::abs(row_of(x, k).data[i] - row_of(static_cast<Velocity&>(fields), k).data[i]));
    change /= speed(r_in);
    fields.u = x.u;
    fields.v = x.v;
  }
  CHECK(change <= 1e-5);
  double sum = 0, slip = 0;
  long count = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 1; i < n; ++i) {
      if (held(patch.x_corner(i), patch.y_centre(j))) continue;
      const double error = fields.u(i, j) - exact.u(i, j);
      sum += error * error;
      slip = std::max(slip, std::abs(error));
      ++count;
    }
  figure("annular Couette, %d^2: inner speed %.4f, L2 %.2e, largest %.2e, %d rounds", n, speed(r_in),
         std::sqrt(sum / count) / speed(r_in), slip / speed(r_in), rounds);
  return std::sqrt(sum / count) / speed(r_in);
}

}  // namespace

TEST_CASE("annular Couette flow of mu(I): the speed of the exact solution obeys its law") {
  // |γ̇| = -r d(v/r)/dr has mu(I) = s / r^2.
  const Grain grain{mu_s, delta_mu, I_0, d, 1, 0};
  for (double r : {0.6, 0.65, 0.7, 0.74}) {
    const double h = 1e-5, rate = -r * (speed(r + h) / (r + h) - speed(r - h) / (r - h)) / (2 * h);
    CHECK(mu_of_I(inertial_number(rate, 1, grain), grain) == Approx(s / (r * r)).epsilon(1e-6));
  }
}

// The edge of the yielded ring at r_c is that of the plug of a chute (bagnold_test.cpp): order 4/3.
TEST_CASE("annular Couette flow of mu(I): order 4/3, from the edge of the yielded ring") {
  std::vector<double> errors;
  for (int n : {32, 64, 128}) errors.push_back(error_of(n));
  figure("annular Couette: L2 %s orders %s", listed(errors).c_str(), listed(orders(errors)).c_str());
  CHECK(orders(errors).back() > 1.2);
  CHECK(errors.back() < 5e-3);
}
