// Nonlocal fluidity in the whole engine: channel flows under a known stress ratio, against their ordinary differential
// equation; and silos.
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/granular_channel.hpp"

using namespace hourglass;

namespace {

constexpr double W = 0.5, d = 0.1, A = 0.5;  // P = rho = g = 1
constexpr double mu_s = 0.32, delta_mu = 0.28, I_0 = 0.4, mu_2 = mu_s + delta_mu;

/// Half a channel from the wall at rest, y = 0, to the centre line; gravity along it. The stress ratio is m = W - y.
Scene half_channel(int cells, Closure closure, FluidityWall walls) {
  Scene s = granular_channel(W, cells, {1, 0}, d, Wall::free_slip);
  s.nonlocal = Nonlocal{.A = A, .closure = closure, .walls = walls};
  s.rheology.eta_max = 1e7;
  s.rheology.background_pressure = 1;
  s.accuracy.viscous_tolerance = 1e-8;
  s.accuracy.fluidity_tolerance = 1e-9;
  return s;
}

/// The exact flow on n fine cells: g'' = c (g - local) with |γ̇| = m g, by three-point differences and repetition.
struct Reference {
  std::vector<double> g, u;  ///< fluidity and velocity at cell centres
  Reference(int n, Closure closure, FluidityWall walls) : g(n, 1), u(n) {
    const double h = W / n, end = walls == FluidityWall::zero ? 2 : 0;
    std::vector<double> diagonal(n), right(n);
    for (double change = 1; change > 1e-12;) {
      for (int j = 0; j < n; ++j) {
        const double m = W - (j + 0.5) * h;
        double c = 0, source = 0;
        if (closure == Closure::kamrin) {
          c = delta_mu * std::abs(m - mu_s) / ((mu_2 - m) * A * A * d * d);
          source = m > mu_s ? c * I_0 / d * (m - mu_s) / (m * (mu_2 - m)) : 0;
        } else {
          const double rate = m * g[j], I = rate * d;
          c = delta_mu * I / (I_0 * A * A * d * d);
          source = c * rate / (mu_s + delta_mu * I / (I_0 + I));
        }
        diagonal[j] = h * h * c + (j == 0 ? end : 1) + (j == n - 1 ? end : 1);
        right[j] = h * h * source;
      }
      for (int j = 1; j < n; ++j) {
        diagonal[j] -= 1 / diagonal[j - 1];
        right[j] += right[j - 1] / diagonal[j - 1];
      }
      change = 0;
      double above = 0;
      for (int j = n - 1; j >= 0; --j) {
        above = (right[j] + above) / diagonal[j];
        change = std::max(change, std::abs(above / g[j] - 1));
        g[j] = above;
      }
      if (closure == Closure::kamrin) break;
    }
    double speed = 0;
    for (int j = 0; j < n; ++j) {
      const double step = (W - (j + 0.5) * h) * g[j] * h;
      u[j] = speed + 0.5 * step;
      speed += step;
    }
  }
  static double at(const std::vector<double>& f, double y) {  // linear between centres
    const double n = static_cast<double>(f.size()), x = std::clamp(y / W * n - 0.5, 0.0, n - 1.001);
    const int j = static_cast<int>(x);
    return f[j] + (x - j) * (f[j + 1] - f[j]);
  }
};

struct Errors {
  std::vector<double> u, g;  ///< largest, over the largest of the exact ones
};
/// From the exact flow, to the steady flow of the grid.
Errors channel_errors(Closure closure, FluidityWall walls, const std::vector<int>& grids) {
  const Reference exact(4096, closure, walls);
  const double fastest = exact.u.back(), most = *std::max_element(exact.g.begin(), exact.g.end());
  Errors errors;
  for (int n : grids) {
    Simulation simulation(half_channel(n, closure, walls));
    Fields& f = simulation.fields();
    start(f, [&](double y) { return Reference::at(exact.u, y); });
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < 4; ++i) f.fluidity(i, j) = Reference::at(exact.g, f.patch().y_centre(j));
    while (simulation.t() < 20) simulation.step(20);
    double u = 0, g = 0;
    for (int j = 0; j < n; ++j) {
      const double y = f.patch().y_centre(j);
      u = std::max(u, std::abs(f.u(1, j) - Reference::at(exact.u, y)));
      g = std::max(g, std::abs(f.fluidity(1, j) - Reference::at(exact.g, y)));
    }
    errors.u.push_back(u / fastest);
    errors.g.push_back(g / most);
  }
  figure("nonlocal channel, %s, %s: speed %.4f, g %.3g to %.3g; u %s orders %s; g %s orders %s",
         closure_names[static_cast<int>(closure)], fluidity_wall_names[static_cast<int>(walls)], fastest,
         exact.g.front(), exact.g.back(), listed(errors.u).c_str(), listed(orders(errors.u)).c_str(),
         listed(errors.g).c_str(), listed(orders(errors.g)).c_str());
  return errors;
}

}  // namespace

TEST_CASE(
    "nonlocal channel flow, no flux through walls: velocity and fluidity obey their equation, second order") {
  for (Closure closure : {Closure::thesis, Closure::kamrin}) {
    const Errors errors = channel_errors(closure, FluidityWall::no_flux, {16, 32, 64});
    CHECK(orders(errors.u).back() > 1.8);
    CHECK(orders(errors.g).back() > 1.8);
    CHECK(errors.u.back() < 0.01);
  }
}

// Closure kamrin divides |γ̇| of a cell, a mean over its corners, by g of the cell: where g falls to 0 at a wall within half a
// cell, the stress ratio of that one cell is half as large again as it is, whatever the grid. First order, from below.
TEST_CASE("nonlocal channel flow, closure kamrin, zero at walls: first order, from the cell at the wall",
          "[slow]") {
  const Errors errors = channel_errors(Closure::kamrin, FluidityWall::zero, {32, 64, 128});
  CHECK(orders(errors.u).back() > 0.6);
  CHECK(orders(errors.g).back() > 0.7);
  CHECK(errors.u.back() < 0.1);
}

TEST_CASE("nonlocal with amplitude next to none is the local law") {
  Scene scene = silo(64, 20);
  const double local = Simulation(scene).run().discharge_rate;
  scene.nonlocal = Nonlocal{.A = 1e-6};
  scene.accuracy.fluidity_tolerance = 1e-6;
  const double next_to = Simulation(scene).run().discharge_rate;
  figure("silo 64^2: rate %.4f, with A = 1e-6 %.4f", local, next_to);
  CHECK(next_to == Approx(local).epsilon(1e-3));
}

TEST_CASE("nonlocal silo: tolerances met, mass kept, the default tolerance does no harm to the rate",
          "[slow]") {
  for (Closure closure : {Closure::thesis, Closure::kamrin})
    for (FluidityWall walls : {FluidityWall::zero, FluidityWall::no_flux}) {
      Scene scene = silo(64, 27.386);
      scene.nonlocal = Nonlocal{.A = A, .closure = closure, .walls = walls};
      const Summary quick = Simulation(scene).run();
      scene.accuracy.fluidity_tolerance = 1e-5;
      const Summary tight = Simulation(scene).run();
      figure("nonlocal silo 64^2, %s, %s: rate %.3f, tight %.3f; mass error %.1e, missed %ld",
             closure_names[static_cast<int>(closure)], fluidity_wall_names[static_cast<int>(walls)],
             quick.discharge_rate, tight.discharge_rate, quick.mass_error, quick.missed_tolerances);
      CHECK(quick.missed_tolerances == 0);
      CHECK(quick.mass_error < 1e-6);
      // Closure kamrin is noisy where xi is below a cell (docs/verification.md), as it is on this grid.
      const double allowed = closure == Closure::thesis ? 2e-3 : 1.5e-2;
      CHECK(quick.discharge_rate == Approx(tight.discharge_rate).epsilon(allowed));
    }
}
