#include "studies/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "io/progress.hpp"
#include "io/scene_yaml.hpp"
#include "solver/diagnostics.hpp"
#include "studies/pareto.hpp"
#include "studies/run_time.hpp"
#include "studies/trade_store.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr double reference_share = 0.45;  ///< of the budget, at most
constexpr double slack = 1.2;             ///< an estimate is to be on the safe side
constexpr double tight_price = 3.5;       ///< what tight tolerances cost more, before a run has been timed
constexpr int ensemble_size = 5, most_combined = 6;
constexpr double hopeless = 0.2;  ///< error of the discharge on a grid where nothing is worth combining
constexpr double ill_posed_share = 0.01;  ///< of cells: beyond, differences may be noise
const std::string tight =
    "accuracy={preset: accurate, pressure_tolerance: 1e-9, precision: full, extrapolate: 0}";

class Trade {
 public:
  explicit Trade(const TradeOptions& options) : o_(options) {
    const Loaded loaded = load({});
    std::vector<std::string> wrong;
    for (const Diagnostic& d : loaded.diagnostics)
      if (d.fatal) wrong.push_back(d.text());
    if (!wrong.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(wrong, "\n")));
    balanced_ = loaded.scene;
    if (balanced_.time.end <= 0)
      throw std::invalid_argument(
          fmt::format("{} time.end: a trade compares runs of the same length and needs it. Add "
                      "--set time.end=..., a few times the start-up.",
                      o_.scene.string()));
    folder_ = o_.out.empty() ? fs::path("trades") / balanced_.name : o_.out;
    if (!o_.runner)
      o_.runner = [this](const TradeRun& run, const Scene& whole) {
        return run_of_trade(run, whole, o_.observers);
      };
  }

  bool to_end() {
    if (!o_.dry_run) store_.emplace(folder_, balanced_, o_.force);
    result_.balanced = balanced_;
    const TradeRun balanced = run_of("balanced", {});
    if (!measure(balanced)) return false;
    if (!o_.dry_run && result_.rows.front().failed())
      throw std::runtime_error("the balanced run failed: " + result_.rows.front().outcome.reason);
    if (!run_reference() || !run_ensemble()) return false;
    for (const Variant& v : one_lever_variants(balanced_))
      if (const auto run = sound_run("lever", v); run && !measure(*run)) return false;
    if (o_.dry_run) {
      fmt::print("\nThen up to {} combinations of the levers that turn out cheap in error.\n",
                 3 * most_combined);
      return true;
    }
    if (!run_combinations()) return false;
    add_extrapolations();
    compare();
    name_points(result_);
    write_trade(result_, folder_);
    fmt::print("{}\n", (folder_ / "trade.md").string());
    return true;
  }

 private:
  // ---- scenes ------------------------------------------------------------------------------------------------

  Loaded load(const std::vector<std::string>& sets) const {
    std::vector<std::string> all = o_.sets;
    all.insert(all.end(), {"accuracy=balanced", "stop={}", fmt::format("threads={}", o_.threads)});
    all.insert(all.end(), sets.begin(), sets.end());
    // Coarser grids are runs of their own here, but for a word of accuracy as it is meant.
    if (std::find(sets.begin(), sets.end(), own_grid) == sets.end()) all.push_back("accuracy.extrapolate=0");
    Loaded loaded = load_scene(o_.scene, all);
    loaded.scene.output.snapshots_every = 0;
    loaded.scene.output.fields_every = Recorder::sample_interval(loaded.scene);
    return loaded;
  }

  TradeRun run_of(const std::string& group, const Variant& v) const {
    TradeRun run{v.name(), group, v, balanced_};
    return run;
  }

  /// Says why there is none; nothing where the variant changes nothing.
  std::optional<TradeRun> sound_run(const std::string& group, const Variant& v) {
    TradeRun run = run_of(group, v);
    std::vector<std::string> sets = v.sets;
    if (v.halved) std::erase_if(sets, [](const std::string& s) { return s.starts_with("domain.symmetry"); });
    const Loaded loaded = load(sets);
    for (const Diagnostic& d : loaded.diagnostics)
      if (d.fatal) {
        leave_out(run.name, d.message);
        return std::nullopt;
      }
    run.scene = loaded.scene;
    if (v.halved) {
      const std::optional<Scene> half = halved(run.scene);
      if (!half) {
        leave_out(run.name, "its half is no sound scene");
        return std::nullopt;
      }
      run.scene = *half;
    }
    if (run.scene == balanced_ && group != "balanced") return std::nullopt;
    return run;
  }

  // ---- time --------------------------------------------------------------------------------------------------

  double spent() const {
    double sum = 0;
    if (store_)
      for (const Ledger::Row& row : store_->rows()) sum += std::stod(row.at("spent_seconds"));
    return sum;
  }
  double seconds_left() const { return o_.budget ? 60 * *o_.budget - spent() : HUGE_VAL; }

  /// Seconds a cell and step of the runs done so far: the median of those with or without tight tolerances.
  double rate(bool is_tight) const {
    std::vector<double> rates;
    if (store_)
      for (const Ledger::Row& row : store_->rows()) {
        const double work = std::stod(row.at("cells")) * std::stod(row.at("steps"));
        if ((row.at("group") == "reference") == is_tight && work > 0)
          rates.push_back(std::stod(row.at("wall_seconds")) / work);
      }
    if (rates.empty()) return is_tight ? tight_price * rate(false) : cell_step_seconds;
    std::nth_element(rates.begin(), rates.begin() + std::ssize(rates) / 2, rates.end());
    return rates[rates.size() / 2];
  }

  /// Of one run without repeats. Steps are those that dt_max allows, or a speed at the orifice that the balanced run
  /// has shown where the Courant number ruled it, else 1.4 sqrt(g W).
  double seconds_of(const TradeRun& run) const {
    const Scene& s = run.scene;
    double speed = expected_speed(s);
    if (!result_.rows.empty() && result_.rows.front().outcome.steps > 0) {
      const double dt = balanced_.time.end / static_cast<double>(result_.rows.front().outcome.steps);
      if (dt < 0.97 * balanced_.time.dt_max) speed = balanced_.time.cfl * balanced_.patch().h / dt;
    }
    return slack * rate(run.group == "reference") * static_cast<double>(s.patch().cells()) *
           expected_steps(s, speed);
  }
  double seconds_with_repeats(const TradeRun& run) const {
    const double once = seconds_of(run);
    return run.timed ? once * std::clamp(std::ceil(5 / once), 1.0, 3.0) : once;
  }

  // ---- runs --------------------------------------------------------------------------------------------------

  void leave_out(const std::string& run, const std::string& why) {
    result_.left_out.push_back(run + ": " + why);
    fmt::print("{:<60} left out: {}\n", run, why);
    std::fflush(stdout);
  }

  /// The outcome, from the folder or by running; nullopt: left out, or with `interrupted_` the end of the trade.
  std::optional<TradeOutcome> outcome_of(const TradeRun& run) {
    if (o_.dry_run) {
      fmt::print("{:<60} {:>5} cells across, about {}\n", run.name, run.scene.cells_x,
                 duration_text(seconds_with_repeats(run)));
      return std::nullopt;
    }
    if (auto done = store_->find(run.name)) return done;
    if (const double needs = seconds_with_repeats(run); needs > seconds_left()) {
      leave_out(run.name, fmt::format("needs about {}, {} left of the budget", duration_text(needs),
                                      duration_text(std::max(0.0, seconds_left()))));
      return std::nullopt;
    }
    TradeOutcome outcome = o_.runner(run, balanced_);
    for (Observer* observer : o_.observers)
      if (const std::string why = observer->interrupt(); !why.empty()) {
        fmt::print("{}: {}; the same command goes on from here\n", run.name, why);
        interrupted_ = true;
        return std::nullopt;
      }
    store_->add(run, outcome);
    fmt::print("{:<60} {:>5} cells across, {} steps, {:.3g} s: {}\n", run.name, run.scene.cells_x,
               outcome.steps, outcome.cpu_seconds,
               outcome.record.contains("discharge")
                   ? fmt::format("discharge {:.5g}", first_of(outcome.record, "discharge"))
                   : name_of(outcome.status));
    std::fflush(stdout);
    return outcome;
  }

  /// A row of the result; false ends the trade.
  bool measure(const TradeRun& run) {
    const bool there = std::any_of(result_.rows.begin(), result_.rows.end(),
                                   [&](const TradeResult::Row& row) { return row.run.name == run.name; });
    if (there) return true;
    if (const auto outcome = outcome_of(run)) result_.rows.push_back({run, *outcome, {}, {}});
    return !interrupted_;
  }

  // ---- the reference -----------------------------------------------------------------------------------------

  /// Three grids with the step shrinking as the cells do, so that the error of both goes to zero together.
  std::optional<std::array<TradeRun, 3>> reference_runs(int finest) {
    std::array<TradeRun, 3> runs;
    for (int k = 0; k < 3; ++k) {
      const int divisor = 4 >> k, cells = finest / divisor;
      if (finest % divisor != 0) return std::nullopt;
      const double ratio = static_cast<double>(balanced_.cells_x) / cells;
      Variant v{{},
                {tight, fmt::format("grid.cells_x={}", cells),
                 fmt::format("time.dt_max={:.12g}", balanced_.time.dt_max * ratio)}};
      const Loaded loaded = load(v.sets);
      if (!loaded.ok()) return std::nullopt;
      runs[k] = {fmt::format("reference {} of {}", cells, finest), "reference", v, loaded.scene, 0, false};
    }
    return runs;
  }

  bool run_reference() {
    std::optional<std::array<TradeRun, 3>> chosen;
    if (store_)
      for (const Ledger::Row& row : store_->rows())
        if (row.at("group") == "reference") {
          chosen = reference_runs(std::stoi(row.at("run").substr(row.at("run").rfind(' ') + 1)));
          break;
        }
    for (int factor = o_.budget ? 8 : 4; !chosen && factor >= 1;
         factor /= 2) {  // halves of the scene's own cells
      const auto runs = reference_runs(balanced_.cells_x * factor / 2);
      if (!runs) continue;
      double needs = 0;
      for (const TradeRun& run : *runs) needs += seconds_of(run);
      if (!o_.budget || needs < reference_share * 60 * *o_.budget) chosen = runs;
    }
    if (!chosen) {
      if (o_.dry_run) return true;
      throw std::invalid_argument(
          "no reference: three grids, each with half the cells of the next, do not fit into the "
          "budget or are no sound scenes. Give more minutes, or a shorter time.end.");
    }
    std::array<Record, 3> records;
    for (int k = 0; k < 3; ++k) {
      const auto outcome = outcome_of((*chosen)[k]);
      if (!outcome && !o_.dry_run && !interrupted_)
        throw std::runtime_error(
            "the reference does not fit into what is left of the budget; give more minutes");
      if (!outcome && !o_.dry_run) return false;
      if (!outcome) continue;
      if (outcome->status == Status::diverged)
        throw std::runtime_error((*chosen)[k].name + " diverged: " + outcome->reason);
      records[k] = outcome->record;
      result_.reference_cells.push_back((*chosen)[k].scene.cells_x);
    }
    for (const Quantity& q : quantities) {
      if (std::any_of(records.begin(), records.end(), [&](const Record& r) { return !r.contains(q.key); }))
        continue;
      ReferenceQuantity found =
          reference_of(q, records[0].at(q.key), records[1].at(q.key), records[2].at(q.key));
      if (q.key == std::string("mass_defect")) found = {{0.0}, 0, 0, {}};  // nothing may be lost
      reference_[q.key] = found.values;
      std::array<double, 3> apart{};
      for (int k = 0; k < 3; ++k) apart[k] = distance(q, records[k], reference_);
      result_.reference.push_back({q, found, apart});
    }
    return true;
  }

  // ---- noise -------------------------------------------------------------------------------------------------

  bool may_be_noise() const {
    if (balanced_.rheology.law != Law::mu_I) return false;
    if (!result_.rows.empty() && result_.rows.front().outcome.ill_posed > ill_posed_share) return true;
    return std::any_of(balanced_.materials.begin(), balanced_.materials.end(), [](const Material& m) {
      return (m.mu_s > 0 || m.delta_mu > 0) && !well_posed_range(m);
    });
  }

  bool run_ensemble() {
    if (!may_be_noise()) return true;
    for (unsigned seed = 1; seed <= ensemble_size; ++seed) {
      TradeRun run = run_of("ensemble", {});
      run.name = fmt::format("balanced, noise {}", seed);
      run.noise = seed;
      run.timed = false;
      const auto outcome = outcome_of(run);
      if (interrupted_) return false;
      if (!outcome) continue;
      for (const Quantity& q : quantities) {
        const double apart = distance(q, outcome->record, result_.rows.front().outcome.record);
        if (!std::isfinite(apart) || q.key == std::string("mass_defect")) continue;
        std::vector<double>& spread = result_.spread[q.key];
        spread = {std::max(apart, spread.empty() ? 0.0 : spread.front())};
      }
    }
    return true;
  }

  // ---- combinations ------------------------------------------------------------------------------------------

  void compare() {
    for (TradeResult::Row& row : result_.rows)
      for (const Quantity& q : quantities) {
        row.error[q.key] = {distance(q, row.outcome.record, reference_)};
        row.change[q.key] = {distance(q, row.outcome.record, result_.rows.front().outcome.record)};
      }
  }

  /// Largest change against balanced, in units of what is felt.
  static double harm(const TradeResult::Row& row) {
    double worst = 0;
    for (const Quantity& q : quantities) {
      const double change = TradeResult::number(row.change, q);
      worst = std::max(worst, std::isfinite(change) ? change / q.harm : HUGE_VAL);
    }
    return worst;
  }

  /// Settings that save time and do little harm, the best bargain first, one a lever.
  std::vector<Variant> bargains() {
    compare();
    std::vector<std::pair<double, Variant>> found;
    const bool has_tracer = result_.rows.front().outcome.record.contains("tracer");
    for (const TradeResult::Row& row : result_.rows) {
      if (row.run.group != "lever" || row.failed() || row.run.variant.model) continue;
      const std::string& lever = row.run.variant.lever;
      if (lever == "grid.cells_x" || lever == "accuracy" || lever == "stop.steady_discharge") continue;
      TradeResult::Row judged = row;
      if (!has_tracer) judged.change["tracer"] = {0.0};
      const double faster = 1 / result_.time_ratio(row);
      if (faster < 1.05 || harm(judged) > 1) continue;
      found.emplace_back(std::log(faster) / std::max(harm(judged), 0.05), row.run.variant);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Variant> out;
    for (auto& [value, v] : found)
      if (std::none_of(out.begin(), out.end(),
                       [&, lever = v.lever](const Variant& o) { return o.lever == lever; }) &&
          std::ssize(out) < most_combined)
        out.push_back(std::move(v));
    return out;
  }

  const TradeResult::Row* row_of(const std::string& name) const {
    const auto at = std::find_if(result_.rows.begin(), result_.rows.end(),
                                 [&](const TradeResult::Row& row) { return row.run.name == name; });
    return at == result_.rows.end() ? nullptr : &*at;
  }

  /// Greedy: at each resolution one bargain after the other is added and kept if it saves time and no error grows by more
  /// than a quarter of what is felt.
  bool run_combinations() {
    const std::vector<Variant> cheap = bargains();
    for (const double factor : {0.5, 1.0, 2.0}) {
      Variant best;
      if (factor != 1) best.sets = {fmt::format("grid.cells_x={:.6g}", factor * balanced_.cells_x)};
      for (const Variant& v : cheap) {
        const TradeResult::Row* before = row_of(best.name());
        if (!before) break;  // that grid was left out
        if (!(distance(quantities[0], before->outcome.record, reference_) < hopeless)) break;
        const TradeOutcome then = before->outcome;
        const double seconds = result_.seconds(*before);
        Variant next = best;
        next.lever.clear();
        next.sets.insert(next.sets.end(), v.sets.begin(), v.sets.end());
        next.halved = best.halved || v.halved;
        const auto run = sound_run("combination", next);
        if (!run) continue;
        if (!measure(*run)) return false;
        const TradeResult::Row* now = row_of(run->name);
        if (!now || now->failed() || result_.seconds(*now) > 0.97 * seconds) continue;
        const bool worse = std::any_of(quantities.begin(), quantities.end(), [&](const Quantity& q) {
          return distance(q, now->outcome.record, reference_) >
                 distance(q, then.record, reference_) + 0.25 * q.harm;
        });
        if (!worse) best = next;
      }
    }
    return true;
  }

  // ---- extrapolation -----------------------------------------------------------------------------------------

  static bool usable(const TradeResult::Row& row) {
    return !row.failed() && !row.run.variant.model && row.outcome.record.contains("discharge");
  }

  static TradeResult::Row extrapolated(const std::vector<const TradeResult::Row*>& grids) {
    TradeResult::Row row = *grids.front();
    row.run.group = "extrapolation";
    row.run.variant.sets.push_back(fmt::format("accuracy.extrapolate={}", grids.size() - 1));
    row.run.name = row.run.variant.name();
    for (const char* key : {"discharge", "quasi_static"}) {
      std::vector<double> values;
      for (const TradeResult::Row* grid : grids) values.push_back(grid->outcome.record.at(key).front());
      std::ranges::reverse(values);
      row.outcome.record[key] = {richardson(values).value};
    }
    double cpu = 0, wall = 0, paces = 0;
    for (const TradeResult::Row* grid : grids) {
      cpu += grid->outcome.cpu_seconds;
      wall += grid->outcome.wall_seconds;
      paces += grid->outcome.cpu_seconds / grid->outcome.pace;
    }
    row.outcome.cpu_seconds = cpu;
    row.outcome.wall_seconds = wall;
    row.outcome.pace = cpu / paces;
    return row;
  }

  /// What accuracy.extrapolate makes of the runs at hand: those that differ in nothing but their grid, each with half the
  /// cells of the next.
  void add_extrapolations() {
    const auto rest = [](const TradeRun& run) {
      std::vector<std::string> sets = run.variant.sets;
      std::erase_if(sets, [](const std::string& s) { return s.starts_with("grid.cells_x="); });
      return sets;
    };
    std::vector<TradeResult::Row> rows;
    for (const TradeResult::Row& finest : result_.rows) {
      if (finest.run.scene.accuracy.extrapolate > 0) continue;  // it has been
      std::vector<const TradeResult::Row*> grids{&finest};      // the finest first
      for (int divisor = 2; divisor <= 4 && std::ssize(grids) == divisor / 2; divisor *= 2) {
        const auto coarser =
            std::find_if(result_.rows.begin(), result_.rows.end(), [&](const TradeResult::Row& row) {
              return divisor * row.run.scene.cells_x == finest.run.scene.cells_x &&
                     rest(row.run) == rest(finest.run) && usable(row);
            });
        if (coarser == result_.rows.end() || !usable(finest)) break;
        grids.push_back(&*coarser);
        rows.push_back(extrapolated(grids));
      }
    }
    result_.rows.insert(result_.rows.end(), rows.begin(), rows.end());
  }

  TradeOptions o_;
  Scene balanced_;
  fs::path folder_;
  std::optional<TradeStore> store_;
  Record reference_;
  TradeResult result_;
  bool interrupted_ = false;
};

}  // namespace

double TradeResult::number(const Record& record, const Quantity& quantity) {
  return first_of(record, quantity.key);
}

double TradeResult::seconds(const Row& row) const {
  std::vector<double> paces;
  for (const Row& r : rows) paces.push_back(r.outcome.pace);
  std::nth_element(paces.begin(), paces.begin() + std::ssize(paces) / 2, paces.end());
  return row.outcome.cpu_seconds * paces[paces.size() / 2] / row.outcome.pace;
}

bool TradeResult::is_noise(const Row& row, const Quantity& quantity) const {
  return number(row.change, quantity) <= number(spread, quantity);  // false where either is NaN
}

void name_points(TradeResult& result) {
  const Quantity &discharge = quantities[0], &velocity = quantities[5];
  std::vector<CostAndError> points;
  for (const TradeResult::Row& row : result.rows) {
    const bool counts = !row.failed() && !row.run.variant.model;
    points.push_back({result.seconds(row), counts ? TradeResult::number(row.error, discharge) : NAN});
  }
  const auto cost = [&](std::size_t k) { return points[k].cost; };
  // Runs for every use: an extrapolation improves two numbers, not the fields.
  std::vector<CostAndError> plain = points;
  for (std::size_t k = 0; k < plain.size(); ++k)
    if (result.rows[k].run.group == "extrapolation") plain[k].error = NAN;
  for (const std::size_t k : pareto_front(plain)) {
    const auto off = [&](std::size_t p) {
      return std::abs(std::log(std::max(points[p].error, 1e-12) / 0.02));
    };
    if (!result.middle || off(k) < off(*result.middle)) result.middle = k;
  }
  if (!result.middle) return;
  const double most = std::max(TradeResult::number(result.rows[*result.middle].error, velocity), 0.0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!std::isfinite(points[k].error)) continue;
    if (cost(k) <= cost(*result.middle) / 5 && std::isfinite(plain[k].error) &&
        (!result.fast || points[k].error < points[*result.fast].error))
      result.fast = k;
    // A small error of the discharge alone may be chance: the flow has to be no worse than that of balanced.
    const double flow = TradeResult::number(result.rows[k].error, velocity);
    if (points[k].error <= 0.005 && !(flow > most) && (!result.accurate || cost(k) < cost(*result.accurate)))
      result.accurate = k;
  }
}

bool trade(const TradeOptions& options) { return Trade(options).to_end(); }

}  // namespace hourglass
