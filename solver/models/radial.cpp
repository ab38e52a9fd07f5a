#include "solver/models/radial.hpp"

#include <algorithm>
#include <cmath>

#include "solver/models/quadrature.hpp"
#include "solver/models/runge_kutta.hpp"

namespace hourglass {
namespace {

constexpr double tolerance = 1e-12, rough = 1e-8;  // of the integration

/// q', psi' at theta.
std::array<double, 2> slope_of(const RadialHopper& h, double theta, double q, double psi) {
  const double S = std::sin(h.phi);
  if (theta == 0) return {0, (1 + q * (1 - (h.cone ? 5 : 3) * S)) / ((h.cone ? 4 : 2) * q * S)};
  const double c = std::cos(2 * psi), s = std::sin(2 * psi), cot = 1 / std::tan(theta);
  const double A = S * s, B = 2 * q * S * c, D = 1 - S * c, E = 2 * q * S * s;
  const double C = std::cos(theta) + (h.cone ? q * (1 - S + S * (4 * c + s * cot)) : q * (1 + 3 * S * c));
  const double F = (h.cone ? q * S * (4 * s - (1 + c) * cot) : 3 * q * S * s) - std::sin(theta);
  const double determinant = 2 * q * S * (c - S);
  return {(C * E - B * F) / determinant, (A * F - C * D) / determinant};
}

std::array<double, 3> slopes(const RadialHopper& h, double theta, const std::array<double, 3>& y) {
  const auto [dq, dpsi] = slope_of(h, theta, y[0], y[1]);
  return {dq, dpsi, -(h.cone ? 3 : 2) * std::tan(2 * y[1])};
}

std::optional<double> shoot(const RadialHopper& h, double q_axis, double error) {
  double theta = 0;
  const auto f = [&](double at, const std::array<double, 2>& y) { return slope_of(h, at, y[0], y[1]); };
  const auto y = integrate<2>(f, theta, h.half_angle, {q_axis, M_PI / 2}, error);
  if (theta != h.half_angle || !std::isfinite(y[1])) return std::nullopt;
  return y[1] - h.psi_wall();
}

}  // namespace

double RadialHopper::psi_wall() const {
  if (wall == WallAngle::thesis) return M_PI / 2 - phi_w;
  return M_PI / 2 + 0.5 * (phi_w + std::asin(std::min(std::sin(phi_w) / std::sin(phi), 1.0)));
}

std::optional<double> shooting_error(const RadialHopper& h, double q_axis) {
  return shoot(h, q_axis, tolerance);
}

std::optional<RadialField> radial_field(const RadialHopper& hopper) {
  // A large q on the axis leaves psi below what the wall asks for; come down to the first that brings it
  // above.
  double high = 20, low = 0;
  std::optional<double> error = shooting_error(hopper, high);
  if (!error || *error > 0) return std::nullopt;
  for (double q = high / 1.05; q > 1e-3 && low == 0; q /= 1.05) {
    error = shoot(hopper, q, rough);
    if (!error || *error > 0)
      low = q;
    else
      high = q;
  }
  if (low == 0) return std::nullopt;
  for (int k = 0; k < 60 && low < high; ++k) {
    const double middle = 0.5 * (low + high);
    error = shooting_error(hopper, middle);
    (!error || *error > 0 ? low : high) = middle;
  }
  error = shooting_error(hopper, high);
  if (!error || std::abs(*error) > 1e-8) return std::nullopt;  // the jump to a singular solution, no root

  constexpr int intervals = 512;
  RadialField field;
  field.hopper_ = hopper;
  std::array<double, 3> y{high, M_PI / 2, 0};
  const auto f = [&](double at, const std::array<double, 3>& state) { return slopes(hopper, at, state); };
  for (int k = 0; k <= intervals; ++k) {
    if (k > 0) {
      double theta = hopper.half_angle * (k - 1) / intervals;
      const double to = hopper.half_angle * k / intervals;
      y = integrate<3>(f, theta, to, y, tolerance);
      if (theta != to) return std::nullopt;
    }
    if (!(y[1] < 0.75 * M_PI && y[1] > 0.25 * M_PI)) return std::nullopt;
    field.nodes_.push_back({y, slopes(hopper, hopper.half_angle * k / intervals, y)});
  }
  return field;
}

RadialField::Point RadialField::at(double theta) const {
  const auto intervals = static_cast<double>(nodes_.size() - 1);
  const double h = hopper_.half_angle / intervals;
  const double place = std::clamp(theta / h, 0.0, intervals);
  const auto k = static_cast<std::size_t>(std::min(place, intervals - 1));
  const double t = place - static_cast<double>(k), s = 1 - t;
  std::array<double, 3> y{};
  for (std::size_t i = 0; i < 3; ++i)  // cubic, by values and slopes
    y[i] = s * s * ((1 + 2 * t) * nodes_[k].y[i] + t * h * nodes_[k].slope[i]) +
           t * t * ((1 + 2 * s) * nodes_[k + 1].y[i] - s * h * nodes_[k + 1].slope[i]);
  return {y[0], y[1], std::exp(y[2])};
}

double RadialField::flux() const {
  const auto f = [&](double theta) {
    return std::array{2 * at(theta).f * (hopper_.cone ? M_PI * std::sin(theta) : 1)};
  };
  return integral<1>(f, 0, hopper_.half_angle, 1e-12)[0];
}

double mass_flow_limit(RadialHopper hopper) {
  const auto flows = [&](double half_angle) {
    hopper.half_angle = half_angle;
    return radial_field(hopper).has_value();
  };
  double low = 1e-3, high = M_PI / 2 - 1e-3;
  while (high - low > 1e-4) {
    const double middle = 0.5 * (low + high);
    (flows(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace hourglass
