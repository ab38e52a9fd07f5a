// The granular fluidity alone: frozen coefficients against exact solutions, contrast, both closures at their fixed points.
#include "solver/fluidity.hpp"

#include <catch2/catch.hpp>
#include <functional>

#include "solver/boundary_of.hpp"
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/random_fields.hpp"

using namespace hourglass;

namespace {

/// What the rheology hands to the stage in a cell.
struct Cell {
  double rate, pressure, I, mu;
};

/// A fluidity stage with fields of its own, full of material 0; the caller plays the rheology.
template <class T>
class Bench {
 public:
  explicit Bench(const Scene& scene)
      : scene_(scene), boundary_(boundary_of(scene)), properties_(scene),
        stage_(scene, scene.patch(), boundary_),
        fields(scene.patch(), static_cast<int>(scene.materials.size()), true) {
    fields.grains.fill(1);
  }
  SolveStats solve(int threads, const std::function<Cell(int i, int j)>& cell) {
    const int nx = fields.p.nx(), ny = fields.p.ny();
    std::vector<double> gamma2(nx), pressure(nx), I(nx), mu(nx);
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        const Cell c = cell(i, j);
        gamma2[i] = c.rate * c.rate;
        pressure[i] = c.pressure;
        I[i] = c.I;
        mu[i] = c.mu;
      }
      GrainProperties::Rows rows(properties_, fields, j);
      stage_.set_row(fields, j, gamma2.data(), pressure.data(), I.data(), mu.data(), rows);
    }
    SolveStats stats;
    parallel(threads, [&](Team& team) {
      const SolveStats s = stage_.solve(team, fields);
      if (team.leads()) stats = s;
    });
    return stats;
  }

 private:
  Scene scene_;
  Boundary boundary_;
  GrainProperties properties_;
  Fluidity<T> stage_;

 public:
  Fields fields;
};

/// Periodic, four cells wide, walls at the bottom and the top, `cells` cells over the height 1.
Scene column(int cells, FluidityWall walls, Closure closure = Closure::thesis, double A = 1) {
  Scene s;
  s.height = 1;
  s.width = 4.0 / cells;
  s.cells_x = 4;
  s.materials = {well_posed_grains()};
  s.fill = {fill_box(0, 0, s.width, 0, 1)};
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::no_slip};
  s.nonlocal = Nonlocal{.A = A, .closure = closure, .walls = walls};
  s.rheology.eta_max = 1e30;  // no least fluidity
  s.accuracy.fluidity_tolerance = 1e-11;
  s.accuracy.precision = Precision::full;
  return s;
}

/// I for which xi = A d sqrt(I_0 / (delta_mu I)) has this value.
double inertial_number_for(double xi, const Scene& s) {
  const Material& m = s.materials[0];
  const double reach = s.nonlocal->A * m.diameter / xi;
  return reach * reach * m.I_0 / m.delta_mu;
}

/// Largest relative error of the column i = 1.
double error_of(const CellField& g, const std::function<double(double y)>& exact) {
  double worst = 0;
  for (int j = 0; j < g.ny(); ++j) {
    const double wanted = exact(g.patch().y_centre(j));
    worst = std::max(worst, std::abs(g(1, j) - wanted) / wanted);
  }
  return worst;
}

}  // namespace

TEST_CASE("frozen xi, fluidity 0 at both walls: the cosh of the exact solution, second order") {
  const double xi = 0.15, local = 3;
  std::vector<double> errors;
  for (int n : {32, 64, 128, 256}) {
    const Scene s = column(n, FluidityWall::zero);
    Bench<double> bench(s);
    const double I = inertial_number_for(xi, s);
    bench.solve(1, [&](int, int) { return Cell{local * 0.5, 1, I, 0.5}; });
    double worst = 0;
    for (int j = 0; j < n; ++j) {
      const double y = (j + 0.5) / n;
      const double exact = local * (1 - std::cosh((y - 0.5) / xi) / std::cosh(0.5 / xi));
      for (int i = 0; i < 4; ++i)
        worst = std::max(worst, std::abs(bench.fields.fluidity(i, j) - exact) / local);
    }
    errors.push_back(worst);
  }
  figure("fluidity, frozen xi, zero walls: largest %s orders %s", listed(errors).c_str(),
         listed(orders(errors)).c_str());
  expect_order(errors, 2, 0.05);
  CHECK(errors.back() < 1e-3);
}

TEST_CASE("frozen xi, no flux through walls: g is g_local to rounding") {
  const Scene s = column(32, FluidityWall::no_flux);
  Bench<double> bench(s);
  const double I = inertial_number_for(0.3, s);
  bench.solve(1, [&](int, int) { return Cell{1.5, 1, I, 0.5}; });
  const double error = error_of(bench.fields.fluidity, [](double) { return 3.0; });
  figure("fluidity, frozen xi, no flux: largest error %.1e", error);
  CHECK(error < 1e-12);
}

TEMPLATE_TEST_CASE(
    "absorption from 1e-8 to 1e8 in noise, partly filled cells: bounded by the sources, few iterations", "",
    float, double) {
  int most = 0;
  double below = 0, above = 0;
  for (int n : {64, 128, 256})
    for (bool holes : {false, true})
      for (double contrast : {1.0, 1e4, 1e16}) {
        Scene s = column(n, FluidityWall::no_flux);
        s.width = 1;
        s.cells_x = n;
        s.walls = {Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::open};
        s.accuracy.fluidity_tolerance = 1e-6;
        const auto run = [&](int threads, Fields& out) {
          Bench<TestType> bench(s);
          Noise noise(7);
          const double h = 1.0 / n;
          for (int j = 0; j < n && holes; ++j)
            for (int i = 0; i < n; ++i) {
              const double kind = noise(0, 1);
              bench.fields.grains(i, j) = kind < 0.1 ? 0 : kind < 0.3 ? noise(0, 1) : kind < 0.4 ? 1e-5 : 1;
            }
          const Material& m = s.materials[0];
          const SolveStats stats = bench.solve(threads, [&](int, int) {
            const double kappa = noise.logarithmic(1 / std::sqrt(contrast), std::sqrt(contrast));
            // kappa = delta_mu I / I_0 (h / A d)^2
            return Cell{noise(1, 2) * 0.5, 1, kappa * m.I_0 / m.delta_mu / (h * h), 0.5};
          });
          out = bench.fields;
          return stats;
        };
        Fields one(s.patch(), 1, true), two = one;
        const SolveStats stats = run(1, one);
        INFO(n << " cells, holes " << holes << ", contrast " << contrast << ": " << stats.iterations);
        CHECK(stats.converged);
        run(2, two);
        bool same = true;
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            const double g = one.fluidity(i, j);
            same = same && g == two.fluidity(i, j);
            if (one.grains(i, j) <= least_grains) {
              same = same && g == 0;
              continue;
            }
            below = std::max(below, 1 - g);
            above = std::max(above, g / 2 - 1);
          }
        CHECK(same);
        most = std::max(most, stats.iterations);
        figure("fluidity | %s | %d cells, %s, contrast %.0e: %d iterations",
               sizeof(TestType) == 4 ? "float" : "double", n, holes ? "holes" : "full", contrast,
               stats.iterations);
      }
  figure("fluidity: sources in [1, 2], answers below by at most %.1e, above by at most %.1e", below, above);
  CHECK(most <= 20);
  CHECK(below < 1e-5);
  CHECK(above < 1e-5);
}

// Uniform stress ratio m < mu_s, |γ̇| = m g; with mu(I) = mu_s, to which it tends as I -> 0:
// g'' = g (1 - m/mu_s) / xi^2(I) = K g^2, so that g = g_0 / (1 + y sqrt(K g_0 / 6))^2. The first and the last cell are held.
TEST_CASE("closure thesis at its fixed point below yield: algebraic decay, second order") {
  const double d = 0.05, A = 0.5, m = 0.25, g_0 = 40, pressure = 2;
  std::vector<double> errors;
  int rounds = 0;
  for (int n : {32, 64, 128}) {
    Scene s = column(n, FluidityWall::no_flux, Closure::thesis, A);
    s.materials[0].diameter = d;
    Bench<double> bench(s);
    const Material& p = s.materials[0];
    const double K = p.delta_mu * m * (1 - m / p.mu_s) / (A * A * d * p.I_0 * std::sqrt(pressure));
    const auto exact = [&](double y) { return g_0 / std::pow(1 + y * std::sqrt(K * g_0 / 6), 2); };
    CellField& g = bench.fields.fluidity;
    g.fill(g_0);
    double change = 1;
    for (rounds = 0; change > 1e-10 && rounds < 500; ++rounds) {
      const CellField before = g;
      bench.solve(1, [&](int i, int j) {
        const bool held = j == 0 || j == n - 1;
        if (held) return Cell{p.mu_s * exact((j + 0.5) / n), pressure, 1e20, p.mu_s};
        const double rate = m * before(i, j);
        return Cell{rate, pressure, rate * d / std::sqrt(pressure), p.mu_s};
      });
      change = 0;
      for (int j = 0; j < n; ++j) change = std::max(change, std::abs(g(1, j) / before(1, j) - 1));
    }
    CHECK(change <= 1e-10);
    errors.push_back(error_of(g, exact));
    if (n == 128)
      figure("fluidity, thesis below yield: g falls %.1f-fold over the height, %d rounds",
             g(1, 0) / g(1, n - 1), rounds);
  }
  figure("fluidity, thesis below yield: largest %s orders %s", listed(errors).c_str(),
         listed(orders(errors)).c_str());
  expect_order(errors, 2, 0.1);
  CHECK(errors.back() < 2e-3);
}

TEST_CASE("closure thesis, uniform shear and no flux: g is that of mu(I)") {
  const Scene s = column(16, FluidityWall::no_flux);
  Bench<double> bench(s);
  const Grain grain = grain_of(s.materials[0]);
  for (double rate : {1e-3, 1.0, 1e3}) {
    const double I = inertial_number(rate, 2, grain), mu = mu_of_I(I, grain);
    bench.solve(1, [&](int, int) { return Cell{rate, 2, I, mu}; });
    CHECK(error_of(bench.fields.fluidity, [&](double) { return rate / mu; }) < 1e-10);
  }
}

// Material 1 has A = 0: its cells are local, their g_local holds the end. Then lap g = g / xi^2(m),
// xi = A d sqrt((mu_2 - m) / (delta_mu (mu_s - m))): a cosh over the rest of the column, whose far end lets no flux through.
TEST_CASE("closure kamrin at its fixed point: exponential decay below yield, I_0 above") {
  const double A = 0.5, d = 0.1, pressure = 2, above = 0.4, m = 0.25;
  const Material p = well_posed_grains();
  const double mu_2 = p.mu_s + p.delta_mu;
  const double held = p.I_0 * std::sqrt(pressure) / d * (above - p.mu_s) / (above * (mu_2 - above));
  const double xi = A * d * std::sqrt((mu_2 - m) / (p.delta_mu * (p.mu_s - m)));
  std::vector<double> errors;
  for (int n : {16, 32, 64, 128}) {
    Scene s = column(n, FluidityWall::no_flux, Closure::kamrin, A);
    s.materials[0].diameter = d;
    s.materials.push_back(s.materials[0]);
    s.materials[1].A = 0;
    Bench<double> bench(s);
    for (int i = 0; i < 4; ++i) bench.fields.tracers[0](i, 0) = 1;
    CellField& g = bench.fields.fluidity;
    g.fill(held / 10);
    double change = 1;
    int rounds = 0;
    for (; change > 1e-10 && rounds < 500; ++rounds) {
      const CellField before = g;
      bench.solve(1, [&](int i, int j) { return Cell{(j == 0 ? above : m) * before(i, j), pressure, 0, 0}; });
      change = 0;
      for (int j = 0; j < n; ++j) change = std::max(change, std::abs(g(1, j) / before(1, j) - 1));
    }
    CHECK(change <= 1e-10);
    CHECK(g(1, 0) == Approx(held).epsilon(1e-6));
    const double first = 0.5 / n;  // the centre of the held cell
    const auto exact = [&](double y) { return held * std::cosh((1 - y) / xi) / std::cosh((1 - first) / xi); };
    // Relative to the value there: the error of the decay length adds up along 10 of them.
    errors.push_back(error_of(g, exact));
    if (n == 128) {
      const int from = n / 10, to = n / 2;
      const double fitted = (to - from) / (n * std::log(g(1, from) / g(1, to)));
      figure("fluidity, kamrin below yield: decay length %.6f, exact %.6f, %d rounds", fitted, xi, rounds);
      CHECK(fitted == Approx(xi).epsilon(0.02));
    }
  }
  figure("fluidity, kamrin below yield: largest %s orders %s", listed(errors).c_str(),
         listed(orders(errors)).c_str());
  expect_order(errors, 2, 0.1);
}

TEST_CASE("closure kamrin, uniform flow above yield: g_local of the stress, and mu(I) of the shear rate") {
  const double d = 0.1, pressure = 2;
  Scene s = column(16, FluidityWall::no_flux, Closure::kamrin, 0.5);
  s.materials[0].diameter = d;
  const Material& p = s.materials[0];
  const Grain grain = grain_of(p);
  const double mu_2 = p.mu_s + p.delta_mu;
  for (double m : {0.33, 0.4, 0.55}) {
    const double exact = p.I_0 * std::sqrt(pressure) / d * (m - p.mu_s) / (m * (mu_2 - m));
    // Given stress: |γ̇| = m g.
    Bench<double> stress(s);
    stress.fields.fluidity.fill(1);
    for (int k = 0; k < 3000; ++k) {
      const CellField before = stress.fields.fluidity;
      stress.solve(1, [&](int i, int j) { return Cell{m * before(i, j), pressure, 0, 0}; });
    }
    const double of_stress = error_of(stress.fields.fluidity, [&](double) { return exact; });
    // Given shear rate: what the engine does within a step.
    Bench<double> rate(s);
    rate.fields.fluidity.fill(1);
    int rounds = 0;
    for (double change = 1; change > 1e-11 && rounds < 500; ++rounds) {
      const double before = rate.fields.fluidity(1, 1);
      rate.solve(1, [&](int, int) { return Cell{m * exact, pressure, 0, 0}; });
      change = std::abs(rate.fields.fluidity(1, 1) / before - 1);
    }
    const double of_rate = error_of(rate.fields.fluidity, [&](double) { return exact; });
    figure(
        "fluidity, kamrin above yield, m %.2f: error for given stress %.1e, for given rate %.1e in %d rounds",
        m, of_stress, of_rate, rounds);
    CHECK(of_stress < 1e-9);
    CHECK(of_rate < 1e-8);
    CHECK(mu_of_I(inertial_number(m * exact, pressure, grain), grain) == Approx(m));
  }
}
