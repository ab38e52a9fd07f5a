// Advection of momentum: consistent with the transport of mass, second order where that is smooth.
#include "kernels/momentum.hpp"

#include <catch2/catch.hpp>

#include "tests/support/boundaries.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/random_fields.hpp"

using namespace hourglass;

namespace {

/// Both components of Σ M (u_face - u) on every face. Not inlined: GCC 12 then imagines ny near 2^31 and warns.
[[gnu::noinline]] Velocity advected(const Velocity& w, const MassTransport& mass, double dt_h) {
  const int nx = w.patch().nx, ny = w.patch().ny;
  Velocity out(w.patch());
  std::vector<double> scratch(MomentumAdvection<At::xface>::scratch_size(nx + 1));
  MomentumAdvection<At::xface> of_u(w.u, w.v, mass, dt_h, 0, scratch.data());
  for (int j = 0; j < ny; ++j) of_u.next(out.u.row(j));
  // In two parts, as two threads would.
  for (const auto& [first, last] : {std::pair{0, ny / 3}, {ny / 3, ny + 1}}) {
    MomentumAdvection<At::yface> of_v(w.u, w.v, mass, dt_h, first, scratch.data());
    for (int j = first; j < last; ++j) of_v.next(out.v.row(j));
  }
  return out;
}

double largest(const Velocity& w) {
  double m = 0;
  for (int k = 0; k < row_count(w); ++k)
    for (int i = 0; i < row_of(w, k).n; ++i) m = std::max(m, std::abs(row_of(w, k).data[i]));
  return m;
}

}  // namespace

TEST_CASE("monotonised-central slopes: a table") {
  CHECK(limited(1, 1) == 1);
  CHECK(limited(1, 2) == 1.5);
  CHECK(limited(1, 9) == 2);  // twice the smaller
  CHECK(limited(-9, -1) == -2);
  CHECK(limited(3, -1) == 0);  // an extremum
  CHECK(limited(0, 5) == 0);
}

TEST_CASE("a uniform velocity stays uniform whatever mass goes through the faces") {
  Noise noise;
  const Patch p{13, 11, 0.5, 0, 0};
  for (const auto& [name, boundary] : all_kinds_of_boundaries(p.nx, p.ny)) {
    INFO(name);
    MassTransport mass(p);
    fill_random(mass.x, noise, -1000, 1000);  // a jump of density 1000 : 1 in full motion
    fill_random(mass.y, noise, -1, 1);
    for (int j = 0; j < p.ny; ++j)
      for (int i = 0; i < p.nx; ++i) mass.uniform(i, j) = noise() > 0 ? 1.0f : 0.0f;
    Velocity w(p);
    w.u.fill(0.7);  // halos too: what lies outside moves along
    w.v.fill(-1.3);
    CHECK(largest(advected(w, mass, 0.3)) == 0);
  }
}

TEST_CASE("advection of smooth velocity at uniform density is second order") {
  std::vector<double> errors;
  for (int n : {16, 32, 64, 128}) {
    const Patch p{n, n, 1.0 / n, 0, 0};
    // Solenoidal, and monotone in both directions: limiters rest, also where a component changes sign.
    const auto u = [](double x, double y) { return std::exp(x) + 0.3 * std::exp(0.5 * y) - 2; };
    const auto v = [](double x, double y) { return -y * std::exp(x) + 0.5 * std::exp(0.7 * x); };
    Velocity w(p);
    for (int j = -2; j < n + 2; ++j)
      for (int i = -2; i < n + 3; ++i) w.u(i, j) = u(p.x_corner(i), p.y_centre(j));
    for (int j = -2; j < n + 3; ++j)
      for (int i = -2; i < n + 2; ++i) w.v(i, j) = v(p.x_centre(i), p.y_corner(j));
    const double rho = 2, dt_h = 1e-6;  // a vanishing Courant number: the instantaneous tendency
    MassTransport mass(p);
    mass.uniform.fill(1);
    for (int j = 0; j < n; ++j)
      for (int i = -1; i <= n; ++i) mass.x(i, j) = rho * dt_h * w.u(i, j);
    for (int j = 0; j <= n; ++j)
      for (int i = -1; i <= n; ++i) mass.y(i, j) = rho * dt_h * w.v(i, j);
    const Velocity a = advected(w, mass, dt_h);
    double error = 0;
    for (int j = 2; j < n - 2; ++j)
      for (int i = 2; i < n - 2; ++i) {
        const double x = p.x_corner(i), y = p.y_centre(j), xv = p.x_centre(i), yv = p.y_corner(j);
        const double exact_u = u(x, y) * std::exp(x) + v(x, y) * 0.15 * std::exp(0.5 * y);
        const double dxv = -yv * std::exp(xv) + 0.35 * std::exp(0.7 * xv);
        const double exact_v = u(xv, yv) * dxv + v(xv, yv) * -std::exp(xv);
        const double scale = rho * dt_h * p.h;
        error += std::pow(a.u(i, j) / scale - exact_u, 2) + std::pow(a.v(i, j) / scale - exact_v, 2);
      }
    errors.push_back(std::sqrt(error) / n);
  }
  expect_order(errors, 2.0, 0.15);
}

TEST_CASE("advection across a jump of density is upwind: no new extrema") {
  Noise noise;
  const int n = 24;
  const Patch p{n, 6, 1, 0, 0};
  MassTransport mass(p);
  mass.uniform.fill(0);
  Velocity w(p);
  fill_random(w.u, noise);
  for (int j = 0; j < p.ny; ++j)
    for (int i = 0; i <= n; ++i) mass.x(i, j) = 0.25;
  const Velocity a = advected(w, mass, 0.25);
  for (int j = 0; j < p.ny; ++j)
    for (int i = 1; i < n; ++i) CHECK(a.u(i, j) == Approx(0.25 * (w.u(i, j) - w.u(i - 1, j))).margin(1e-15));
}

TEST_CASE("the flag of uniform density sees one cell each way") {
  const Patch p{9, 7, 1, 0, 0};
  CellField density(p, 1.0);
  density(4, 3) = 1.02;
  CellFieldOf<float> flag(p);
  for (int j = 0; j < p.ny; ++j) uniform_density_row(density, j, flag.row(j));
  for (int j = 0; j < p.ny; ++j)
    for (int i = 0; i < p.nx; ++i)
      CHECK(flag(i, j) == (std::abs(i - 4) <= 1 && std::abs(j - 3) <= 1 ? 0.0f : 1.0f));
}
