#pragma once
// Ranges and ticks of the axes of a chart: what its drawings have in common.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "io/chart.hpp"

namespace hourglass {

struct Extremes {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  void add(double value, bool log);
};

/// An axis whose range is fixed.
struct Scale {
  bool log;
  double lo, hi;

  Scale(const Axis& axis, std::array<double, 2> range) : log(axis.log), lo(range[0]), hi(range[1]) {}
  bool can_show(double value) const;
  /// 0 at the low end, 1 at the high one.
  double operator()(double value) const;
};

/// Of x and y: what the axes ask for, or all that is shown with some room.
std::pair<Scale, Scale> scales_of(const Chart& chart);

/// Ticks with at most `most` labels.
std::vector<Tick> ticks_of(double lo, double hi, bool log, int most);

}  // namespace hourglass
