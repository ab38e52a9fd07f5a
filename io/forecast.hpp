#pragma once
// How many steps a scene will take, how long, and what it will write: `hourglass plan`. A small copy of the scene tells
// how fast grains move and leave, and what a step costs here and now; nothing is written. docs/plan.md has the accuracy.
#include <array>
#include <string>
#include <vector>

#include "solver/time_step.hpp"

namespace hourglass {

/// The flow after a step of the copy.
struct FlowSample {
  double t = 0;          ///< [T]
  FastestCells fastest;  ///< what the step after this one will see
  double mass = 0;       ///< of grains [M]
};

/// A few steps of a copy.
struct Trial {
  Patch patch;
  std::vector<FlowSample> flow;  ///< the first at t = 0
  /// Of the second half of the steps: quartiles, the median in the middle; 0: no step came out.
  std::array<double, 3> seconds_a_step{};
};

/// The scene on a grid halved while it has more than `most_cells` cells, as long as that remains a sound scene with
/// orifices of at least 8 cells; the scene itself where none is.
Scene coarsened(const Scene& scene, long most_cells);

/// Steps for so many seconds, not past its end.
Trial try_out(Simulation& simulation, double seconds);

struct StepForecast {
  long steps = 0;
  double t = 0;       ///< at the end [T]
  std::string ends;   ///< what will end the run
  std::string limit;  ///< what will rule most steps: a name of DtLimit
  bool sure = true;   ///< false: what ends it was extrapolated or is not predictable
};

/// Goes through the time steps that a run with this flow would choose (solver/time_step); beyond the last sample the
/// flow goes on as in the last half of them. Exact where dt_max rules.
StepForecast predict_steps(const Scene& scene, const Trial& flow);

struct Forecast {
  StepForecast steps;
  double step_seconds = 0, output_seconds = 0;  ///< all steps; all that is written or drawn
  long rows = 0, frames = 0, pictures = 0;      ///< of series.csv; of fields.h5; files
  double frame_bytes = 0;                       ///< all frames
  double picture_seconds = 0;                   ///< each, as timed now
  Patch timed;                                  ///< the copy that was timed
  std::array<double, 3> timed_seconds{};        ///< a step of it: quartiles
};

/// Runs two copies, for about two seconds together.
Forecast forecast(const Scene& scene);
std::string text_of(const Forecast& forecast, const Scene& scene);

}  // namespace hourglass
