#include "studies/extrapolation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/progress.hpp"
#include "solver/diagnostics.hpp"
#include "solver/timers.hpp"
#include "studies/richardson.hpp"

namespace hourglass {
namespace {

/// Shows how far a coarse run has come, and passes on the wish to end.
class CoarseProgress : public Observer {
 public:
  CoarseProgress(const Scene& scene, bool quiet, Observer& interrupt)
      : progress_(quiet), interrupt_(interrupt) {
    const Patch patch = scene.patch();
    grid_ = fmt::format("extrapolation: {} x {}", patch.nx, patch.ny);
  }
  void on_step(const StepReport& report, double fraction_done) override {
    if (progress_.due(fraction_done))
      progress_.show(fraction_done, fmt::format("{}  t {:.4g}", grid_, report.t));
  }
  std::string interrupt() override { return interrupt_.interrupt(); }

 private:
  Progress progress_;
  Observer& interrupt_;
  std::string grid_;
};

/// A change of the discharge by half the steps' length that deserves a word.
constexpr double step_doubt = 0.02;

Scene without_output(Scene scene) {
  scene.output.fields_every = scene.output.snapshots_every = 0;
  return scene;
}

}  // namespace

CoarseRuns run_coarser(const Scene& scene, bool quiet, Observer& interrupt) {
  CoarseRuns runs;
  const auto start = Clock::now();
  const auto run = [&](const Scene& coarse) {
    CoarseProgress progress(coarse, quiet, interrupt);
    CaseResult result = run_case(coarse, {.observers = {&progress}});
    if (result.failed()) {
      runs.stopped = fmt::format("{} cells across: {}", coarse.cells_x, result.summary.reason);
      runs.interrupted = !interrupt.interrupt().empty();
    }
    return result;
  };
  const int most = scene.accuracy.extrapolate;
  for (int halvings = most; halvings > 0 && runs.stopped.empty(); --halvings)
    runs.cases.push_back(run(without_output(coarser(scene, halvings))));
  if (most == 2 && runs.stopped.empty()) {
    Scene careful = without_output(coarser(scene, most));
    careful.time.dt_max /= 2;
    careful.time.cfl /= 2;
    runs.half_steps = run(careful);
  }
  runs.seconds = seconds_since(start);
  return runs;
}

void extrapolate(const CoarseRuns& coarse, Summary& summary) {
  const auto none = [&](const std::string& why) {
    summary.warnings.push_back("nothing is extrapolated: " + why);
  };
  if (!coarse.stopped.empty()) return none(coarse.stopped);
  if (summary.status != Status::finished && summary.status != Status::stopped)
    return none("the run has not ended well");
  for (const CaseResult& c : coarse.cases)
    if (c.summary.missed_tolerances > 0)
      summary.warnings.push_back(fmt::format("the coarser run with {} cells missed {} tolerances",
                                             c.summary.cells, c.summary.missed_tolerances));
  std::vector<const Summary*> grids;
  for (const CaseResult& c : coarse.cases) grids.push_back(&c.summary);
  grids.push_back(&summary);
  double from = 0, to = INFINITY;
  for (const Summary* s : grids) {
    from = std::max(from, s->discharge_window[0]);
    to = std::min(to, s->discharge_window[1]);
  }
  const double window = summary.discharge_window[1] - summary.discharge_window[0];
  if (!(to - from > 0.5 * window)) return none("the grids discharge at different times");

  Extrapolation e;
  std::vector<double> shares;
  for (const Summary* s : grids) {
    e.cells.push_back(s->cells);
    e.discharge_rates.push_back(loss_rate(s->mass_over_time, from, to));
    const auto share = mean_over(s->quasi_static_over_time, from, to);
    shares.push_back(share ? *share : s->quasi_static_fraction);
  }
  const Richardson rate = richardson(e.discharge_rates), share = richardson(shares);
  e.order = rate.order;
  e.discharge_rate = rate.value;
  e.error_bar = rate.error_bar;
  e.quasi_static_fraction = std::clamp(share.value, 0.0, 1.0);
  e.quasi_static_error_bar = std::min(share.error_bar, 1.0);
  e.seconds = coarse.seconds;
  if (coarse.half_steps && e.discharge_rates.front() != 0) {
    const double halved = loss_rate(coarse.half_steps->summary.mass_over_time, from, to);
    e.step_change = halved / e.discharge_rates.front() - 1;
    if (std::abs(*e.step_change) > step_doubt)
      summary.warnings.push_back(
          fmt::format("the discharge depends on the time step: {:+.2g} of it with steps half as long on the "
                      "coarsest grid; "
                      "take a smaller time.dt_max, and see whether the pressure is sane",
                      *e.step_change));
  }
  summary.extrapolation = e;
  const auto doubt = [&](const char* what, const Richardson& r) {
    if (!r.doubt.empty())
      summary.warnings.push_back(
          fmt::format("the {} {}; the error bar of its extrapolation is a wide one", what, r.doubt));
  };
  doubt("discharge rate", rate);
  doubt("quasi-static share", share);
}

}  // namespace hourglass
