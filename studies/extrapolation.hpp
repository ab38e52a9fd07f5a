#pragma once
// accuracy.extrapolate: the same scene on one or two coarser grids, and what its figures of merit tend to as the cells
// vanish (studies/richardson.hpp).
#include <optional>
#include <string>
#include <vector>

#include "studies/case.hpp"

namespace hourglass {

struct CoarseRuns {
  std::vector<CaseResult> cases;  ///< the coarsest first
  std::optional<CaseResult>
      half_steps;      ///< the coarsest once more, with steps half as long; with two coarser grids
  double seconds = 0;  ///< of wall clock, altogether
  std::string
      stopped;  ///< why there is no more of them: a run was interrupted or failed; empty: all ended well
  bool interrupted = false;  ///< by `interrupt`: then the run of the scene itself is not wanted either
};

/// Runs the scene on its coarser grids, one after the other, without output but with lines of progress. `interrupt` is
/// asked after every step.
CoarseRuns run_coarser(const Scene& scene, bool quiet, Observer& interrupt);

/// Sets summary.extrapolation from the run of the scene itself and those on coarser grids, over the window of time that
/// all of them have in common; what is doubtful of it, or why there is none, goes to summary.warnings.
void extrapolate(const CoarseRuns& coarse, Summary& summary);

}  // namespace hourglass
