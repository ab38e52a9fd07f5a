#pragma once
// What the outflow of a stored run tells: its rate and how sure it is, and how materials leave one after the other.
#include <optional>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {

struct RateEstimate {
  double rate = 0;  ///< least-squares slope of mass over time, negated [M/T]
  /// Of the rate, from the scatter of the means over `batches` equal parts of the window, long against what rows that
  /// follow each other have in common (Schmeiser 1982, Oper. Res. 30); nothing with fewer than two parts.
  std::optional<double> standard_error;
  double from = 0, to = 0;  ///< [T]
  int batches = 0;
};

/// The rate between two times. Ten parts; fewer where a part would hold fewer than two intervals between samples.
RateEstimate rate_with_error(const History& mass, double from, double to);

/// Outflow by intervals between the times t[k-1] and t[k]; the values at k = 0 do not count.
struct OutflowSeries {
  std::vector<double> t;               ///< [T]
  std::vector<double> all, of_tracer;  ///< mean over the interval [M/T]
  double mass = 0, tracer_mass = 0;    ///< in the silo at t[0]
};

/// The response of the outflow to a step change of what is above it (Danckwerts 1953, Chem. Eng. Sci. 2).
struct StepResponse {
  std::vector<double> t;        ///< middle of each interval [T]
  std::vector<double> F;        ///< share of the tracer in the outflow of the interval
  std::vector<double> drained;  ///< share of the silo's first mass that has left by then
  /// Residence-time distribution dF/dt until F is greatest, over at most 50 equal parts of that time, and the middle of each
  /// [1/T], [T]. What drains from the corners of a silo after that has not come later, but lay there.
  std::vector<double> E, E_t;
  double mean = 0, variance = 0;  ///< of that residence time [T], [T^2]; NaN if F never rises
  /// 1 less the intensity of segregation of the outflow (Danckwerts 1952, Appl. Sci. Res. A 3): 0 if it is one material or
  /// the other at any time, 1 if the share never changes; NaN where but one has left.
  double mixing_index = 0;
};

/// Intervals that pass less than 1 % of the largest outflow are left out of F.
StepResponse step_response(const OutflowSeries& series);

}  // namespace hourglass
