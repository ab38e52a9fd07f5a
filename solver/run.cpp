// From start to end: step, watch, tell the observers, stop, sum up.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <stdexcept>

#include "solver/diagnostics.hpp"
#include "solver/simulation_state.hpp"
#include "solver/watchdog.hpp"

namespace hourglass {

const char* name_of(Status status) {
  switch (status) {
    case Status::finished:
      return "finished";
    case Status::stopped:
      return "stopped";
    case Status::diverged:
      return "diverged";
    case Status::interrupted:
      return "interrupted";
  }
  return "";
}

namespace {

/// Times at which something is due: every `interval` from 0 on; never for 0.
class Cadence {
 public:
  explicit Cadence(double interval) : interval_(interval) {}
  bool due(double t) {
    if (interval_ <= 0 || t < next_ * (1 - 1e-12)) return false;
    count_ = std::floor(t / interval_ * (1 + 1e-12)) + 1;  // in one go: intervals may be short
    next_ = interval_ * count_;
    last_ = t;
    return true;
  }
  /// t, or the due time that it differs from by rounding only.
  double snapped(double t) const { return std::abs(t - next_) < 1e-12 * next_ ? next_ : t; }
  /// Whether the end of the run at t still has to be shown.
  bool owes(double t) const { return interval_ > 0 && last_ < t; }
  void walk(Archive& archive) {
    archive.number("next", next_);
    archive.number("last", last_);
    archive.number("count", count_);
  }

 private:
  double interval_, next_ = 0, last_ = -1;
  double count_ = 0;
};

/// How a run that meets trouble goes on from the last state kept: each rung of the ladder quarters the longest step, and
/// solves with more care (Simulation::Impl::take_care).
constexpr int rungs = 4;
constexpr double shorter = 4;
/// A run that needs more than this is not one that a few careful steps help.
constexpr long most_back_offs = 100;

class Run {
 public:
  Run(Simulation& simulation, Simulation::Impl& state, const std::vector<Observer*>& observers, Archive* from)
      : simulation_(simulation), s_(state), scene_(state.scene), observers_(observers),
        series_(scene_.output.series_every), frames_(scene_.output.fields_every),
        pictures_(scene_.output.snapshots_every), initial_mass_(simulation.grain_mass()),
        mass_(initial_mass_), settle_(start_up_time(scene_)), watchdog_(state, initial_mass_) {
    mass_over_time_.push_back({s_.t, unfed_mass()});
    if (from)
      walk(*from);
    else
      report_.t = s_.t;
  }

  Summary to_end() {
    try {
      steps();
    } catch (const std::bad_alloc&) {
      fail("out of memory");
    } catch (const std::exception& error) {  // of an observer: the disk is full, say
      fail(error.what());
    }
    return summarise();
  }

 private:
  /// What would be left without the feed: its slope is the discharge.
  double unfed_mass() const { return mass_ - s_.fed_mass; }
  void steps() {
    if (!began_) tell();
    began_ = true;
    while (!finished()) {
      const auto start = Clock::now();
      keep();
      const Trouble trouble = step();
      stepping_ += seconds_since(start);
      const auto after = Clock::now();
      if (trouble && back_off(trouble)) continue;
      if (trouble && !accept(trouble)) break;
      mass_ = simulation_.grain_mass();
      mass_over_time_.push_back({s_.t, unfed_mass()});
      summary_.worst_max_divergence = std::max(summary_.worst_max_divergence, report_.max_divergence);
      watch_orifices();
      tell();
      watch_stops();
      bool store = false;
      for (Observer* o : observers_) {
        o->on_step(report_, fraction_done());
        store = o->wants_checkpoint() || store;
        if (const std::string reason = o->interrupt(); !reason.empty() && !ended_)
          end(Status::interrupted, reason);
      }
      outside_ += seconds_since(after);
      if (store && !ended_) checkpoint();
    }
    if (summary_.status == Status::interrupted) checkpoint();
    if (summary_.status == Status::finished || summary_.status == Status::stopped) checkpoint_end();
    if (not_finite(s_.fields).empty()) tell_end();
  }

  /// Every member that lasts from step to step; what is not here follows from the scene. That a run was interrupted, or at
  /// its time.end, is no part of the state: it goes on as if it had not ended.
  void walk(Archive& archive) {
    archive.number("rung", rung_);
    if (rung_ < 0 || rung_ > rungs) throw std::runtime_error("rung: there is no such");
    if (archive.restoring()) s_.take_care(rung_);
    s_.walk(archive);
    archive.group("run", [&] {
      archive.number("began", began_);
      bool stopped = summary_.status == Status::stopped;
      std::vector<std::string> reason{summary_.reason};
      archive.number("stopped", stopped);
      archive.texts("reason", reason);
      if (archive.restoring() && stopped) end(Status::stopped, reason.at(0));
      archive.group("series", [&] { series_.walk(archive); });
      archive.group("frames", [&] { frames_.walk(archive); });
      archive.group("pictures", [&] { pictures_.walk(archive); });
      archive.number("initial_mass", initial_mass_);
      archive.number("mass", mass_);
      archive.history("mass_over_time", mass_over_time_);
      walk_slow_grains(archive);
      archive.number("row_t", last_.step.t);
      archive.numbers_like("row_orifices", last_.orifice_outflow, s_.orifice_mass);
      archive.numbers_like("row_materials", last_.material_outflow, s_.orifice_material);
      archive.number("row_fed", last_.fed);
      archive.number("worst_max_divergence", summary_.worst_max_divergence);
      archive.number("missed_tolerances", summary_.missed_tolerances);
      archive.number("back_offs", summary_.back_offs);
      archive.texts("warnings", summary_.warnings);
      archive.number("watched_orifices", watched_orifices_);
      archive.group("watchdog", [&] { watchdog_.walk(archive); });
      archive.number("rung_since", rung_since_);
      archive.number("patience", patience_);
      archive.number("told", told_);
      archive.number("resigned", resigned_);
      archive.number("kept_samples", kept_samples_);
      archive.number("misses_in_a_row", misses_in_a_row_);
      archive.number("last_miss", last_miss_);
      archive.number("stepping", stepping_);
      archive.number("outside", outside_);
      double wall = wall_seconds();
      archive.number("wall_seconds", wall);
      if (archive.restoring()) wall_before_ = wall;
      archive.group("step", [&] { walk_report(archive); });
    });
  }
  void walk_slow_grains(Archive& archive) {
    std::vector<std::array<double, 5>> rows;
    for (const auto& [t, s] : slow_)
      rows.push_back({t, s.quasi_static_fraction, s.quasi_static_1e2, s.quasi_static_1e4,
                      s.quasi_static_above_flat_top.value_or(-1)});
    archive.history("slow_grains", rows);
    slow_.clear();
    for (const auto& [t, usual, faster, slower, above] : rows)
      slow_.emplace_back(t,
                         SlowGrains{usual, faster, slower, above < 0 ? std::nullopt : std::optional(above)});
  }
  void walk_report(Archive& archive) {
    archive.number("step", report_.step);
    archive.number("t", report_.t);
    archive.number("dt", report_.dt);
    int limit = static_cast<int>(report_.limit);
    archive.number("limit", limit);
    if (limit < 0 || limit >= dt_limits) throw std::runtime_error("limit: there is no such");
    report_.limit = static_cast<DtLimit>(limit);
    for (auto& [name, solve] : {std::pair{"pressure", &report_.pressure},
                                {"viscous", &report_.viscous},
                                {"fluidity", &report_.fluidity}})
      archive.group(name, [&archive, &solve = solve] {
        archive.number("iterations", solve->iterations);
        archive.number("initial", solve->initial);
        archive.number("final", solve->final);
        archive.number("tolerance", solve->tolerance);
        archive.number("converged", solve->converged);
      });
    archive.number("max_divergence", report_.max_divergence);
    archive.number("max_speed", report_.max_speed);
    archive.number("capped_cells", report_.capped_cells);
    archive.number("floored_cells", report_.floored_cells);
  }
  void checkpoint() {
    const auto start = Clock::now();
    for (Observer* o : observers_) o->on_checkpoint(simulation_, [this](Archive& archive) { walk(archive); });
    outside_ += seconds_since(start);
  }
  /// Of a run that has all that was asked for, whether it can be continued or not.
  void checkpoint_end() {
    try {
      checkpoint();
    } catch (const std::runtime_error& error) {
      warn(fmt::format("no checkpoint at the end: {}", error.what()));
    }
  }

  /// One step, and what is wrong with it.
  Trouble step() {
    try {
      report_ = simulation_.step(scene_.time.end > 0 ? scene_.time.end : 1e300);
      if (report_.limit != DtLimit::end)
        for (const Cadence* cadence : {&series_, &frames_, &pictures_}) s_.t = cadence->snapped(s_.t);
      report_.t = s_.t;
    } catch (const std::runtime_error& error) {
      return {fmt::format("{} at t = {:.6g} (step {})", error.what(), s_.t, s_.steps), true};
    }
    Trouble trouble = watchdog_.of_step(report_);
    if (s_.steps % Watchdog::look_every == 0 && !trouble.hopeless) {
      if (Trouble lost = watchdog_.of_state()) return lost;
      for (const std::string& doubt : watchdog_.doubts()) warn(doubt);
    }
    return trouble;
  }

  /// Keeps the state now and then, and always when something of it was told, so that nothing is told twice. A run that has
  /// backed off comes down a rung after as many steps without trouble.
  void keep() {
    const long every = scene_.accuracy.backup_every;
    if (every == 0) return;
    if (rung_ > 0 && s_.steps - rung_since_ >= every * patience_) {
      s_.dt_most = --rung_ > 0 ? shorter * s_.dt_most : 1e300;
      rung_since_ = s_.steps;
      s_.take_care(rung_);
    }
    if (s_.backup && !told_ && s_.steps - s_.backup->tally.steps < every) return;
    told_ = false;
    s_.keep();
    kept_samples_ = mass_over_time_.size();
  }

  /// Goes back and up a rung; false where that is of no use any more.
  bool back_off(const Trouble& trouble) {
    if (!s_.backup) return false;
    if (rung_ == rungs || summary_.back_offs == most_back_offs || (resigned_ && !trouble.hopeless)) {
      if (!resigned_ && !trouble.hopeless) {
        resigned_ = true;
        warn("no smaller step helps; from here on tolerances that are missed are only reported");
      }
      return false;
    }
    ++rung_;
    ++summary_.back_offs;
    patience_ = std::min(2 * patience_, 16L);
    const double failed = std::min(s_.dt > 0 ? s_.dt : scene_.time.dt_max, s_.dt_most);
    s_.go_back();
    rung_since_ = s_.steps;
    s_.dt_most = failed / shorter;
    s_.take_care(rung_);
    mass_over_time_.resize(kept_samples_);
    if (summary_.back_offs <= 20)
      warn(fmt::format("{}; back to t = {:.6g} and on with steps of at most {:.3g}", trouble.what, s_.t,
                       s_.dt_most));
    return true;
  }

  /// Whether the run can go on all the same. If not, its last good state is what is left of it, and to be told.
  bool accept(const Trouble& trouble) {
    ++summary_.missed_tolerances;
    if (summary_.missed_tolerances <= 20) warn(trouble.what);
    misses_in_a_row_ = s_.steps == last_miss_ + 1 ? misses_in_a_row_ + 1 : 1;
    last_miss_ = s_.steps;
    if (!trouble.hopeless && misses_in_a_row_ < 20) return true;
    end(Status::diverged,
        trouble.hopeless ? trouble.what : "20 steps in a row missed a tolerance; the last: " + trouble.what);
    if (s_.backup) {
      s_.go_back();
      report_.t = s_.t;
      report_.step = s_.steps;
    }
    return false;
  }
  void fail(const std::string& reason) {
    if (summary_.status == Status::diverged)
      warn(reason);
    else
      end(Status::interrupted, reason);
  }
  void end(Status status, const std::string& reason) {
    ended_ = true;
    summary_.status = status;
    summary_.reason = reason;
  }
  bool finished() {
    if (ended_) return true;
    if (scene_.time.end > 0 && s_.t >= scene_.time.end) end(Status::finished, "reached time.end");
    if (scene_.time.max_steps > 0 && s_.steps >= scene_.time.max_steps)
      end(Status::finished, "reached time.max_steps");
    return ended_;
  }
  void warn(const std::string& text) {
    summary_.warnings.push_back(text);
    for (Observer* o : observers_) o->on_warning(text);
  }

  /// Says once, when the flow should have developed, which open orifice does not flow.
  void watch_orifices() {
    if (watched_orifices_ || settle_ <= 0 || s_.t <= settle_) return;
    watched_orifices_ = true;
    for (std::size_t o = 0; o < scene_.orifices.size(); ++o) {
      const Orifice& orifice = scene_.orifices[o];
      const double usual = images(scene_, orifice) * discharge_scale(scene_, orifice.width) * s_.t;
      if (s_.orifice_mass[o] < 0.02 * usual)  // 0.005 falls out before a jam sets
        warn(fmt::format(
            "orifice {} is open but does not flow: {:.3g} left in the first {:.3g}; an orifice of this "
            "width would let out about {:.3g} (jammed, or no grains above it)",
            o, s_.orifice_mass[o], s_.t, usual));
    }
  }

  void watch_stops() {
    const Stop& stop = scene_.stop;
    if (stop.mass_below && mass_ < *stop.mass_below * initial_mass_)
      end(Status::stopped, fmt::format("grain mass fell below {} of the initial mass", *stop.mass_below));
    if (stop.steady_discharge && settle_ > 0 && s_.t > 3 * settle_) {
      const auto sample = [&](double t) {
        return *std::lower_bound(mass_over_time_.begin(), mass_over_time_.end(), t,
                                 [](const auto& at, double time) { return at[0] < time; });
      };
      const auto a = sample(s_.t - 2 * settle_), b = sample(s_.t - settle_);
      const double before = (a[1] - b[1]) / (b[0] - a[0]), now = (b[1] - unfed_mass()) / (s_.t - b[0]);
      if (now > 0 && std::abs(now - before) < *stop.steady_discharge * now)
        end(Status::stopped, fmt::format("discharge steady to {}", *stop.steady_discharge));
    }
  }

  double wall_seconds() const { return wall_before_ + seconds_since(clock_); }
  double fraction_done() const {
    double done = scene_.time.end > 0 ? s_.t / scene_.time.end : 0;
    if (scene_.time.max_steps > 0)
      done = std::max(done, static_cast<double>(s_.steps) / static_cast<double>(scene_.time.max_steps));
    if (scene_.stop.mass_below && initial_mass_ > 0)
      done = std::max(done, (initial_mass_ - mass_) / (initial_mass_ * (1 - *scene_.stop.mass_below)));
    return std::min(done, 1.0);
  }

  void tell() {
    const bool series = series_.due(s_.t), frame = frames_.due(s_.t), picture = pictures_.due(s_.t);
    told_ = told_ || series || frame || picture;
    if (series) tell_series();
    for (Observer* o : observers_) {
      if (frame) o->on_fields(simulation_);
      if (picture) o->on_snapshot(simulation_);
    }
  }
  void tell_end() {
    if (series_.owes(s_.t)) tell_series();
    if (frames_.owes(s_.t))
      for (Observer* o : observers_) o->on_fields(simulation_);
    if (pictures_.owes(s_.t))
      for (Observer* o : observers_) o->on_snapshot(simulation_);
  }
  /// Outflows of a row are means since the row before.
  void tell_series() {
    SeriesRow row = s_.row(report_);
    const SeriesRow totals = row;
    const double interval = s_.t - last_.step.t;
    const auto rate = [&](std::vector<double>& now, const std::vector<double>& before) {
      for (std::size_t k = 0; k < now.size(); ++k)
        now[k] = interval > 0 ? (now[k] - (before.empty() ? 0 : before[k])) / interval : 0;
    };
    rate(row.orifice_outflow, last_.orifice_outflow);
    rate(row.material_outflow, last_.material_outflow);
    if (row.fed) row.fed = interval > 0 ? (*row.fed - last_.fed.value_or(0)) / interval : 0;
    for (double q : row.orifice_outflow) row.outflow += q;
    row.wall_seconds = wall_seconds();
    slow_.emplace_back(s_.t, row);
    for (Observer* o : observers_) o->on_series(row);
    last_ = totals;
  }

  SlowGrains slow_grains(const DischargeWindow& window) const {
    const auto mean = [&](const auto& figure) {
      History over_time;
      for (const auto& [t, slow] : slow_) over_time.push_back({t, figure(slow)});
      return mean_over(over_time, window.from, window.to);
    };
    const auto fraction = mean([](const SlowGrains& s) { return s.quasi_static_fraction; });
    if (!fraction) return s_.row({});
    SlowGrains out{*fraction,
                   *mean([](const SlowGrains& s) { return s.quasi_static_1e2; }),
                   *mean([](const SlowGrains& s) { return s.quasi_static_1e4; }),
                   {}};
    if (slow_[0].second.quasi_static_above_flat_top)
      out.quasi_static_above_flat_top =
          mean([](const SlowGrains& s) { return *s.quasi_static_above_flat_top; });
    return out;
  }

  Summary summarise() {
    Summary& r = summary_;
    const DischargeWindow window = discharge(scene_, mass_over_time_);
    r.discharge_rate = window.rate;
    r.discharge_window[0] = window.from;
    r.discharge_window[1] = window.to;
    const double scale = discharge_scale(scene_, total_width(scene_));
    if (scale > 0) r.discharge_constant = window.rate / scale;
    static_cast<SlowGrains&>(r) = slow_grains(window);
    r.mass_over_time = mass_over_time_;
    for (const auto& [at, slow] : slow_) r.quasi_static_over_time.push_back({at, slow.quasi_static_fraction});
    r.mass_error = s_.mass_error(initial_mass_);
    r.steps = s_.steps;
    r.cells = scene_.patch().cells();
    r.threads = threads_of(scene_);
    r.wall_seconds = stepping_;
    if (stepping_ > 0)
      r.cell_steps_per_second = static_cast<double>(r.steps) * static_cast<double>(r.cells) / stepping_;
    s_.timers.add("output and diagnostics", outside_);
    r.stages = s_.timers.stages();
    return r;
  }

  Simulation& simulation_;
  Simulation::Impl& s_;
  const Scene& scene_;
  const std::vector<Observer*>& observers_;
  Cadence series_, frames_, pictures_;
  double initial_mass_;
  double mass_;
  const double settle_;  // when the discharge counts as developed
  History mass_over_time_;
  std::vector<std::pair<double, SlowGrains>> slow_;  // by row
  SeriesRow last_;                                   // its outflows are totals
  Summary summary_;
  StepReport report_;  // of the last step
  bool began_ = false, ended_ = false, watched_orifices_ = false;
  Watchdog watchdog_;
  int rung_ = 0;                        // of the ladder of back_off()
  long rung_since_ = 0, patience_ = 1;  // the latter grows with every back-off
  bool told_ = false;                   // of the state since the last one kept
  bool resigned_ = false;
  std::size_t kept_samples_ = 0;
  long misses_in_a_row_ = 0, last_miss_ = -1;
  double stepping_ = 0, outside_ = 0;  // seconds
  const Clock::time_point clock_ = Clock::now();
  double wall_before_ = 0;  // seconds, of the parts of the run before this one
};

}  // namespace

Summary Simulation::run(const std::vector<Observer*>& observers, Archive* from) {
  return Run(*this, *impl_, observers, from).to_end();
}

}  // namespace hourglass
