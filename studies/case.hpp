#pragma once
// One scene run within this process, without a folder: what every study is made of.
#include <functional>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {

struct CaseResult {
  Summary summary;
  std::vector<SeriesRow> series;
  double cpu_seconds =
      0;  ///< of all threads of the process while it ran: what a busy machine does not stretch
  bool failed() const { return summary.status == Status::diverged || summary.status == Status::interrupted; }
};

/// What happens to a case besides: observers are told as in Simulation::run().
struct CaseOptions {
  std::vector<Observer*> observers{};
  std::function<void(Simulation&)> prepare{};  ///< before the first step: initial conditions
  std::function<void(const Simulation&)> at_end{};
};

/// Runs the scene, which must be free of fatal problems. A case that cannot begin (no memory) has status interrupted.
/// A model in closed form has one row and neither `prepare` nor `at_end`.
CaseResult run_case(const Scene& scene, const CaseOptions& options = {});

}  // namespace hourglass
