#pragma once
// The value at vanishing cells from values on a few grids: Richardson extrapolation at the observed order, with the
// error bar of Roache's grid convergence index (Roache 1994, J. Fluids Eng. 116:405).
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

namespace hourglass {

inline constexpr double assumed_order = 1.5;  ///< where two grids cannot tell
inline constexpr std::array<double, 2> credible_order{0.5,
                                                      2.5};  ///< of a scheme between first and second order
inline constexpr double gci_factor = 1.25;  ///< safety factor with an observed order (three grids)
inline constexpr double wide_gci_factor =
    3;  ///< with an assumed one (two grids), or one that is not to be trusted

struct Richardson {
  double value = 0;      ///< extrapolated
  double error_bar = 0;  ///< of it, either way; same unit
  double order = 0;      ///< that was used; 0: none, the value is that of the finest grid
  std::string doubt;     ///< why the error bar is a wide one, as the end of a sentence; empty: it is not
};

/// Values on grids each of which has cells `ratio` times smaller than the one before; the last three count, or both of
/// two. Throws std::invalid_argument for fewer.
inline Richardson richardson(std::span<const double> values, double ratio = 2) {
  if (values.size() < 2 || ratio <= 1)
    throw std::invalid_argument("Richardson needs two grids of different cells");
  const double fine = values.back(), last = fine - values[values.size() - 2];
  const auto at_order = [&](double p) {
    const double step = last / (std::pow(ratio, p) - 1);
    return Richardson{fine + step, std::abs(step), p, {}};
  };
  if (values.size() == 2) {
    Richardson r = at_order(assumed_order);
    r.error_bar *= wide_gci_factor;
    return r;
  }
  const double before = values[values.size() - 2] - values[values.size() - 3];
  if (last == 0 && before == 0) return {fine, 0, credible_order[1], {}};
  const double wide = wide_gci_factor * std::max(std::abs(last), std::abs(before));
  if (last * before < 0) return {fine, wide, 0, "does not approach its limit from one side"};
  const double observed = std::log(before / last) / std::log(ratio);  // infinite where either is 0
  Richardson r = at_order(std::clamp(observed, credible_order[0], credible_order[1]));
  if (r.order == observed) {
    r.error_bar *= gci_factor;
  } else {
    r.error_bar = wide;
    r.doubt = observed < r.order ? "hardly converges: its observed order is below 0.5"
                                 : "converges faster than the scheme: its observed order is above 2.5";
  }
  return r;
}

}  // namespace hourglass
