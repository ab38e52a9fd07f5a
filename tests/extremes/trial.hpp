#pragma once
// One extreme scene in a process of its own, so that a crash or an endless loop is an outcome and not the end.
#include <array>
#include <map>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

/// How a scene may end, and how it must not.
enum class Outcome {
  finished,
  backed_off,  ///< and finished
  stopped,     ///< with a named cause, and the last good state
  refused,     ///< by check(), with a sentence
  // Forbidden:
  not_a_number,  ///< in a field or in the series
  hung,          ///< used more than its processor seconds
  crashed,
  mass_missed,  ///< mass_error > 1e-4 without a warning that says so
  silent_miss,  ///< missed tolerances without a warning
  no_cause,     ///< stopped without a reason
  runaway,  ///< grains a hundred times as fast as their fall could make them, without a warning of their speed
};
inline constexpr std::array outcome_names{"finished",     "backed_off", "stopped", "refused",
                                          "not_a_number", "hung",       "crashed", "mass_missed",
                                          "silent_miss",  "no_cause",   "runaway"};
inline bool is_forbidden(Outcome o) { return o >= Outcome::not_a_number; }

/// Cells of a table by column; "outcome" is one of outcome_names.
using Trial = std::map<std::string, std::string>;
const std::vector<std::string>& trial_columns();

/// Runs the scene in a child process. cpu_limit [s] of the processor.
Trial try_scene(const Scene& scene, double cpu_limit);

}  // namespace hourglass
