#include "solver/models/stochastic.hpp"

#include <algorithm>

#include "solver/models/quadrature.hpp"

namespace hourglass {

namespace {

/// exp(s) K_n(s) = int_0^inf exp(-2 s sinh^2(t/2)) cosh(n t) dt by the trapezoidal rule, whose error falls
/// exponentially with 1/step (Trefethen & Weideman 2014, SIAM Review 56:385).
class BesselRule {
 public:
  explicit BesselRule(double step, double end) : step_(step) {
    for (double t = step; t < end; t += step)
      nodes_.push_back({2 * std::pow(std::sinh(t / 2), 2), std::cosh(t)});
  }
  std::array<double, 2> operator()(double s) const {
    double k0 = 0.5, k1 = 0.5;
    for (const auto& [exponent, cosh] : nodes_) {
      if (s * exponent > 48) break;
      const double value = std::exp(-s * exponent);
      k0 += value;
      k1 += value * cosh;
    }
    return {step_ * k0, step_ * k1};
  }

 private:
  double step_;
  std::vector<std::array<double, 2>> nodes_;
};

std::array<double, 2> asymptotic_bessel_k(double s) {
  std::array<double, 2> k{};
  for (int n = 0; n < 2; ++n) {
    double term = 1;
    for (int m = 1; std::abs(term) > 1e-17 && m < 40; ++m) {
      k[n] += term;
      term *= (4.0 * n * n - (2 * m - 1) * (2 * m - 1)) / (8.0 * m * s);
    }
    k[n] *= std::sqrt(M_PI / (2 * s));
  }
  return k;
}

}  // namespace

std::array<double, 2> scaled_bessel_k(double s) {
  static const BesselRule small(0.25, 14), middling(0.16, 4.5);
  if (s < 1e-3) return {std::exp(s) * std::cyl_bessel_k(0, s), std::exp(s) * std::cyl_bessel_k(1, s)};
  return s < 6 ? small(s) : s < 20 ? middling(s) : asymptotic_bessel_k(s);
}

PointVelocity StochasticFlow::point(double x, double y) const {
  const double R = std::hypot(x, y), s = R / L_;
  const double factor = std::exp(-x * x / ((R + y) * L_)) / (M_PI * L_);  // exp((y - R)/L), no cancellation
  const auto [k0, k1] = scaled_bessel_k(s);
  const double k2 = k0 + 2 * k1 / s;
  const double rho = factor * y * k1 / R;
  const double rho_x = -factor * x * y * k2 / (L_ * R * R);
  const double rho_y = rho / L_ + factor * k1 / R - factor * y * y * k2 / (L_ * R * R);
  return {0.5 * L_ * rho_x, 0.5 * L_ * rho_y - rho};
}

/// Even flux over `slot`, averaged over the spot: the points' weights are a trapezium.
PointVelocity StochasticFlow::spread(double x, double y, double slot) const {
  const double wide = std::max(slot, spot_), narrow = std::min(slot, spot_);
  if (wide == 0) return point(x, y);
  const double foot = 0.5 * (wide + narrow), top = 0.5 * (wide - narrow);
  const auto weighted = [&](double t) {
    const double weight = std::abs(t) <= top ? 1 / wide : (foot - std::abs(t)) / (wide * narrow);
    const PointVelocity flow = point(x - t, y);
    return std::array{weight * flow.u, weight * flow.v};
  };
  // The largest speed at this height is about the flux over the width that it has spread to.
  const double tolerance = 1e-13 / (wide + std::sqrt(L_ * y) + y);
  std::array<double, 2> sum{};
  double edges[5] = {-foot, -top, std::clamp(x, -top, top), top, foot};
  for (int k = 0; k < 4; ++k) {
    if (edges[k + 1] <= edges[k]) continue;
    const auto part = integral<2>(weighted, edges[k], edges[k + 1], tolerance);
    sum = {sum[0] + part[0], sum[1] + part[1]};
  }
  return {sum[0], sum[1]};
}

PointVelocity StochasticFlow::at(double x, double y) const {
  // exp((y - R)/L) < 1e-17 beyond: R - y > 39 L.
  const double reach = std::sqrt(39 * L_ * (39 * L_ + 2 * y)) + 0.5 * spot_;
  return floor_.sum(x, reach, [&](double dx, double half, double q) -> PointVelocity {
    const PointVelocity flow = spread(dx, y, 2 * half);
    return {q * flow.u, q * flow.v};
  });
}

}  // namespace hourglass
