#pragma once
// The law of Beverloo, Leniger & van de Velde (1961) for the discharge of orifices, fitted to rates by nonlinear least
// squares: Q = C rho sqrt(g) d^m sum_i (W_i/d - k)^n, n = m = 1.5 in two dimensions. With n free, C has the scale d^m of
// the fixed exponent, so that it stays a number.
#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

struct DischargePoint {
  std::vector<double> widths;  ///< of all orifices [d]
  double rate = 0;             ///< over rho sqrt(g) d^m
};

/// All orifices of the whole silo, and its rate [M/T].
DischargePoint discharge_point(const Scene& scene, double rate);

struct BeverlooFit {
  std::array<double, 3> value{};  ///< C, k, n
  /// Half of the 95 % confidence interval of each: 0 for one that was held, NaN where there are as many points as free
  /// parameters.
  std::array<double, 3> interval{};
  double residual =
      0;  ///< standard deviation of the points about the fit, over rho sqrt(g) d^m; NaN as above

  double rate(const std::vector<double>& widths) const;
  /// Half of the 95 % confidence interval of rate().
  double rate_interval(const std::vector<double>& widths) const;

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of C, k, n
  double student = 0;  ///< 97.5 % point of Student's t for the points left over
};

/// What is held; the others are free. C is always free.
struct BeverlooHeld {
  std::optional<double> k{}, n{};
};

/// Levenberg and Marquardt, from k = 0 and n = `start_n`. Throws std::invalid_argument if there are fewer points than free
/// parameters, or widths that are not above 0.
BeverlooFit fit_beverloo(const std::vector<DischargePoint>& points, const BeverlooHeld& held,
                         double start_n = 1.5);

/// 97.5 % point of Student's t with so many degrees of freedom (> 0): 95 % lie within.
double student_t(int freedom);

}  // namespace hourglass
