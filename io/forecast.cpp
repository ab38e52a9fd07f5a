#include "io/forecast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "io/frame.hpp"
#include "io/offscreen.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "io/render.hpp"
#include "io/start.hpp"
#include "solver/diagnostics.hpp"
#include "solver/simulation.hpp"
#include "solver/timers.hpp"

namespace hourglass {
namespace {

// Measured with configs/silo.yaml, and with configs/round_silo.yaml around an axis, docs/plan.md:
constexpr double plane_discharge = 1.1, round_discharge = 0.58;  ///< discharge rate over discharge_scale()
constexpr double row_seconds = 25e-9;    ///< a cell and row of the series, on one thread
constexpr double frame_seconds = 10e-9;  ///< a cell and stored component

// The copies: the one that shows the flow is small, to see much of it; the one that is timed, large enough to be like it.
constexpr long flow_cells = 64 * 64, timed_cells = 128 * 128;
constexpr double flow_budget = 1, timed_budget = 0.7;  // s

/// What a step costs on a grid with `ratio` times the cells of the one that was timed, over its cost there. A cell and
/// step at 128^2, 256^2, 512^2: 112, 135, 166 ns on one thread, for more iterations and smaller caches a cell; 100, 99, 94
/// ns on two, for then the barriers lose weight.
double growth(double ratio, int threads) { return std::pow(ratio, threads == 1 ? 1.13 : 1.0); }

/// Means over the last half of the samples' time.
struct Later {
  FastestCells fastest;
  double loss = 0;  ///< of grains [M/T]
};

class Flow {
 public:
  Flow(const Scene& scene, const Trial& trial) : samples_(trial.flow) {
    const FlowSample &first = samples_.front(), &last = samples_.back();
    double near = 0, air = 0, weight = 0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k < samples_.size(); ++k) {
      if (samples_[k].t < 0.5 * last.t) {
        begin = k;
        continue;
      }
      const double dt = samples_[k].t - samples_[k - 1].t;
      near += dt * samples_[k].fastest.near_grains;
      air += dt * samples_[k].fastest.air;
      weight += dt;
    }
    if (weight > 0) later_.fastest = {near / weight, air / weight};
    if (last.t > samples_[begin].t)
      later_.loss = std::max(0.0, samples_[begin].mass - last.mass) / (last.t - samples_[begin].t);
    // Too early for a discharge of its own: the usual one.
    if (!scene.orifices.empty() && last.t < 1.5 * start_up_time(scene)) {
      double usual = 0;
      for (const Orifice& o : scene.orifices)
        usual += (scene.axisymmetric() ? round_discharge : plane_discharge) * images(scene, o) *
                 discharge_scale(scene, o.width);
      later_.loss = first.mass > 0 ? usual : 0;
    }
  }
  bool knows(double t) const { return t <= samples_.back().t; }
  FastestCells fastest(double t) {
    if (!knows(t)) return later_.fastest;
    return sample(t).fastest;
  }
  double initial_mass() const { return samples_.front().mass; }
  /// When the mass falls to this; infinity: never.
  double time_of_mass(double mass) const {
    for (const FlowSample& s : samples_)
      if (s.mass < mass) return s.t;
    return later_.loss > 0 ? samples_.back().t + (samples_.back().mass - mass) / later_.loss : INFINITY;
  }

 private:
  const FlowSample& sample(double t) {  // t only grows
    while (at_ + 1 < samples_.size() && samples_[at_ + 1].t <= t) ++at_;
    return samples_[at_];
  }
  const std::vector<FlowSample>& samples_;
  Later later_;
  std::size_t at_ = 0;
};

long due(double end, double every, long steps) {
  if (every <= 0) return 0;
  const double times = std::floor(end / every * (1 + 1e-12)) + 1;
  const bool owes = end > (times - 1) * every * (1 + 1e-12);
  return std::min(static_cast<long>(std::min(times, 1e15)) + owes, steps + 1);
}

/// Seconds that a picture of the simulation takes, the least of three; 0 where none can be drawn.
double time_picture(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  if (scene.output.snapshots_every == 0 || asked_fields(scene).empty()) return 0;
  const Frame frame = frame_of(simulation, stored_fields(scene));
  double least = INFINITY;
  try {
    for (int k = 0; k < 4; ++k) {  // the first also sets up OpenGL
      const auto start = Clock::now();
      render_png(picture_of(asked_fields(scene).front(), frame, info_of(scene)), {});
      if (k > 0) least = std::min(least, seconds_since(start));
    }
  } catch (const NoGraphics&) {
    return 0;
  }
  return least;
}

}  // namespace

Scene coarsened(const Scene& scene, long most_cells) {
  Scene best = coarser(scene, 0);
  for (Scene next = best; next.cells_x % 2 == 0 && best.patch().cells() > most_cells;) {
    next.cells_x /= 2;
    const double h = next.width / next.cells_x;
    bool sound = std::none_of(next.orifices.begin(), next.orifices.end(),
                              [&](const Orifice& o) { return o.width < (8 - 1e-6) * h; });
    for (const Problem& p : check(next)) sound &= !p.fatal;
    if (!sound) break;
    best = next;
  }
  return best;
}

Trial try_out(Simulation& simulation, double seconds) {
  const Scene& scene = simulation.scene();
  Trial trial{scene.patch(), {}};
  std::array<RowSums, 2> rows{RowSums(trial.patch.ny), RowSums(trial.patch.ny)};
  const auto sample = [&] {
    trial.flow.push_back(
        {simulation.t(), fastest_cells(simulation.fields(), 1, rows), simulation.grain_mass()});
  };
  sample();
  std::vector<double> costs;
  const TimeControl& time = scene.time;
  const auto start = Clock::now();
  const auto enough = [&] {  // long enough for the governor of threads to have tried both
    const double spent = seconds_since(start);
    return spent >= 8 * seconds || (spent >= seconds && costs.size() >= 30);
  };
  while (!enough() && (time.end == 0 || simulation.t() < time.end) &&
         (time.max_steps == 0 || static_cast<long>(costs.size()) < time.max_steps)) {
    const auto before = Clock::now();
    try {
      simulation.step(time.end > 0 ? time.end : 1e300);
    } catch (const std::runtime_error&) {  // diverged: what came before still tells the cost
      break;
    }
    costs.push_back(seconds_since(before));
    sample();
  }
  // Quartiles, for on a shared machine some steps wait for somebody else, and seldom in a longer run.
  costs.erase(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2));
  std::sort(costs.begin(), costs.end());
  for (std::size_t q = 0; q < 3 && !costs.empty(); ++q)
    trial.seconds_a_step[q] = costs[(q + 1) * (costs.size() - 1) / 4];
  return trial;
}

StepForecast predict_steps(const Scene& scene, const Trial& trial) {
  StepForecast result;
  Flow flow(scene, trial);
  const double h = scene.patch().h, end = scene.time.end > 0 ? scene.time.end : INFINITY;
  const double settle = start_up_time(scene);
  double stop = INFINITY;  // by the flow
  std::string why;
  if (scene.stop.mass_below) {
    stop = flow.time_of_mass(*scene.stop.mass_below * flow.initial_mass());
    why = "stop.mass_below";
  }
  if (scene.stop.steady_discharge && settle > 0) {
    result.sure = false;
    if (!std::isfinite(end) && !std::isfinite(stop) && scene.time.max_steps == 0) {
      stop = 4 * settle;  // it is first asked at 3
      why = "stop.steady_discharge";
    }
  }
  std::array<long, dt_limits> by_limit{};
  double t = 0, dt = 0;
  const auto over = [&] {
    if (t >= end)
      result.ends = "time.end";
    else if (scene.time.max_steps > 0 && result.steps >= scene.time.max_steps)
      result.ends = "time.max_steps";
    else if (t >= stop)
      result.ends = why;
    return !result.ends.empty();
  };
  while (!over()) {
    const TimeStep step = choose_time_step(scene, flow.fastest(t), h, dt, end - t);
    long count = 1;
    if (!flow.knows(t) && step.limit != DtLimit::growth &&
        step.limit != DtLimit::end) {  // all alike from here on
      double left = std::min(end, stop) - t;
      if (scene.time.max_steps > 0)
        left = std::min(left, static_cast<double>(scene.time.max_steps - result.steps) * step.dt);
      if (!std::isfinite(left)) break;  // the copy does not lose what it would have to
      count = std::max(1L, static_cast<long>(left / step.dt * (1 + 1e-9)));
    }
    result.steps += count;
    by_limit[static_cast<std::size_t>(step.limit)] += count;
    t = step.limit == DtLimit::end ? end : t + static_cast<double>(count) * step.dt;
    if (step.limit != DtLimit::end) dt = step.dt;
  }
  if (result.ends.empty() || result.ends == "stop.mass_below") result.sure = false;
  result.t = t;
  result.limit =
      name_of(static_cast<DtLimit>(std::max_element(by_limit.begin(), by_limit.end()) - by_limit.begin()));
  return result;
}

Forecast forecast(const Scene& scene) {
  Forecast f;
  Scene small = coarsened(scene, flow_cells);
  small.threads = 1;  // which so small a grid does best on
  const Trial flow = [&] {
    Simulation simulation(small);  // let go before the next: it may be as large as the scene
    begin(simulation);
    return try_out(simulation, flow_budget);
  }();
  Simulation timed_simulation(coarsened(scene, timed_cells));
  begin(timed_simulation);
  const Trial timed = try_out(timed_simulation, timed_budget);
  f.steps = predict_steps(scene, flow);
  const double cells = static_cast<double>(scene.patch().cells());
  const double ratio = cells / static_cast<double>(timed.patch.cells());
  f.timed = timed.patch;
  f.timed_seconds = timed.seconds_a_step;
  f.step_seconds = static_cast<double>(f.steps.steps) * timed.seconds_a_step[1] *
                   growth(ratio, provenance(scene.threads).threads);
  const Output& o = scene.output;
  const double stored = static_cast<double>(stored_fields(scene).size()) + 3;  // the velocity has three
  f.rows = due(f.steps.t, o.series_every, f.steps.steps);
  f.frames = due(f.steps.t, o.fields_every, f.steps.steps);
  f.picture_seconds = time_picture(timed_simulation);
  if (f.picture_seconds > 0)
    f.pictures =
        due(f.steps.t, o.snapshots_every, f.steps.steps) * static_cast<long>(asked_fields(scene).size());
  f.frame_bytes = static_cast<double>(f.frames) * stored * cells * sizeof(float);
  f.output_seconds = static_cast<double>(f.rows) * cells * row_seconds +
                     static_cast<double>(f.frames) * cells * stored * frame_seconds +
                     static_cast<double>(f.pictures) * f.picture_seconds;
  return f;
}

std::string text_of(const Forecast& f, const Scene& scene) {
  const StepForecast& s = f.steps;
  const double ms = 1e3 * f.step_seconds / std::max(1.0, static_cast<double>(s.steps));
  const std::string timed = fmt::format(
      "{:.3g} ms a step, from {:.3g} ms (middle half {:.3g} to {:.3g}) on {} x {} cells, timed just now", ms,
      1e3 * f.timed_seconds[1], 1e3 * f.timed_seconds[0], 1e3 * f.timed_seconds[2], f.timed.nx, f.timed.ny);
  if (f.timed_seconds[1] == 0) return "  no step of a small copy came out: it diverges at once\n";
  if (s.ends.empty())
    return fmt::format(
        "  no end in sight: a small copy does not lose the grains that stop.mass_below waits for\n  {}\n",
        timed);
  std::string text = fmt::format("  {}{} steps, most by {}, to t = {:.4g} by {}\n", s.sure ? "" : "about ",
                                 s.steps, s.limit, s.t, s.ends);
  if (scene.stop.steady_discharge && s.ends != "stop.steady_discharge")
    text += "  stop.steady_discharge may end it sooner; when cannot be foreseen\n";
  text += fmt::format("  {} of stepping: {}\n", duration_text(f.step_seconds), timed);
  text += fmt::format("  {} of output: {} rows, {} frames of {:.3g} MB in all, {} pictures of {:.2g} s\n",
                      duration_text(f.output_seconds), f.rows, f.frames, f.frame_bytes * 1e-6, f.pictures,
                      f.picture_seconds);
  double coarser_seconds = 0;
  const double coarser_share = s.limit == name_of(DtLimit::dt_max) ? 0.25 : 0.125;  // else half the steps too
  for (int k = 1; k <= scene.accuracy.extrapolate && !scene.orifices.empty(); ++k)
    coarser_seconds += f.step_seconds * std::pow(coarser_share, k);
  if (coarser_seconds > 0)
    text += fmt::format("  {} before it on the coarser grids of accuracy.extrapolate\n",
                        duration_text(coarser_seconds));
  return text +
         fmt::format("  {} in all\n", duration_text(f.step_seconds + coarser_seconds + f.output_seconds));
}

}  // namespace hourglass
