// |γ̇|^2 = 2 D:D on linear flows, and its smoothing.
#include "kernels/strain_rate.hpp"

#include <catch2/catch.hpp>

#include "tests/support/boundaries.hpp"
#include "tests/support/random_fields.hpp"

using namespace hourglass;

namespace {

const Patch patch{11, 7, 0.3, -1, 0.5};

/// |γ̇|^2 of u = (a x + b y, c x + e y), sampled halos included.
CellField of_linear_flow(double a, double b, double c, double e) {
  XFaceField u(patch);
  YFaceField v(patch);
  for (int j = -1; j <= patch.ny; ++j)
    for (int i = -1; i <= patch.nx + 1; ++i) u(i, j) = a * patch.x_corner(i) + b * patch.y_centre(j);
  for (int j = -1; j <= patch.ny + 1; ++j)
    for (int i = -1; i <= patch.nx; ++i) v(i, j) = c * patch.x_centre(i) + e * patch.y_corner(j);
  CellField gamma2(patch);
  for (int j = 0; j < patch.ny; ++j) shear_rate_squared_row(u, v, j, gamma2.row(j));
  return gamma2;
}

void expect_everywhere(const CellField& f, double value) {
  double worst = 0;
  for (int j = 0; j < f.ny(); ++j)
    for (int i = 0; i < f.nx(); ++i) worst = std::max(worst, std::abs(f(i, j) - value));
  CHECK(worst < 1e-13);
}

void smooth_in_place(double* row, int n, const SmoothingPass& pass, bool periodic) {
  const std::vector<double> before(row, row + n);
  smooth_row(before.data(), n, pass, Ends{periodic}, row);
}

/// All passes over a field, as the solver makes them.
CellField smoothed(CellField f, const std::vector<SmoothingPass>& passes, bool periodic = false) {
  CellField spare(f.patch());
  for (const SmoothingPass& pass : passes) {
    for (int j = 0; j < f.ny(); ++j) smooth_in_place(f.row(j), f.nx(), pass, periodic);
    for (int j = 0; j < f.ny(); ++j) smooth_column_row(f, pass, j, spare.row(j));
    f.swap(spare);
  }
  return f;
}

}  // namespace

TEST_CASE("shear rate: pure shear, pure strain, both, and none in rigid rotation") {
  expect_everywhere(of_linear_flow(0, 1.5, 0, 0), 1.5 * 1.5);  // |γ̇| is du/dy
  expect_everywhere(of_linear_flow(0, 0, -0.4, 0), 0.4 * 0.4);
  expect_everywhere(of_linear_flow(1.5, 0, 0, -1.5), 4 * 1.5 * 1.5);
  expect_everywhere(of_linear_flow(0, -2.3, 2.3, 0), 0);
  expect_everywhere(of_linear_flow(0.5, 0.7, 0.2, -0.1), 2 * (0.25 + 0.01) + 0.9 * 0.9);
}

TEST_CASE("shear rate beside walls and openings, through the halo") {
  const int nx = patch.nx, ny = patch.ny;
  for (const auto& [name, b] : all_kinds_of_boundaries(nx, ny)) {
    INFO(name);
    XFaceField u(patch, 1.0);  // plug flow along x
    YFaceField v(patch);
    fill_velocity_halo(b, u, v);
    CellField gamma2(patch);
    for (int j = 0; j < ny; ++j) shear_rate_squared_row(u, v, j, gamma2.row(j));
    expect_everywhere(
        [&] {  // inside, nothing is sheared
          CellField inside(patch);
          for (int j = 1; j < ny - 1; ++j)
            for (int i = 0; i < nx; ++i) inside(i, j) = gamma2(i, j);
          return inside;
        }(),
        0);
    for (int i = 0; i < nx; ++i) {
      // Corner shear w u / h (2 u / h on a no-slip wall), mean of four corners.
      const double low = 0.25 * (b.bottom.shear[i] + b.bottom.shear[i + 1]) / patch.h;
      const double high = 0.25 * (b.top.shear[i] + b.top.shear[i + 1]) / patch.h;
      CHECK(gamma2(i, 0) == Approx(low * low).margin(1e-12));
      CHECK(gamma2(i, ny - 1) == Approx(high * high).margin(1e-12));
    }
  }
}

TEST_CASE("smoothing: the variance of the kernel is length^2 / 2") {
  const int n = 1024;
  const Patch line{n, 1, 1, 0, 0};
  for (double ratio : {0.1, 0.5, 0.853, 1.0, 1.7, 3.0, 8.0, 30.0, 100.0}) {
    INFO("length / h = " << ratio);
    const double h = 0.25;
    CellField f(line);
    f(n / 2, 0) = 1;
    for (const SmoothingPass& pass : smoothing_passes(ratio * h, h)) {
      CHECK((pass.weight > 0 && pass.weight <= 0.25));
      smooth_in_place(f.row(0), n, pass, false);
    }
    const int middle = n / 2;
    double sum = 0, mean = 0, square = 0, least = 0;
    for (int i = 0; i < n; ++i) {
      sum += f(i, 0);
      mean += f(i, 0) * (i - middle);
      square += f(i, 0) * (i - middle) * (i - middle);
      least = std::min(least, f(i, 0));
    }
    CHECK(sum == Approx(1).epsilon(1e-12));
    CHECK(std::abs(mean) < 1e-12);
    CHECK(square == Approx(0.5 * ratio * ratio).epsilon(1e-10));
    CHECK(least >= 0);
  }
  CHECK(smoothing_passes(0, 1).empty());
  CHECK(smoothing_passes(100, 1).size() <= 14);  // logarithmic in length / h
}

TEST_CASE("smoothing over length h is one 1-2-1 pass, and takes out the shortest wave") {
  const auto passes = smoothing_passes(0.4, 0.4);
  REQUIRE(passes.size() == 1);
  CHECK(passes[0].weight == Approx(0.25));
  CellField wave(patch);
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i) wave(i, j) = (i + j) % 2 ? 1 : -1;
  const CellField flat = smoothed(wave, passes);
  for (int j = 1; j < patch.ny - 1; ++j)
    for (int i = 1; i < patch.nx - 1; ++i) CHECK(std::abs(flat(i, j)) < 1e-15);
}

TEST_CASE("smoothing commutes with mirrors, bit for bit in x") {
  Noise noise;
  for (double length : {0.3, 0.5, 1.1, 4.0}) {
    CellField f(patch), g(patch), h(patch);
    fill_random(f, noise, 0, 1);
    for (int j = 0; j < patch.ny; ++j)
      for (int i = 0; i < patch.nx; ++i) {
        g(i, j) = f(patch.nx - 1 - i, j);
        h(i, j) = f(i, patch.ny - 1 - j);
      }
    const auto passes = smoothing_passes(length, patch.h);
    const CellField sf = smoothed(f, passes), sg = smoothed(g, passes), sh = smoothed(h, passes);
    int wrong = 0;
    double worst = 0;
    for (int j = 0; j < patch.ny; ++j)
      for (int i = 0; i < patch.nx; ++i) {
        wrong += sg(i, j) != sf(patch.nx - 1 - i, j);
        worst = std::max(worst, std::abs(sh(i, j) - sf(i, patch.ny - 1 - j)));
      }
    CHECK(wrong == 0);
    CHECK(worst < 1e-15);
  }
}

TEST_CASE("smoothing is a mean over grains: constants stay beside walls and air, and nothing leaks through") {
  Noise noise;
  const Patch p{20, 16, 1, 0, 0};
  for (bool periodic : {false, true})
    for (double length : {0.5, 1.0, 3.0, 12.0}) {
      CellField share(p), product(p);
      for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < p.nx; ++i) {
          share(i, j) = j > 10 ? 0 : j == 10 ? noise(0, 1) : 1;  // a free surface
          const double rate = j > 9 ? 1e9 * share(i, j) : 1;     // what air does must not count
          product(i, j) = (j == 10 ? 1 : rate) * share(i, j);
        }
      const auto passes = smoothing_passes(length, p.h);
      const CellField a = smoothed(product, passes, periodic), w = smoothed(share, passes, periodic);
      double worst = 0;
      for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < p.nx; ++i)
          if (w(i, j) > 1e-12) worst = std::max(worst, std::abs(a(i, j) / w(i, j) - 1));
      CHECK(worst < 1e-12);
    }
}

TEST_CASE("smoothing in a periodic row does not know where the row begins") {
  Noise noise;
  const Patch p{16, 1, 1, 0, 0};
  for (double length : {0.7, 2.0, 9.0}) {
    CellField f(p), g(p);
    fill_random(f, noise, 0, 1);
    for (int i = 0; i < p.nx; ++i) g(i, 0) = f((i + 5) % p.nx, 0);
    const auto passes = smoothing_passes(length, p.h);
    for (CellField* q : {&f, &g})
      for (const SmoothingPass& pass : passes) smooth_in_place(q->row(0), p.nx, pass, true);
    for (int i = 0; i < p.nx; ++i) CHECK(g(i, 0) == Approx(f((i + 5) % p.nx, 0)).epsilon(1e-14));
  }
}
