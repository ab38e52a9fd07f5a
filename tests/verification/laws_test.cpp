// Exact flows of the other laws: Bagnold flow of regularised friction, the vertical chute and a block of cohesive grains.
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/granular_channel.hpp"

using namespace hourglass;

namespace {

constexpr double d = 0.25;
Scene channel(double height, int cells, std::array<double, 2> gravity, Wall top) {
  Scene s = granular_channel(height, cells, gravity, d, top);
  s.rheology.corner_mean = CornerMean::arithmetic;
  return s;
}

/// I at which the law of the scene has this friction.
double inertial_number_of(double mu, const Scene& s) {
  const RegularisedFriction law = *regularised_friction(s.materials[0], s.rheology);
  const Grain g = grain_of(s.materials[0]);
  double low = 1e-9, high = 1e3;
  for (int k = 0; k < 200; ++k) {
    const double middle = std::sqrt(low * high);
    (law.mu(middle, g) < mu ? low : high) = middle;
  }
  return low;
}

// Vertical chute at constant P with static friction mu_s, which cohesion c raises by c / P (see bagnold_test.cpp).
// P = rho = a = 1.
double chute(double x, double half_width, double mu_s) {
  const double delta_mu = 0.28, mu_2 = mu_s + delta_mu, outside = std::max(x, mu_s);
  return 0.4 / d * (-(half_width - outside) + delta_mu * std::log((mu_2 - outside) / (mu_2 - half_width)));
}

}  // namespace

// tan alpha = mu(I_alpha): the same form as with mu(I), on the branch of mu(I) and on that of the logarithm.
TEST_CASE("Bagnold flow of regularised friction, on both branches: second order where mu depends on I") {
  for (double alpha : {0.40, 0.30}) {
    std::vector<double> errors, mean_errors;
    double I = 0, I_1 = 0;
    for (int n : {16, 32, 64}) {
      Scene scene = channel(1, n, {std::sin(alpha), -std::cos(alpha)}, Wall::open);
      scene.rheology.law = Law::mu_I_regularised;
      I = inertial_number_of(std::tan(alpha), scene);
      I_1 = regularised_friction(scene.materials[0], scene.rheology)->I_1;
      const auto exact = [&](double y) {
        return 2.0 / 3 * I / d * std::sqrt(std::cos(alpha)) * (1 - std::pow(1 - y, 1.5));
      };
      Simulation simulation(scene);
      Fields& f = simulation.fields();
      start(f, exact);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < 4; ++i) f.p(i, j) = std::cos(alpha) * (1 - f.patch().y_centre(j));
      while (simulation.t() < 40) simulation.step(40);
      double l2 = 0, mean = 0;
      for (int j = 0; j < n; ++j) {
        const double error = f.u(1, j) - exact(f.patch().y_centre(j));
        l2 += error * error / n;
        mean += f.u(1, j) / n;
      }
      errors.push_back(std::sqrt(l2) / exact(1));
      const double flux = 2.0 / 5 * I / d * std::sqrt(std::cos(alpha));  // the mean of the exact profile
      mean_errors.push_back(std::abs(mean / flux - 1));
    }
    figure("Bagnold, regularised, alpha %.2f, I %.5f, I_1 %.5f: L2 %s orders %s; mean %s orders %s", alpha, I,
           I_1, listed(errors).c_str(), listed(orders(errors)).c_str(), listed(mean_errors).c_str(),
           listed(orders(mean_errors)).c_str());
    CHECK((alpha > 0.35 ? I > I_1 : I < I_1));
    // On the branch of the logarithm friction hardly depends on I, nu = dln mu / dln I = mu^2 / (2 alpha) = 0.025: what the grid
    // does to the stress near the surface comes back as 1 / nu times that in I. nu = 0, a plug, would be of order 4/3.
    const double order = alpha > 0.35 ? 1.8 : 1.5;
    CHECK(orders(errors).back() > order);
    CHECK(orders(mean_errors).back() > order);
    CHECK(errors.back() < 2e-3);
  }
}

TEST_CASE("vertical chute of cohesive grains: cohesion c is static friction c / P") {
  const double W = 0.5;
  std::vector<double> errors;
  double off = 0;
  for (int n : {16, 32, 64, 128}) {
    const auto run = [&](double mu_s, double cohesion) {
      Scene s = channel(W, n, {1, 0}, Wall::free_slip);
      s.rheology.corner_mean = CornerMean::harmonic;
      s.rheology.background_pressure = 1;
      s.materials[0].mu_s = mu_s;
      s.materials[0].cohesion = cohesion;
      Simulation simulation(s);
      start(simulation.fields(), [&](double y) { return chute(W - y, W, 0.32); });
      while (simulation.t() < 10) simulation.step(10);
      std::vector<double> u;
      for (int j = 0; j < n; ++j) u.push_back(simulation.fields().u(1, j));
      return u;
    };
    const std::vector<double> cohesive = run(0.12, 0.2), frictional = run(0.32, 0);
    double l2 = 0;
    for (int j = 0; j < n; ++j) {
      l2 += std::pow(cohesive[j] - chute(W - (j + 0.5) * W / n, W, 0.32), 2) / n;
      off = std::max(off, std::abs(cohesive[j] / frictional[j] - 1));
    }
    errors.push_back(std::sqrt(l2));
    if (n == 128) {
      // The plug: half width (mu_s P + c) / (rho a) = 0.32, to a few cells of its Airy layer.
      double plug = 0;
      for (int j = 0; j < n; ++j)
        if (cohesive[j] > (1 - 1e-3) * cohesive[n - 1]) plug += W / n;
      figure("cohesive chute: plug half width %.4f, exact 0.32 of 0.5", plug);
      CHECK(plug == Approx(0.32).margin(0.02));
      CHECK(cohesive[n - 1] == Approx(chute(0, W, 0.32)).epsilon(5e-3));
    }
  }
  figure("cohesive chute: L2 %s orders %s; from that of friction alone by %.1e", listed(errors).c_str(),
         listed(orders(errors)).c_str(), off);
  expect_order(errors, 4.0 / 3, 0.15);  // as without cohesion
  CHECK(off < 1e-5);
}

TEST_CASE("cohesion is the same with every module that makes the viscosity in its own way") {
  const auto run = [](auto&& set) {
    Scene s = channel(0.5, 32, {1, 0}, Wall::free_slip);
    s.rheology.background_pressure = 1;
    s.materials[0].mu_s = 0.12;
    s.materials[0].cohesion = 0.2;
    set(s);
    Simulation simulation(s);
    start(simulation.fields(), [](double y) { return chute(0.5 - y, 0.5, 0.32); });
    while (simulation.t() < 5) simulation.step(5);
    return simulation.fields().u(1, 31);
  };
  const double plain = run([](Scene&) {});
  const double packed =
      run([](Scene& s) { s.dilatancy = Dilatancy{.phi_g = 0, .mode = DilatancyMode::weight}; });
  const double fluid = run([](Scene& s) {
    s.nonlocal = Nonlocal{.A = 1e-6, .walls = FluidityWall::no_flux};
    s.accuracy.fluidity_tolerance = 1e-8;
  });
  figure("cohesive chute, plug: plain %.8f, through dilatancy %.8f, through the fluidity %.8f", plain, packed,
         fluid);
  CHECK(packed == Approx(plain).epsilon(1e-6));
  CHECK(fluid == Approx(plain).epsilon(1e-3));  // in the plug xi is not quite nothing
}

// P = 0: the stress is c whatever the shear rate, down to eta_max at rest and up to eta_min in flow. Along a channel of
// half width W grains stay where they are while rho a W < c; at rho a W > c they flow as a Bingham fluid of eta_min but
// without the term of the yield stress, u = rho a (W^2 - x^2) / (2 eta_min) beyond the plug of half width c / (rho a).
TEST_CASE("cohesive grains without pressure: a plug of c / (rho a), rest below the yield stress") {
  const double W = 1, c = 0.4, eta = 1;
  const auto run = [&](double a, int n) {
    Scene s = channel(W, n, {a, 0}, Wall::free_slip);
    s.materials[0].cohesion = c;
    s.rheology.eta_min = eta;
    s.time.dt_max = 0.1;
    Simulation simulation(s);
    while (simulation.t() < 15) simulation.step(15);
    std::vector<double> u;
    for (int j = 0; j < n; ++j) u.push_back(simulation.fields().u(1, j));
    return u;
  };
  const std::vector<double> still = run(0.9 * c, 64);
  const double creep = still.back(), creeping = 0.9 * c / (2 * 1e5);  // the parabola of eta_max
  figure("cohesive, P = 0: creep below yield %.3e, parabola of eta_max %.3e", creep, creeping);
  CHECK(creep == Approx(creeping).epsilon(0.02));
  std::vector<double> errors;
  for (int n : {32, 64, 128}) {
    const std::vector<double> u = run(1, n);
    double plug = 0, worst = 0;
    for (int j = 0; j < n; ++j) {
      const double x = std::max(W - (j + 0.5) * W / n, c);
      worst = std::max(worst, std::abs(u[j] - 0.5 * (W * W - x * x) / eta));
      if (u[j] > (1 - 1e-4) * u[n - 1]) plug += W / n;
    }
    figure("cohesive, P = 0, %d cells: plug half width %.4f, exact %.1f; largest error of u %.1e of %.2f", n,
           plug, c, worst, 0.5 * (1 - c * c));
    CHECK(plug == Approx(c).margin(1.5 / n));
    errors.push_back(worst);
  }
  // The shear rate jumps at the edge of the plug, and the layer of width h^(2/3) that smears it (bagnold_test.cpp) is in error
  // by all of that.
  figure("cohesive, P = 0: largest %s orders %s", listed(errors).c_str(), listed(orders(errors)).c_str());
  expect_order(errors, 2.0 / 3, 0.1);
  CHECK(errors.back() < 0.05 * 0.5 * (1 - c * c));
}
