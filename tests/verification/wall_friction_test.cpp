// Friction of a front and a back wall: Janssen's pressure between plates that move, a block that slides to rest, and the
// slope that sets it off.
#include "tests/support/expect_order.hpp"
#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// Four cells wide, height 1, full of grains that slip along both sides, under plates that move along y.
Scene between_plates(int cells, double plate_speed, double F, FrictionMode mode) {
  Scene s = newtonian(4.0 / cells, 1, 4, {1e-3});
  s.gravity = {0, -1};
  s.walls = {Wall::free_slip, Wall::free_slip, Wall::no_slip, Wall::open};
  s.wall_friction = WallFriction{.F = F, .mode = mode, .wall_velocity = {0, plate_speed}};
  s.start_pressure = StartPressure::hydrostatic;
  s.time.dt_max = 0.1;
  return s;
}

/// A channel of height 1 without gravity, periodic, full of grains at the pressure 2 that slide along it at `speed`.
constexpr double weight = 2, roughness = 0.25;  // P and F: a deceleration of 0.5 at density 1
Scene sliding(double dt, FrictionMode mode) {
  Scene s = newtonian(1, 1, 8, {1});
  s.walls = {Wall::periodic, Wall::periodic, Wall::free_slip, Wall::free_slip};
  s.rheology.background_pressure = weight;
  s.wall_friction = WallFriction{.F = roughness, .mode = mode};
  s.time.dt_max = dt;
  return s;
}
void set_speed(Simulation& simulation, double u) {
  Fields& f = simulation.fields();
  for (int j = 0; j < f.u.ny(); ++j)
    for (int i = 0; i < f.u.nx(); ++i) f.u(i, j) = u;
}
/// The least and the largest u; both components of any cross flow count as one that is out of line.
std::array<double, 2> speeds(const Fields& f) {
  std::array<double, 2> range{1e300, -1e300};
  for (int j = 0; j < f.u.ny(); ++j)
    for (int i = 0; i < f.u.nx(); ++i) range = {std::min(range[0], f.u(i, j)), std::max(range[1], f.u(i, j))};
  for (int j = 0; j < f.v.ny(); ++j)
    for (int i = 0; i < f.v.nx(); ++i) CHECK(std::abs(f.v(i, j)) < 1e-9);
  return range;
}

}  // namespace

// dP/dz = rho g -+ F P, z the depth: plates that rise carry a part of the weight, plates that sink add to it.
TEST_CASE("Janssen: pressure of grains at rest between plates that move, second order") {
  const double F = 3;
  for (double plate : {2.0, -2.0})
    for (const auto& [law, mode] : {std::pair{Law::newtonian, FrictionMode::implicit},
                                    {Law::mu_I, FrictionMode::implicit},
                                    {Law::mu_I, FrictionMode::limiter}}) {
      std::vector<double> errors;
      for (int n : {16, 32, 64}) {
        Scene s = between_plates(n, plate, F, mode);
        s.rheology.law = law;
        // A step moves the pressure by the share of 1 / (1 + 2 eta k^2 dt / rho): thin grains make it soon.
        s.rheology.eta_min = 1e-4;
        s.rheology.eta_max = 1e-3;
        Simulation simulation(s);
        for (int k = 0; k < 60; ++k) simulation.step();
        const Fields& f = simulation.fields();
        double worst = 0, fastest = 0;
        for (int j = 0; j < n; ++j) {
          const double z = 1 - f.patch().y_centre(j);
          const double exact = plate > 0 ? (1 - std::exp(-F * z)) / F : (std::exp(F * z) - 1) / F;
          for (int i = 0; i < 4; ++i) {
            worst = std::max(worst, std::abs(f.p(i, j) - exact));
            fastest = std::max({fastest, std::abs(f.v(i, j)), std::abs(f.u(i, j))});
          }
        }
        errors.push_back(worst);
        CHECK(fastest < 1e-9);
      }
      figure("Janssen, plates %+.0f, %s, %s: largest %s orders %s", plate, law_names[static_cast<int>(law)],
             friction_mode_names[static_cast<int>(mode)], listed(errors).c_str(),
             listed(orders(errors)).c_str());
      expect_order(errors, 2, 0.1);
      CHECK(errors.back() < (plate > 0 ? 1e-3 : 6e-3));
    }
}

TEST_CASE("a block slides to rest: u = u_0 - F P t / rho, and never back") {
  for (FrictionMode mode : {FrictionMode::implicit, FrictionMode::limiter}) {
    const char* name = friction_mode_names[static_cast<int>(mode)];
    // 100 steps to the stop at t = 2.
    Simulation slide(sliding(0.02, mode));
    set_speed(slide, 1);
    while (slide.t() < 1) slide.step(1);
    const auto half = speeds(slide.fields());
    while (slide.t() < 4) {
      slide.step(4);
      CHECK(speeds(slide.fields())[0] >= -1e-12);
    }
    const auto end = speeds(slide.fields());
    // One step that friction would need only a tenth of.
    Scene sudden = sliding(20, mode);
    sudden.time.cfl = 0.5;
    Simulation stop(sudden);
    set_speed(stop, 1e-3);
    double last = 1e-3;
    for (int k = 0; k < 8; ++k) {
      stop.step();
      const auto [least, most] = speeds(stop.fields());
      CHECK(least >= -1e-12);
      CHECK(most <= last);
      last = most;
    }
    figure("sliding block, %s: u(1) %.5f to %.5f, exact 0.5; at the end %.1e, after the long steps %.1e",
           name, half[0], half[1], end[1], last);
    CHECK(half[0] == Approx(0.5).epsilon(0.03));
    CHECK(half[1] == Approx(half[0]).epsilon(1e-9));
    CHECK(end[1] < 1e-5);
    CHECK(last < 1e-5);
  }
}

TEST_CASE("a block slides to rest: first order in time, implicit") {
  std::vector<double> errors;
  for (double dt : {0.04, 0.02, 0.01, 0.005}) {
    Simulation slide(sliding(dt, FrictionMode::implicit));
    set_speed(slide, 1);
    while (slide.t() < 1) slide.step(1);
    errors.push_back(std::abs(speeds(slide.fields())[0] - 0.5));
  }
  figure("sliding block, implicit: error at half speed %s orders %s", listed(errors).c_str(),
         listed(orders(errors)).c_str());
  expect_order(errors, 1, 0.1);
}

TEST_CASE("a slope below friction keeps a block to a creep, one above lets it go at a - F P / rho") {
  const double hold = roughness * weight;
  Scene below = sliding(0.05, FrictionMode::implicit);
  below.gravity = {0.8 * hold, 0};
  Simulation rests(below);
  for (int k = 0; k < 50; ++k) rests.step();
  const auto creep = speeds(rests.fields());
  // A drag below the speed floor: the creep is floor a rho / (F P).
  CHECK(creep[1] <= below.wall_friction->speed_floor);
  CHECK(creep[1] == Approx(0.8 * below.wall_friction->speed_floor).epsilon(1e-3));

  // The limiter knows the last step only, and takes from it what that step gained.
  below.wall_friction->mode = FrictionMode::limiter;
  Simulation limited(below);
  double dt = 0;
  for (int k = 0; k < 50; ++k) dt = limited.step().dt;
  CHECK(speeds(limited.fields())[1] == Approx(0.8 * hold * dt).epsilon(1e-6));

  Scene above = sliding(0.01, FrictionMode::implicit);
  above.gravity = {1.5 * hold, 0};
  Simulation goes(above);
  while (goes.t() < 1) goes.step(1);
  const double first = speeds(goes.fields())[0];
  while (goes.t() < 2) goes.step(2);
  const double gained = speeds(goes.fields())[0] - first;
  figure("slope: creep %.3e of floor %.0e; acceleration %.5f, exact %.5f", creep[1],
         below.wall_friction->speed_floor, gained, 0.5 * hold);
  CHECK(gained == Approx(0.5 * hold).epsilon(0.02));
}

// Every side open: nothing holds the grains but friction. The force is along -u, its size is that of the speed's.
TEST_CASE("friction acts against the motion in any direction, up to the openings, and makes no pressure") {
  Scene s = newtonian(1, 1, 8, {1});
  s.walls = {Wall::open, Wall::open, Wall::open, Wall::open};
  s.rheology.background_pressure = weight;
  s.time.dt_max = 0.01;
  for (FrictionMode mode : {FrictionMode::implicit, FrictionMode::limiter})
    for (const auto& [x, y] : {std::pair{0.0, -1.0}, {0.6, -0.8}}) {
      s.wall_friction = WallFriction{.F = roughness, .mode = mode};
      Simulation simulation(s);
      Fields& f = simulation.fields();
      f.u.fill(x);
      f.v.fill(y);
      double pressure = 0;
      for (int k = 0; k < 5; ++k) {
        f.grains.fill(1);  // what comes in is grains
        simulation.step();
        for (int j = 0; j < 8; ++j)
          for (int i = 0; i < 8; ++i) pressure = std::max(pressure, std::abs(f.p(i, j)));
      }
      const double lost = simulation.t() * roughness * weight, u = f.u(4, 4), v = f.v(4, 4);
      double uneven = 0;
      for (int j = 0; j < 8; ++j)
        for (int i = 0; i <= 8; ++i)
          uneven = std::max({uneven, std::abs(f.u(i, j) - u), std::abs(f.v(j, i) - v)});
      figure(
          "open box, %s, from (%.1f, %.1f): slowed by %.5f, exact %.5f, direction off by %.1e, uneven by "
          "%.1e, "
          "pressure %.1e",
          friction_mode_names[static_cast<int>(mode)], x, y, 1 - std::hypot(u, v), lost,
          std::abs(u * y - v * x), uneven, pressure);
      CHECK(1 - std::hypot(u, v) == Approx(lost).epsilon(0.02));
      CHECK(std::abs(u * y - v * x) < 1e-6);
      CHECK(uneven < 1e-4);
      CHECK(pressure < 1e-4);
    }
}
