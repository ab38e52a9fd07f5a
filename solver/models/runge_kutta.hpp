#pragma once
// Error-controlled integration of small systems of ordinary differential equations.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hourglass {

/// y(to) of y' = f(x, y), y(from) given, by the pair of orders 5 and 4 of Dormand & Prince 1980 (Journal of
/// Computational and Applied Mathematics 6:19), each step with an error below `tolerance` max(1, |y|). Ends
/// early, at what is returned in `from`, where a step would have to be too short (a singular point) or y is
/// no number.
template <std::size_t n, class F>
std::array<double, n> integrate(F&& f, double& from, double to, std::array<double, n> y, double tolerance) {
  using State = std::array<double, n>;
  static constexpr double a[7][6] = {
      {},
      {1.0 / 5},
      {3.0 / 40, 9.0 / 40},
      {44.0 / 45, -56.0 / 15, 32.0 / 9},
      {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
      {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
      {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
  static constexpr double c[7] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
  static constexpr double e[7] = {
      // order 5 less order 4
      71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
  const double length = to - from, shortest = 1e-9 * std::abs(length);
  double h = 0.01 * length;
  while (std::abs(to - from) > 1e-14 * std::abs(length)) {
    if (std::abs(h) > std::abs(to - from)) h = to - from;
    State k[7], end{}, error{};
    for (int stage = 0; stage < 7; ++stage) {
      end = y;
      for (int s = 0; s < stage; ++s)
        for (std::size_t i = 0; i < n; ++i) end[i] += h * a[stage][s] * k[s][i];
      k[stage] = f(from + c[stage] * h, end);
    }
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (int s = 0; s < 7; ++s) error[i] += h * e[s] * k[s][i];
      const double one = std::abs(error[i]) / (tolerance * std::max(1.0, std::abs(y[i])));
      worst = std::isfinite(one) ? std::max(worst, one) : HUGE_VAL;
    }
    if (worst <= 1) {
      from += h;
      y = end;
    }
    h *= worst == 0 ? 5 : std::isfinite(worst) ? std::clamp(0.9 * std::pow(worst, -0.2), 0.1, 5.0) : 0.1;
    if (std::abs(h) < shortest && std::abs(to - from) > shortest) return y;
  }
  from = to;
  return y;
}

}  // namespace hourglass
