#include "studies/beverloo.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "solver/diagnostics.hpp"

namespace hourglass {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double sum_of(const std::vector<double>& widths, double k, double n) {
  double sum = 0;
  for (const double width : widths)
    if (width > k) sum += std::pow(width - k, n);
  return sum;
}

/// Derivatives of the rate by C, k and n.
Eigen::Vector3d slope(const std::array<double, 3>& p, const std::vector<double>& widths) {
  const auto [C, k, n] = p;
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (const double width : widths) {
    const double free = width - k;
    if (free <= 0) continue;
    d += Eigen::Vector3d{std::pow(free, n), -C * n * std::pow(free, n - 1),
                         C * std::pow(free, n) * std::log(free)};
  }
  return d;
}

using Free = std::array<bool, 3>;

/// Sum of squares at p, half its gradient and the normal matrix; of held parameters the matrix has the rows of the identity.
struct Normal {
  double squares = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();

  Normal(const std::vector<DischargePoint>& points, const std::array<double, 3>& p, const Free& free) {
    for (const DischargePoint& point : points) {
      const double residual = p[0] * sum_of(point.widths, p[1], p[2]) - point.rate;
      Eigen::Vector3d d = slope(p, point.widths);
      for (int i = 0; i < 3; ++i)
        if (!free[i]) d[i] = 0;
      squares += residual * residual;
      gradient += residual * d;
      matrix += d * d.transpose();
    }
    for (int i = 0; i < 3; ++i)
      if (!free[i]) matrix(i, i) = 1;
  }
};

/// Share of Student's t within -t..t: Abramowitz & Stegun 26.7.3 and 26.7.4.
double share_within(double t, int freedom) {
  const double angle = std::atan(t / std::sqrt(freedom)), c = std::cos(angle);
  const bool odd = freedom % 2 == 1;
  double term = odd ? c : 1, sum = freedom == 1 ? 0 : term;
  for (int k = odd ? 3 : 2; k <= freedom - 2; k += 2) {
    term *= c * c * (k - 1) / k;
    sum += term;
  }
  return odd ? 2 / M_PI * (angle + std::sin(angle) * sum) : std::sin(angle) * sum;
}

}  // namespace

double student_t(int freedom) {
  if (freedom < 1) throw std::invalid_argument("Student's t needs a degree of freedom");
  double low = 1.9, high = 13;
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (share_within(middle, freedom) < 0.95 ? low : high) = middle;
  }
  return high;
}

double BeverlooFit::rate(const std::vector<double>& widths) const {
  return value[0] * sum_of(widths, value[1], value[2]);
}
double BeverlooFit::rate_interval(const std::vector<double>& widths) const {
  const Eigen::Vector3d d = slope(value, widths);
  return student * std::sqrt(d.dot(covariance * d));
}

DischargePoint discharge_point(const Scene& scene, double rate) {
  const double d = scene.materials[0].diameter;
  DischargePoint point{{}, rate / discharge_scale(scene, d)};
  for (const Orifice& orifice : scene.orifices)
    point.widths.insert(point.widths.end(), static_cast<std::size_t>(images(scene, orifice)),
                        orifice.width / d);
  return point;
}

BeverlooFit fit_beverloo(const std::vector<DischargePoint>& points, const BeverlooHeld& held,
                         double start_n) {
  const Free free{true, !held.k, !held.n};
  const auto spare = std::ssize(points) - std::ranges::count(free, true);
  if (spare < 0) throw std::invalid_argument("a fit needs as many points as it has free parameters");
  BeverlooFit fit;
  std::array<double, 3>& p = fit.value;
  p = {0, held.k.value_or(0), held.n.value_or(start_n)};
  double qw = 0, ww = 0;
  for (const DischargePoint& point : points) {
    for (const double width : point.widths)
      if (!(width > 0)) throw std::invalid_argument("a width of an orifice is not above 0");
    const double w = sum_of(point.widths, p[1], p[2]);
    qw += point.rate * w;
    ww += w * w;
  }
  p[0] = ww > 0 ? qw / ww : 1;

  Normal at(points, p, free);
  for (double damping = 1e-3; damping < 1e20;) {
    Eigen::Matrix3d damped = at.matrix;
    damped.diagonal() *= 1 + damping;
    const Eigen::Vector3d step = damped.inverse() * at.gradient;
    const std::array<double, 3> next{p[0] - step[0], p[1] - step[1], p[2] - step[2]};
    const Normal there(points, next, free);
    const bool better = there.squares < at.squares;
    if (better) {
      p = next;
      at = there;
    }
    damping = better ? std::max(0.1 * damping, 1e-12) : 10 * damping;
  }
  fit.student = spare > 0 ? student_t(static_cast<int>(spare)) : unknown;
  fit.residual = spare > 0 ? std::sqrt(at.squares / static_cast<double>(spare)) : unknown;
  const Eigen::Matrix3d inverse = at.matrix.inverse();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (free[i] && free[j]) fit.covariance(i, j) = fit.residual * fit.residual * inverse(i, j);
  for (int i = 0; i < 3; ++i)
    if (free[i]) fit.interval[i] = fit.student * std::sqrt(fit.covariance(i, i));
  return fit;
}

}  // namespace hourglass
