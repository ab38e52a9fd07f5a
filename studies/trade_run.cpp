#include <algorithm>
#include <cmath>

#include "solver/diagnostics.hpp"
#include "solver/timers.hpp"
#include "studies/extrapolation.hpp"
#include "studies/trade.hpp"

namespace hourglass {
namespace {

constexpr int most_repeats = 3;
constexpr double repeat_seconds = 5;  ///< a run that took as long is not repeated
constexpr double noise_speed = 1e-3;  ///< sqrt(g d): where a grain counts as still

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// Processor seconds of the first steps of a scene: about 0.08.
double pace_of(Scene scene) {
  scene.time.max_steps =
      std::clamp(static_cast<long>(5e5 / static_cast<double>(scene.patch().cells())), 20L, 500L);
  return run_case(scene).cpu_seconds;
}

}  // namespace

TradeOutcome run_of_trade(const TradeRun& run, const Scene& whole, const std::vector<Observer*>& observers) {
  static const double cold = pace_of(whole);  // pages, caches and clocks are warm from here on
  (void)cold;
  TradeOutcome outcome;
  std::vector<double> cpu, wall, relative;  // relative: to the pace just before and just after
  const auto start = Clock::now();
  while (cpu.empty() ||
         (run.timed && std::ssize(cpu) < most_repeats && seconds_since(start) < repeat_seconds)) {
    Recorder recorder(whole, run.variant.halved);
    CaseOptions options{.observers = observers};
    options.observers.push_back(&recorder);
    options.at_end = [&](const Simulation& simulation) { recorder.at_end(simulation); };
    if (run.noise > 0)
      options.prepare = [&](Simulation& simulation) {
        add_noise(simulation, noise_speed * std::sqrt(whole.g() * whole.materials[0].diameter), run.noise);
      };
    const double before = pace_of(whole);
    const auto begin = Clock::now();
    Observer never_interrupts;
    const CoarseRuns coarse = run_coarser(run.scene, true, never_interrupts);
    CaseResult result = run_case(run.scene, options);
    if (run.scene.accuracy.extrapolate > 0) extrapolate(coarse, result.summary);
    wall.push_back(seconds_since(begin));
    cpu.push_back(result.cpu_seconds);
    for (const CaseResult& c : coarse.cases) cpu.back() += c.cpu_seconds;
    if (coarse.half_steps) cpu.back() += coarse.half_steps->cpu_seconds;
    relative.push_back(cpu.back() / (0.5 * (before + pace_of(whole))));
    outcome.status = result.summary.status;
    outcome.reason = result.summary.reason;
    outcome.steps = result.summary.steps;
    outcome.cells = run.scene.patch().cells();
    outcome.missed_tolerances = result.summary.missed_tolerances;
    if (result.failed()) break;
    outcome.record = recorder.record(result.summary);
    for (const SeriesRow& row : result.series)
      if (row.step.t >= result.summary.discharge_window[0])
        outcome.ill_posed = std::max(outcome.ill_posed, row.ill_posed_fraction);
  }
  outcome.repeats = static_cast<int>(cpu.size());
  outcome.cpu_seconds = median(cpu);
  outcome.wall_seconds = median(wall);
  outcome.pace = outcome.cpu_seconds / median(relative);
  outcome.spent_seconds = seconds_since(start);
  return outcome;
}

}  // namespace hourglass
