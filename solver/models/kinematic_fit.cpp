#include "solver/models/kinematic_fit.hpp"

#include <algorithm>
#include <stdexcept>

namespace hourglass {
namespace {

/// The best factor for a B.
KinematicFit at(const Floor& floor, double B, std::span<const VelocitySample> samples) {
  const KinematicFlow model(floor, B);
  double vv = 0, vm = 0, mm = 0;
  for (const auto& [x, y, v] : samples) {
    const double m = model.at(x, y).v;
    vv += v * v;
    vm += v * m;
    mm += m * m;
  }
  const double factor = mm > 0 ? vm / mm : 0;
  return {B, factor, std::sqrt(std::max(vv - factor * vm, 0.0) / vv)};
}

/// Change of B that brings the linearised misfit to its least, with the factor free.
double newton_step(const Floor& floor, const KinematicFit& now, std::span<const VelocitySample> samples) {
  const KinematicFlow model(floor, now.B);
  double aa = 0, ab = 0, bb = 0, ar = 0, br = 0;  // a: by the factor, b: by B
  for (const auto& [x, y, v] : samples) {
    const double a = model.at(x, y).v, b = now.factor * model.dv_dB(x, y), r = v - now.factor * a;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    ar += a * r;
    br += b * r;
  }
  const double determinant = aa * bb - ab * ab;
  return determinant > 0 ? (aa * br - ab * ar) / determinant : 0;
}

}  // namespace

KinematicFit fit_kinematic(const Floor& floor, std::span<const VelocitySample> samples) {
  const auto moves = [](const VelocitySample& s) { return s.v != 0 && std::isfinite(s.v); };
  if (std::ranges::none_of(samples, moves)) throw std::invalid_argument("there is no flow to fit to");
  KinematicFit best{0, 0, HUGE_VAL};
  for (double share = 1e-4; share <= 1; share *= 1.25)
    if (const KinematicFit one = at(floor, share * floor.width, samples); one.misfit < best.misfit)
      best = one;
  for (int k = 0; k < 100; ++k) {
    double step = std::clamp(newton_step(floor, best, samples), -0.5 * best.B, best.B);
    KinematicFit next = at(floor, best.B + step, samples);
    while (next.misfit > best.misfit && std::abs(step) > 1e-15 * best.B)
      next = at(floor, best.B + (step *= 0.5), samples);
    if (next.misfit > best.misfit) break;
    best = next;
    if (std::abs(step) <= 1e-13 * best.B) break;
  }
  return best;
}

}  // namespace hourglass
