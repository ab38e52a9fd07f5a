#include "studies/outflow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/diagnostics.hpp"

namespace hourglass {
namespace {

constexpr int most_batches = 10;
constexpr double trickle = 0.01;  ///< of the largest outflow: shares of less are noise

}  // namespace

RateEstimate rate_with_error(const History& mass, double from, double to) {
  RateEstimate out{loss_rate(mass, from, to), {}, from, to, 0};
  History inside;
  std::ranges::copy_if(mass, std::back_inserter(inside),
                       [&](const auto& sample) { return sample[0] >= from && sample[0] <= to; });
  const long intervals = std::ssize(inside) - 1;
  out.batches = static_cast<int>(std::clamp(intervals / 2, 0L, long{most_batches}));
  if (out.batches < 2) return out;
  double sum = 0, squares = 0;
  for (int b = 0; b < out.batches; ++b) {
    const auto& first = inside[static_cast<std::size_t>(b * intervals / out.batches)];
    const auto& last = inside[static_cast<std::size_t>((b + 1) * intervals / out.batches)];
    const double deviation = (first[1] - last[1]) / (last[0] - first[0]) - out.rate;
    sum += deviation;
    squares += deviation * deviation;
  }
  const double n = out.batches;
  out.standard_error = std::sqrt(std::max(0.0, squares - sum * sum / n) / (n * (n - 1)));
  return out;
}

StepResponse step_response(const OutflowSeries& s) {
  StepResponse out;
  const double most = s.all.size() > 1 ? *std::max_element(s.all.begin() + 1, s.all.end()) : 0;
  const double share = s.mass > 0 ? s.tracer_mass / s.mass : 0, before_tracer = s.mass - s.tracer_mass;
  double left = 0, tracer_left = 0, above = 0, above_mixed = 0;
  for (std::size_t k = 1; k < s.t.size(); ++k) {
    const double dt = s.t[k] - s.t[k - 1], dm = s.all[k] * dt, middle = left + 0.5 * dm;
    const double first_out = std::max(0.0, middle - before_tracer);
    above += (tracer_left + 0.5 * s.of_tracer[k] * dt - first_out) * dm;
    above_mixed += (share * middle - first_out) * dm;
    if (s.all[k] > trickle * most) {
      out.t.push_back(0.5 * (s.t[k - 1] + s.t[k]));
      out.F.push_back(s.of_tracer[k] / s.all[k]);
      out.drained.push_back(s.mass > 0 ? middle / s.mass : 0);
    }
    left += dm;
    tracer_left += s.of_tracer[k] * dt;
  }
  // What leaves as tracer at once has no residence time.
  const double at_once = out.F.empty() ? 0 : out.F.front(), begin = s.t.empty() ? 0 : s.t.front();
  double rise = at_once, first = at_once * begin;
  for (std::size_t k = 1; k < out.t.size(); ++k) {
    const double dF = out.F[k] - out.F[k - 1];
    out.E_t.push_back(0.5 * (out.t[k - 1] + out.t[k]));
    out.E.push_back(dF / (out.t[k] - out.t[k - 1]));
    rise += dF;
    first += dF * out.E_t.back();
  }
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  out.mean = rise > 0 ? first / rise : nothing;
  out.variance = at_once * std::pow(begin - out.mean, 2);
  for (std::size_t k = 0; k < out.E.size(); ++k)
    out.variance += std::pow(out.E_t[k] - out.mean, 2) * (out.F[k + 1] - out.F[k]);
  out.variance = rise > 0 ? out.variance / rise : nothing;
  out.mixing_index = above_mixed > 0 ? above / above_mixed : nothing;
  return out;
}

}  // namespace hourglass
