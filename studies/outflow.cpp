#include "studies/outflow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/diagnostics.hpp"

namespace hourglass {
namespace {

constexpr int most_batches = 10;
constexpr std::size_t most_parts = 50;  ///< of E: finer, it is the noise of single rows
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
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
  double left = 0, tracer_left = 0, squares = 0;  // mass, of the tracer, its share squared by mass
  for (std::size_t k = 1; k < s.t.size(); ++k) {
    if (s.all[k] > trickle * most) {
      const double dt = s.t[k] - s.t[k - 1], dm = s.all[k] * dt, F = s.of_tracer[k] / s.all[k];
      out.t.push_back(0.5 * (s.t[k - 1] + s.t[k]));
      out.F.push_back(F);
      out.drained.push_back((left + 0.5 * dm) / s.mass);
      left += dm;
      tracer_left += F * dm;
      squares += F * F * dm;
    }
  }
  const double share = tracer_left / left, unmixed = share * (1 - share);
  out.mixing_index = unmixed > 0 ? 1 - (squares / left - share * share) / unmixed : unknown;
  if (out.F.empty()) return out;

  const auto last = static_cast<std::size_t>(std::ranges::max_element(out.F) - out.F.begin());
  // What leaves as tracer at once has no residence time.
  double rise = out.F[0], first = out.F[0] * s.t[0], second = out.F[0] * s.t[0] * s.t[0];
  for (std::size_t k = 1; k <= last; ++k) {
    const double dF = out.F[k] - out.F[k - 1], t = 0.5 * (out.t[k - 1] + out.t[k]);
    rise += dF;
    first += dF * t;
    second += dF * t * t;
  }
  out.mean = rise > 0 ? first / rise : unknown;
  out.variance = rise > 0 ? std::max(0.0, second / rise - out.mean * out.mean) : unknown;
  const std::size_t parts = std::min(last, most_parts);
  for (std::size_t p = 1; p <= parts; ++p) {
    const std::size_t a = (p - 1) * last / parts, b = p * last / parts;
    out.E_t.push_back(0.5 * (out.t[a] + out.t[b]));
    out.E.push_back((out.F[b] - out.F[a]) / (out.t[b] - out.t[a]));
  }
  return out;
}

}  // namespace hourglass
