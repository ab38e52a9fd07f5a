#pragma once
// Adaptive integration of several functions at once.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hourglass {

/// Integral of f from a to b, each component with an absolute error below `tolerance`: Gauss and Kronrod's 7
/// and 15 points (Piessens et al. 1983, QUADPACK), halved where they differ by more, at most `depth` times.
template <std::size_t n, class F>
std::array<double, n> integral(F&& f, double a, double b, double tolerance, int depth = 40) {
  static constexpr double x[8] = {0,
                                  0.207784955007898467600689403773245,
                                  0.405845151377397166906606412076961,
                                  0.586087235467691130294144691693013,
                                  0.741531185599394439863864773280788,
                                  0.864864423359769072789712788640926,
                                  0.949107912342758524526189684047851,
                                  0.991455371120812639206854697526329};
  static constexpr double kronrod[8] = {
      0.209482141084727828012999174891714, 0.204432940075298892414161999234649,
      0.190350578064785409913256402421014, 0.169004726639267902826583426598550,
      0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
      0.063092092629978553290700663189204, 0.022935322010529224963732008058970};
  static constexpr double gauss[4] = {
      0.417959183673469387755102040816327, 0.381830050505118944950369775488975,
      0.279705391489276667901467771423780, 0.129484966168869693270611432679082};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  std::array<double, n> fine{}, coarse{}, largest{};
  for (int k = 0; k < 8; ++k)
    for (const double sign : {-1.0, 1.0}) {
      if (k == 0 && sign > 0) continue;
      const std::array<double, n> value = f(middle + sign * half * x[k]);
      for (std::size_t i = 0; i < n; ++i) {
        fine[i] += half * kronrod[k] * value[i];
        largest[i] = std::max(largest[i], std::abs(value[i]));
        if (k % 2 == 0) coarse[i] += half * gauss[k / 2] * value[i];
      }
    }
  double off = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double difference = std::abs(fine[i] - coarse[i]), size = half * largest[i];
    // Kronrod's error is far below the difference: QUADPACK's estimate of it.
    off = std::max(off, size > 0 ? size * std::min(1.0, std::pow(200 * difference / size, 1.5)) : 0);
  }
  if (off <= tolerance || depth == 0) return fine;
  fine = integral<n>(f, a, middle, 0.5 * tolerance, depth - 1);
  coarse = integral<n>(f, middle, b, 0.5 * tolerance, depth - 1);
  for (std::size_t i = 0; i < n; ++i) fine[i] += coarse[i];
  return fine;
}

}  // namespace hourglass
