#include "solver/models/kinematic.hpp"

namespace hourglass {
namespace {

constexpr double reach = 6.2;  // in s: erfc(6.2) < 2e-18

double bell(double t) { return std::exp(-t * t) / std::sqrt(M_PI); }

/// [erf(b) - erf(a)] / 2 with a < b, without cancellation in the tails.
double half_erf_between(double a, double b) {
  if (a > 0) return 0.5 * (std::erfc(a) - std::erfc(b));
  if (b < 0) return 0.5 * (std::erfc(-b) - std::erfc(-a));
  return 0.5 * (std::erf(b) - std::erf(a));
}

}  // namespace

PointVelocity KinematicFlow::at(double x, double y) const {
  const double s = std::sqrt(4 * B_ * y);
  return floor_.sum(x, reach * s, [&](double dx, double a, double q) -> PointVelocity {
    if (a == 0) {
      const double v = -q / s * bell(dx / s);
      return {B_ * v * 2 * dx / (s * s), v};
    }
    const double low = (dx - a) / s, high = (dx + a) / s;
    return {B_ * q / (2 * a * s) * (bell(high) - bell(low)), -q / (2 * a) * half_erf_between(low, high)};
  });
}

double KinematicFlow::dv_dB(double x, double y) const {
  const double s = std::sqrt(4 * B_ * y);
  const PointVelocity sum = floor_.sum(x, reach * s, [&](double dx, double a, double q) -> PointVelocity {
    if (a == 0) return {0, -q / s * bell(dx / s) * (dx * dx / (s * s) - 0.5) / B_};
    const double low = (dx - a) / s, high = (dx + a) / s;
    return {0, q / (4 * a * B_) * (high * bell(high) - low * bell(low))};
  });
  return sum.v;
}

}  // namespace hourglass
