#pragma once
// Orifices in the floor as sources of a linear model: half-plane y > 0, gravity along -y, side walls by
// images.
#include <cmath>
#include <utility>
#include <vector>

namespace hourglass {

/// Velocity [L/T].
struct PointVelocity {
  double u = 0, v = 0;
};

/// A stretch of the floor through which grains leave evenly; from == to is a point.
struct FloorSource {
  double from = 0, to = 0;  ///< [L]
  double rate = 0;          ///< volume per unit depth and time, > 0 [L^2/T]
};

/// What stands at the sides x = 0 and x = width. A closed side lets nothing through: beyond it stands the
/// mirror image. `periodic` goes for both.
enum class SideImages { open, closed, periodic };

/// Calls f(centre) for every image of a source at x0 within `reach` of x, itself included. Sources are
/// symmetric, so that mirror images and copies are alike.
template <class F>
void for_each_image(double x, double x0, double width, SideImages left, SideImages right, double reach,
                    F&& f) {
  const bool both = left == SideImages::closed && right == SideImages::closed;
  const bool periodic = left == SideImages::periodic;
  const double period = periodic ? width : both ? 2 * width : 0;
  const auto family = [&](double centre) {
    if (period == 0) {
      f(centre);
      return;
    }
    const auto first = static_cast<long>(std::ceil((x - reach - centre) / period));
    const auto last = static_cast<long>(std::floor((x + reach - centre) / period));
    for (long k = first; k <= last; ++k) f(centre + static_cast<double>(k) * period);
  };
  family(x0);
  if (left == SideImages::closed)
    family(-x0);
  else if (right == SideImages::closed)
    family(2 * width - x0);
}

/// The floor and the sides of a linear model.
struct Floor {
  double width = 0;  ///< of the domain [L]
  SideImages left = SideImages::closed, right = SideImages::closed;
  std::vector<FloorSource> sources;

  /// Sum over sources and images of one(x - middle, half-width, rate). `reach` [L]: beyond
  /// it from its ends a source is not felt.
  template <class F>
  PointVelocity sum(double x, double reach, F&& one) const {
    PointVelocity total;
    for (const FloorSource& s : sources) {
      const double half = 0.5 * (s.to - s.from);
      for_each_image(x, 0.5 * (s.from + s.to), width, left, right, reach + half, [&](double centre) {
        const PointVelocity flow = one(x - centre, half, s.rate);
        total.u += flow.u;
        total.v += flow.v;
      });
    }
    return total;
  }
};

}  // namespace hourglass
