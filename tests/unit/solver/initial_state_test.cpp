#include "solver/initial_state.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Patch patch_of(int nx, int ny) { return {nx, ny, 12.0 / nx, 0, 0}; }

double volume(const CellField& c) {
  double sum = 0;
  for (int j = 0; j < c.ny(); ++j)
    for (int i = 0; i < c.nx(); ++i) sum += c(i, j);
  return sum * c.patch().h * c.patch().h;
}

template <class Function>
CellField sampled(const Patch& p, Function&& f) {
  CellField c(p);
  for (int j = 0; j < p.ny; ++j)
    for (int i = 0; i < p.nx; ++i) c(i, j) = f(p.x_centre(i), p.y_centre(j));
  return c;
}

/// Grains, and two tracers within them.
std::vector<CellField> shares(const Patch& p) {
  const auto within = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const auto grains = [=](double x, double y) { return within(3 * (5 + std::sin(x) - y)); };
  const auto first = [=](double x, double y) { return grains(x, y) * within(x - 4); };
  return {sampled(p, grains), sampled(p, first),
          sampled(p, [=](double x, double y) { return (grains(x, y) - first(x, y)) * within(2 * y - 3); })};
}

}  // namespace

TEST_CASE("regrid: the same grid gives the same fields") {
  const Patch p = patch_of(24, 20);
  const auto before = shares(p), after = regrid(before, p);
  for (std::size_t k = 0; k < 3; ++k)
    for (int j = 0; j < p.ny; ++j)
      for (int i = 0; i < p.nx; ++i) REQUIRE(after[k](i, j) == before[k](i, j));
}

TEST_CASE("regrid: volumes are kept, shares within their room, on finer, coarser and odd grids") {
  const auto before = shares(patch_of(24, 20));
  for (const Patch& to :
       {patch_of(48, 40), patch_of(96, 80), patch_of(12, 10), patch_of(6, 5), patch_of(36, 30)}) {
    const auto after = regrid(before, to);
    INFO(to.nx << " cells across");
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(std::abs(volume(after[k]) - volume(before[k])) < 1e-12 * volume(before[k]));
    double outside = 0;
    for (int j = 0; j < to.ny; ++j)
      for (int i = 0; i < to.nx; ++i) {
        const double c = after[0](i, j), rest = c - after[1](i, j) - after[2](i, j);
        outside = std::max({outside, c - 1, -rest, -after[1](i, j), -after[2](i, j)});
      }
    CHECK(outside < 1e-14);
  }
}

TEST_CASE("regrid: coarser cells are means, a linear field stays linear") {
  const auto linear = [](double x, double y) { return 2 + 0.3 * x - 0.2 * y; };
  const CellField c = sampled(patch_of(24, 24), linear);
  const CellField coarse = regrid(c, patch_of(12, 12));
  CHECK(coarse(3, 5) == Approx((c(6, 10) + c(7, 10) + c(6, 11) + c(7, 11)) / 4).epsilon(1e-14));
  const CellField fine = regrid(c, patch_of(72, 72));
  for (int j = 3; j < 69; ++j)
    for (int i = 3; i < 69; ++i)
      REQUIRE(fine(i, j) ==
              Approx(linear(fine.patch().x_centre(i), fine.patch().y_centre(j))).epsilon(1e-12));
}

TEST_CASE("a simulation begins with a state: shares as they are, a velocity without divergence") {
  Simulation from(silo(32));
  for (int k = 0; k < 20; ++k) from.step();
  const InitialState state{from.derived("velocity_x"),
                           from.derived("velocity_y"),
                           from.derived("pressure"),
                           {from.fields().grains},
                           {}};
  for (const int cells : {16, 32, 64}) {
    Simulation to(silo(cells));
    to.begin_with(state);
    INFO(cells << " cells across");
    CHECK(to.grain_mass() == Approx(from.grain_mass()).epsilon(1e-12));
    const Fields& f = to.fields();
    double divergence = 0;
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i)
        divergence = std::max(divergence, std::abs(f.u(i + 1, j) - f.u(i, j) + f.v(i, j + 1) - f.v(i, j)));
    CHECK(divergence / f.patch().h * to.scene().time.dt_max < to.scene().accuracy.pressure_tolerance);
    for (int j = 0; j < cells; ++j) CHECK(f.u(0, j) == 0);  // walls
    CHECK(fastest(f) > 0.3 * fastest(from.fields()));
  }
}
