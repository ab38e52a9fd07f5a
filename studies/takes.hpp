#pragma once
// What a row of numbers comes down to: the one number that a finding is held against.
#include <span>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

/// A run as a point: a quantity over an axis. Takes get them in the order of x.
struct TablePoint {
  double x = 0, y = 0;
  const Scene* scene = nullptr;  ///< for the widths of its orifices
};

/// Words of `take`; NaN where there are too few points for it, or a point has no number.
///
/// only           y of the one point there is
/// mean, min, max
/// spread         (max - min) / mean
/// largest_rise   the largest step up from one point to the next, over the mean size of y; 0 if y never rises
/// largest_fall   the same downwards
/// dip            the lesser of depth below the highest point before and of recovery to the highest point behind, each over
///                the lowest point's own y, at the point where that is most; 0 without a dip
/// dip_at         x of that point; NaN without a dip
/// last_change    size of the last step over the last y
/// order          observed order of convergence of the last three points, x the number of cells
/// beverloo_C, beverloo_k, beverloo_k_interval     of a fit with n held at 1.5 (5/2 around an axis) and k free
/// beverloo_misfit, beverloo_misfit_k0             standard deviation about the fit with k free, and k = 0, over the mean
inline const std::vector<std::string> take_words{"only",
                                                 "mean",
                                                 "min",
                                                 "max",
                                                 "spread",
                                                 "largest_rise",
                                                 "largest_fall",
                                                 "dip",
                                                 "dip_at",
                                                 "last_change",
                                                 "order",
                                                 "beverloo_C",
                                                 "beverloo_k",
                                                 "beverloo_k_interval",
                                                 "beverloo_misfit",
                                                 "beverloo_misfit_k0"};

/// Throws std::invalid_argument for another word.
double take(const std::string& word, std::span<const TablePoint> points);

}  // namespace hourglass
