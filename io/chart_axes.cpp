#include "io/chart_axes.hpp"

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

/// All that was added, with some room; on a log axis from and to a multiple of 1, 2 or 5 of a power of ten.
std::array<double, 2> roomy(const Extremes& e, bool log) {
  if (!(e.lo <= e.hi)) return log ? std::array{0.1, 10.0} : std::array{0.0, 1.0};
  if (log) {
    const auto beyond = [](double value, bool up) {
      const double power = std::pow(10, std::floor(std::log10(value)));
      double at = up ? 10 * power : power;
      for (const double m : {1.0, 2.0, 5.0})
        if (up ? m * power >= value && m * power < at : m * power <= value) at = m * power;
      return at;
    };
    return {beyond(e.lo / 1.15, false), beyond(e.hi * 1.15, true)};
  }
  if (e.hi == e.lo) return nice_range(e.lo, e.hi, false);
  const double room = 0.05 * (e.hi - e.lo);
  const bool from_zero = e.lo >= 0 && e.lo < 0.25 * e.hi;
  return {from_zero ? 0 : e.lo - room, e.hi <= 0 && e.hi > 0.25 * e.lo ? 0 : e.hi + room};
}

int labelled(const std::vector<Tick>& ticks) {
  return static_cast<int>(
      std::count_if(ticks.begin(), ticks.end(), [](const Tick& t) { return !t.label.empty(); }));
}

}  // namespace

void Extremes::add(double value, bool log) {
  if (!std::isfinite(value) || (log && value <= 0)) return;
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

bool Scale::can_show(double value) const { return std::isfinite(value) && (!log || value > 0); }

double Scale::operator()(double value) const {
  return log ? std::log(value / lo) / std::log(hi / lo) : (value - lo) / (hi - lo);
}

std::pair<Scale, Scale> scales_of(const Chart& chart) {
  Extremes x, y;
  for (const Series& s : chart.series) {
    for (const double v : s.x) x.add(v, chart.x.log);
    for (const auto* values : {&s.y, &s.lower, &s.upper})
      for (const double v : *values) y.add(v, chart.y.log);
    for (std::size_t k = 0; k < s.error.size(); ++k)
      for (const double sign : {-1.0, 1.0}) {
        const double end = s.y[k] + sign * s.error[k];
        if (!chart.y.log || end > 0.3 * s.y[k])
          y.add(end, chart.y.log);  // a bar down to 0 would rule the log axis
      }
  }
  for (const ReferenceLine& l : chart.lines) {
    const bool vertical = l.way == ReferenceLine::Way::vertical;
    (vertical ? x : y).add(l.at, (vertical ? chart.x : chart.y).log);
  }
  return {Scale(chart.x, chart.x.range.value_or(roomy(x, chart.x.log))),
          Scale(chart.y, chart.y.range.value_or(roomy(y, chart.y.log)))};
}

std::vector<Tick> ticks_of(double lo, double hi, bool log, int most) {
  if (!log) return linear_ticks(lo, hi, most);
  std::vector<Tick> ticks = log_ticks(lo, hi);
  if (labelled(ticks) < 2) return linear_ticks(lo, hi, most);
  const int every = (labelled(ticks) + most - 1) / most;
  int seen = 0;
  for (Tick& t : ticks)
    if (!t.label.empty() && seen++ % every != 0) t.label.clear();
  return ticks;
}

}  // namespace hourglass
