#include "io/raster.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hourglass {
namespace {

constexpr int n = 4;  // samples a pixel in each direction

}  // namespace

void Cover::add(const Polygon& polygon) {
  if (polygon.size() < 3) return;
  const auto [low, high] = std::minmax_element(polygon.begin(), polygon.end(),
                                               [](const auto& a, const auto& b) { return a[1] < b[1]; });
  const auto index = [](double at, int most) {  // of the first sample beyond
    return static_cast<int>(std::clamp(std::ceil(n * at - 0.5), 0.0, double(n * most)));
  };
  std::vector<double> crossings;
  for (int row = index((*low)[1], height_); row < index((*high)[1], height_); ++row) {
    const double y = (row + 0.5) / n;
    crossings.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const auto& a = polygon[k];
      const auto& b = polygon[k + 1 == polygon.size() ? 0 : k + 1];
      if ((a[1] <= y) != (b[1] <= y)) crossings.push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      for (int column = index(crossings[k], width_); column < index(crossings[k + 1], width_); ++column) {
        samples_[std::size_t(row / n) * width_ + column / n] |=
            static_cast<std::uint16_t>(1u << (n * (row % n) + column % n));
      }
    }
  }
}

double Cover::operator()(int a, int b) const { return std::popcount(at(a, b)) / double(n * n); }

bool Cover::holds(double x, double y) const {
  const int column = std::clamp(static_cast<int>(n * x), 0, n * width_ - 1),
            row = std::clamp(static_cast<int>(n * y), 0, n * height_ - 1);
  return at(column / n, row / n) >> (n * (row % n) + column % n) & 1;
}

void Strokes::add(const Polygon& points, double width, bool closed) {
  const double reach = width / 2 + 0.5;
  for (std::size_t k = closed ? 0 : 1; k < points.size(); ++k) {
    const auto& p = points[k];
    const auto& q = points[k == 0 ? points.size() - 1 : k - 1];
    const double ex = q[0] - p[0], ey = q[1] - p[1], length2 = ex * ex + ey * ey;
    const auto first = [&](int c) { return std::max(0.0, std::floor(std::min(p[c], q[c]) - reach)); };
    const auto last = [&](int c, int extent) {
      return static_cast<int>(std::min(extent - 1.0, std::max(p[c], q[c]) + reach));
    };
    for (int b = static_cast<int>(first(1)); b <= last(1, height_); ++b) {
      for (int a = static_cast<int>(first(0)); a <= last(0, width_); ++a) {
        const double x = a + 0.5 - p[0], y = b + 0.5 - p[1];
        const double along = length2 > 0 ? std::clamp((x * ex + y * ey) / length2, 0.0, 1.0) : 0;
        const double share = std::clamp(reach - std::hypot(x - along * ex, y - along * ey), 0.0, 1.0);
        float& here = shares_[std::size_t(b) * width_ + a];
        here = std::max(here, static_cast<float>(share));
      }
    }
  }
}

}  // namespace hourglass
