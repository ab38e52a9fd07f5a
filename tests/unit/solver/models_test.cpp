// Models in closed form against exact results, and against each other where they meet.
#include <catch2/catch.hpp>
#include <cmath>

#include "solver/models/kinematic_fit.hpp"
#include "solver/models/quadrature.hpp"
#include "solver/models/radial.hpp"
#include "solver/models/runge_kutta.hpp"
#include "solver/models/stochastic.hpp"

using namespace hourglass;

namespace {

constexpr double degree = M_PI / 180;

Floor floor_with(std::vector<FloorSource> sources, SideImages sides = SideImages::closed) {
  return {150, sides, sides, std::move(sources)};
}

const std::vector<FloorSource> two_orifices{{40, 60, 1.5}, {100, 100, 0.5}};

/// Flux downwards through a height, between places where the flow is smooth.
template <class Model>
double flux(const Model& model, double y) {
  double sum = 0;
  const double ends[] = {0, 40, 60, 100, 150};
  for (int k = 0; k < 4; ++k)
    sum -=
        integral<1>([&](double x) { return std::array{model.at(x, y).v}; }, ends[k], ends[k + 1], 1e-11)[0];
  return sum;
}

/// d(u)/dx + d(v)/dy by central differences of fourth order.
template <class Model>
double divergence(const Model& model, double x, double y) {
  const double h = 1e-2;
  const auto slope = [&](auto&& f) { return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h); };
  return slope([&](double e) { return model.at(x + e, y).u; }) +
         slope([&](double e) { return model.at(x, y + e).v; });
}

}  // namespace

TEST_CASE("the integrator reaches its tolerance, and stops before a singular point") {
  double x = 0;
  const auto turning = [](double, const std::array<double, 2>& y) { return std::array{y[1], -y[0]}; };
  const auto y = integrate<2>(turning, x, 10, {0, 1}, 1e-12);
  CHECK(x == 10);
  CHECK(std::abs(y[0] - std::sin(10.0)) < 1e-10);
  CHECK(std::abs(y[1] - std::cos(10.0)) < 1e-10);
  x = 0;  // y = 1/(1 - x)
  integrate<1>([](double, const std::array<double, 1>& z) { return std::array{z[0] * z[0]}; }, x, 2, {1},
               1e-10);
  CHECK(x < 1.001);
  CHECK(x > 0.9);
}

TEST_CASE("quadrature halves itself where a function is sharp") {
  const auto sharp = [](double x) { return std::array{1e-3 / (M_PI * (x * x + 1e-6)), std::abs(x - 0.3)}; };
  const auto [peak, kink] = integral<2>(sharp, -1, 2, 1e-13);
  CHECK(std::abs(peak - (std::atan(2e3) + std::atan(1e3)) / M_PI) < 1e-12);
  CHECK(std::abs(kink - (1.3 * 1.3 + 1.7 * 1.7) / 2) < 1e-12);
}

TEST_CASE("kinematic: point and slot are their closed forms, and u = -B dv/dx") {
  const double B = 2.3, q = 1.7, y = 21;
  const KinematicFlow point(floor_with({{75, 75, q}}, SideImages::open), B);
  const KinematicFlow slot(floor_with({{70, 80, q}}, SideImages::open), B);
  const double s = std::sqrt(4 * B * y);
  for (const double x : {40.0, 69.5, 75.0, 81.25, 110.0}) {
    const double dx = x - 75;
    const double v = -q / std::sqrt(4 * M_PI * B * y) * std::exp(-dx * dx / (4 * B * y));
    CHECK(std::abs(point.at(x, y).v - v) < 1e-14);
    CHECK(std::abs(point.at(x, y).u - v * dx / (2 * y)) < 1e-14);  // -B dv/dx
    CHECK(std::abs(slot.at(x, y).v + q / 20 * (std::erf((dx + 5) / s) - std::erf((dx - 5) / s))) < 1e-14);
    const auto mean = integral<2>(
        [&](double t) {
          const PointVelocity w = point.at(x - t, y);
          return std::array{w.u / 10, w.v / 10};
        },
        -5, 5, 1e-14);
    CHECK(std::abs(slot.at(x, y).u - mean[0]) < 1e-13);
    CHECK(std::abs(slot.at(x, y).v - mean[1]) < 1e-13);
    const double dB = 1e-4,
                 up = KinematicFlow(floor_with({{70, 80, q}}, SideImages::open), B + dB).at(x, y).v,
                 down = KinematicFlow(floor_with({{70, 80, q}}, SideImages::open), B - dB).at(x, y).v;
    CHECK(std::abs(slot.dv_dB(x, y) - (up - down) / (2 * dB)) < 1e-9);
  }
}

TEST_CASE("the flux through every height is the discharge, and nothing crosses closed sides") {
  const KinematicFlow kinematic(floor_with(two_orifices), 2);
  const StochasticFlow stochastic(floor_with(two_orifices), 4), spots(floor_with(two_orifices), 4, 3);
  const KinematicFlow wide(floor_with(two_orifices), 60);  // feels many images
  for (const double y : {0.3, 4.0, 40.0, 149.0}) {
    INFO("y = " << y);
    CHECK(std::abs(flux(kinematic, y) - 2) < 1e-10);
    CHECK(std::abs(flux(wide, y) - 2) < 1e-10);
    CHECK(std::abs(flux(stochastic, y) - 2) < 1e-10);
    CHECK(std::abs(flux(spots, y) - 2) < 1e-10);
    for (const double x : {0.0, 150.0}) {
      CHECK(std::abs(kinematic.at(x, y).u) < 1e-14);
      CHECK(std::abs(wide.at(x, y).u) < 1e-14);
      CHECK(std::abs(stochastic.at(x, y).u) < 1e-13);
    }
  }
  const KinematicFlow open(floor_with(two_orifices, SideImages::open), 2);
  CHECK(flux(open, 149) < 2 - 1e-4);  // some passes beside the domain
  const KinematicFlow periodic(floor_with(two_orifices, SideImages::periodic), 40);
  CHECK(std::abs(flux(periodic, 90) - 2) < 1e-10);
  CHECK(std::abs(periodic.at(0, 90).u - periodic.at(150, 90).u) < 1e-14);
}

TEST_CASE("kinematic and stochastic flow have no divergence") {
  const KinematicFlow kinematic(floor_with(two_orifices), 2);
  const StochasticFlow stochastic(floor_with(two_orifices), 4, 3);
  for (const auto& [x, y] : {std::array{50.0, 5.0}, {61.0, 3.0}, {97.0, 12.0}, {20.0, 80.0}}) {
    CHECK(std::abs(divergence(kinematic, x, y)) < 1e-8);  // of the differences
    CHECK(std::abs(divergence(stochastic, x, y)) < 1e-8);
  }
}

TEST_CASE("a symmetric silo has a symmetric flow") {
  const auto sources = std::vector<FloorSource>{{30, 45, 1}, {105, 120, 1}};
  const KinematicFlow kinematic(floor_with(sources), 2);
  const StochasticFlow stochastic(floor_with(sources), 4);
  for (const double x : {10.0, 36.0, 74.0})
    for (const double y : {1.0, 30.0, 120.0}) {
      CHECK(std::abs(kinematic.at(x, y).u + kinematic.at(150 - x, y).u) < 1e-14);
      CHECK(std::abs(kinematic.at(x, y).v - kinematic.at(150 - x, y).v) < 1e-14);
      CHECK(std::abs(stochastic.at(x, y).u + stochastic.at(150 - x, y).u) < 1e-13);
      CHECK(std::abs(stochastic.at(x, y).v - stochastic.at(150 - x, y).v) < 1e-13);
    }
}

TEST_CASE("scaled Bessel functions K0, K1 by all three rules") {
  for (double s = 1e-4; s < 200; s *= 1.07) {
    const auto [k0, k1] = scaled_bessel_k(s);
    INFO("s = " << s);  // the library's own are good to about 1e-14
    CHECK(std::abs(k0 / (std::exp(s) * std::cyl_bessel_k(0, s)) - 1) < 3e-14);
    CHECK(std::abs(k1 / (std::exp(s) * std::cyl_bessel_k(1, s)) - 1) < 3e-14);
  }
}

TEST_CASE("stochastic: the point is the Fourier integral, and a slot the mean of points") {
  // v = -q/(2 pi) int cos(k x) [rho^ - (L/2) d/dy rho^] dk with rho^ = exp(y/L (1 - sqrt(1 + L^2 k^2)))
  const double L = 4, q = 1.3, y = 6;
  const StochasticFlow point(floor_with({{75, 75, q}}, SideImages::open), L);
  const StochasticFlow slot(floor_with({{70, 80, q}}, SideImages::open), L);
  const StochasticFlow spot(floor_with({{75, 75, q}}, SideImages::open), L, 10);
  for (const double dx : {0.0, 3.0, 17.0}) {
    const auto v = integral<1>(
        [&](double k) {
          const double root = std::sqrt(1 + L * L * k * k);
          return std::array{-q / M_PI * std::cos(k * dx) * std::exp(y / L * (1 - root)) * 0.5 * (1 + root)};
        },
        0, 10, 1e-13);
    CHECK(std::abs(point.at(75 + dx, y).v - v[0]) < 1e-11);
    const auto mean = integral<2>(
        [&](double t) {
          const PointVelocity w = point.at(75 + dx - t, y);
          return std::array{w.u / 10, w.v / 10};
        },
        -5, 5, 1e-14);
    for (const StochasticFlow* spread : {&slot, &spot}) {  // a spot of this width acts alike
      CHECK(std::abs(spread->at(75 + dx, y).u - mean[0]) < 1e-12);
      CHECK(std::abs(spread->at(75 + dx, y).v - mean[1]) < 1e-12);
    }
  }
}

TEST_CASE("stochastic flow tends to kinematic flow with B = L_s/2 far above") {
  const double L = 4;
  const StochasticFlow stochastic(floor_with({{70, 80, 1}}, SideImages::open), L);
  const KinematicFlow kinematic(floor_with({{70, 80, 1}}, SideImages::open), L / 2);
  double before = HUGE_VAL;
  for (const double y : {50.0, 100.0, 200.0, 400.0, 800.0}) {
    double worst = 0;
    const double largest = -kinematic.at(75, y).v;
    for (double x = 0; x <= 150; x += 5)
      worst = std::max(worst, std::abs(stochastic.at(x, y).v - kinematic.at(x, y).v) / largest);
    CHECK(worst < 0.55 * before);  // first order in L/y: halves as y doubles
    before = worst;
  }
  CHECK(before < 4e-3);
}

TEST_CASE("radial: published angles to six digits, cone and wedge") {
  struct Case {
    double phi, phi_w, half_angle;
    bool cone;
    double q_axis, q_wall, f_wall, psi_wall;
  };
  // Solved by shooting at two step sizes with a code apart from this one.
  for (const Case& c : {Case{30, 15, 15, true, .170081, .270650, .646391, 113.087},
                        Case{30, 15, 15, false, .460627, .599451, .779058, 113.087},
                        Case{30, 10, 20, true, .264650, .380086, .696631, 105.161},
                        Case{30, 10, 20, false, .736840, .895896, .813080, 105.161}}) {
    INFO(c.phi_w << " " << c.cone);
    const RadialHopper hopper{c.phi * degree, c.phi_w * degree, c.half_angle * degree, c.cone};
    const auto field = radial_field(hopper);
    REQUIRE(field);
    const auto wall = field->at(hopper.half_angle);
    CHECK(std::abs(field->q_axis() - c.q_axis) < 1e-6);
    CHECK(std::abs(wall.q - c.q_wall) < 1e-6);
    CHECK(std::abs(wall.f - c.f_wall) < 1e-6);
    CHECK(std::abs(wall.psi / degree - c.psi_wall) < 1e-3);
    CHECK(std::abs(wall.psi - hopper.psi_wall()) < 1e-10);
    CHECK(field->at(0).psi == M_PI / 2);
    CHECK(field->at(0).f == 1);
    const double q = field->q_axis();
    CHECK(*shooting_error(hopper, 0.99 * q) > 1e-4);
    CHECK(std::abs(*shooting_error(hopper, q)) < 1e-9);
    CHECK(*shooting_error(hopper, 1.01 * q) < -1e-4);
  }
}

TEST_CASE("radial: stresses are in equilibrium, at yield, and the wall slips at its friction") {
  for (const bool cone : {true, false}) {
    const RadialHopper hopper{32 * degree, 12 * degree, 18 * degree, cone};
    const auto field = radial_field(hopper);
    REQUIRE(field);
    const double S = std::sin(hopper.phi), h = 1e-4;
    struct Stress {
      double rr, tt, cc, rt;
    };
    const auto stress = [&](double r, double theta) -> Stress {  // rho g = 1
      const auto at = field->at(theta);
      const double p = r * at.q;
      return {p * (1 + S * std::cos(2 * at.psi)), p * (1 - S * std::cos(2 * at.psi)), p * (1 + S),
              p * S * std::sin(2 * at.psi)};
    };
    for (const double theta : {0.05, 0.17, 0.29}) {
      const double r = 3;
      const Stress s = stress(r, theta);
      const auto by_r = [&](auto member) {
        return (stress(r + h, theta).*member - stress(r - h, theta).*member) / (2 * h);
      };
      const auto by_t = [&](auto member) {
        return (stress(r, theta + h).*member - stress(r, theta - h).*member) / (2 * h);
      };
      const double cot = 1 / std::tan(theta);
      const double radial = by_r(&Stress::rr) + by_t(&Stress::rt) / r + std::cos(theta) +
                            (cone ? (2 * s.rr - s.tt - s.cc + s.rt * cot) : (s.rr - s.tt)) / r;
      const double angular = by_r(&Stress::rt) + by_t(&Stress::tt) / r - std::sin(theta) +
                             (cone ? (3 * s.rt + (s.tt - s.cc) * cot) : 2 * s.rt) / r;
      CHECK(std::abs(radial) < 1e-6);  // of the differences
      CHECK(std::abs(angular) < 1e-6);
    }
    const Stress wall = stress(1, hopper.half_angle);
    CHECK(std::abs(std::abs(wall.rt) / wall.tt - std::tan(hopper.phi_w)) < 1e-9);
  }
}

TEST_CASE("radial: beyond the mass-flow limit there is no field") {
  // Close to Jenike's formula for cones, 90 - acos((1 - S)/(2 S))/2 - (psi_wall - 90): 38.0, 36.9, 27.0
  // degrees.
  const double limits[][3] = {{28, 15, 39.7}, {30, 15, 38.0}, {40, 20, 27.1}};
  for (const auto& [phi, phi_w, limit] : limits) {
    RadialHopper hopper{phi * degree, phi_w * degree, 0, true};
    const double found = mass_flow_limit(hopper) / degree;
    CHECK(std::abs(found - limit) < 0.1);
    hopper.half_angle = (found - 0.1) * degree;
    CHECK(radial_field(hopper));
    hopper.half_angle = (found + 0.1) * degree;
    CHECK_FALSE(radial_field(hopper));
  }
}

TEST_CASE("radial: the thesis's case has its root at q(0) = -0.74 in tension, with its wall angle only") {
  RadialHopper hopper{28 * degree, 15 * degree, 62 * degree, true};
  CHECK_FALSE(radial_field(hopper));
  hopper.wall = WallAngle::thesis;
  const auto field = radial_field(hopper);
  REQUIRE(field);
  CHECK(std::abs(-field->q_axis() + 0.744) < 5e-4);
  CHECK(*shooting_error(hopper, 0.73) > 0.003);
  CHECK(*shooting_error(hopper, 0.76) < -0.003);
}

TEST_CASE("the fit finds B and the discharge of a kinematic field, and a compromise for another") {
  const Floor floor = floor_with(two_orifices);
  for (const double B : {0.9, 2.24, 7.0}) {
    const KinematicFlow model(floor, B);
    std::vector<VelocitySample> samples;
    for (double y = 2; y < 140; y += 7)
      for (double x = 1; x < 150; x += 4) samples.push_back({x, y, 3.5 * model.at(x, y).v});
    const KinematicFit fit = fit_kinematic(floor, samples);
    CHECK(std::abs(fit.B / B - 1) < 1e-10);
    CHECK(std::abs(fit.factor / 3.5 - 1) < 1e-10);
    CHECK(fit.misfit < 1e-7);
    for (VelocitySample& s : samples) s.v *= 1 + 0.2 * std::sin(s.x + s.y);
    const KinematicFit rough = fit_kinematic(floor, samples);
    CHECK(rough.misfit > 0.05);
    for (const double other : {0.999 * rough.B, 1.001 * rough.B}) {  // no B beside it is better
      double vv = 0, vm = 0, mm = 0;
      const KinematicFlow beside(floor, other);
      for (const auto& [x, y, v] : samples) {
        const double m = beside.at(x, y).v;
        vv += v * v;
        vm += v * m;
        mm += m * m;
      }
      CHECK(1 - vm * vm / (mm * vv) > rough.misfit * rough.misfit);
    }
  }
  const std::vector<VelocitySample> still{{1, 1, 0}, {2, 3, 0}};
  CHECK_THROWS_AS(fit_kinematic(floor, still), std::invalid_argument);
}
