#pragma once
// The trade of speed for accuracy, measured: a reference of the scene's own, what each lever costs and buys, and which
// settings are worth their time (docs/trade.md).
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/trade_levers.hpp"
#include "studies/trade_record.hpp"

namespace hourglass {

/// What is to be run.
struct TradeRun {
  std::string name;
  std::string group;  ///< balanced, reference, ensemble, lever, combination, extrapolation
  Variant variant;
  Scene scene;
  unsigned noise = 0;  ///< seed of the noise in the initial velocity; 0: none
  bool timed = true;   ///< repeated, until the time is known
};

/// What came out of it.
struct TradeOutcome {
  Status status = Status::finished;
  std::string reason{};
  long cells = 0, steps = 0, missed_tolerances = 0;
  int repeats = 0;
  double cpu_seconds = 0, wall_seconds = 0;  ///< medians of the repeats
  double pace = 0;  ///< processor seconds of the same few steps of the balanced run, just before and after
  double spent_seconds = 0;  ///< of wall clock, all repeats together
  double ill_posed = 0;      ///< largest share of cells where mu(I) is ill-posed, once developed
  Record record{};
};

struct TradeOptions {
  std::filesystem::path scene;
  std::vector<std::string> sets;
  std::filesystem::path out;     ///< empty: trades/<name of the scene>
  std::optional<double> budget;  ///< minutes of wall clock
  int threads = 1;
  bool force = false, dry_run = false;
  std::vector<Observer*> observers{};  ///< of every run; one that interrupts ends the trade
  /// Runs one; replaced by tests.
  std::function<TradeOutcome(const TradeRun&, const Scene& whole)> runner{};
};

/// What trade() has found, and writes.
struct TradeResult {
  struct Row {
    TradeRun run;
    TradeOutcome outcome;
    Record error;   ///< against the reference; one number a quantity
    Record change;  ///< against the balanced run
    /// Across the whole silo, of a half twice as many as it has.
    int cells_across() const { return run.scene.cells_x * (run.variant.halved ? 2 : 1); }
    bool failed() const {
      return outcome.status == Status::diverged || outcome.status == Status::interrupted;
    }
  };
  struct ReferenceRow {
    Quantity quantity;
    ReferenceQuantity found;
    std::array<double, 3> apart;  ///< from the reference, coarse grid first
  };
  Scene balanced;
  std::vector<int> reference_cells;  ///< across, three grids
  std::vector<ReferenceRow> reference;
  std::vector<Row> rows;  ///< the first is balanced; no runs of the reference and the ensemble
  Record spread;          ///< largest change by noise in the start; empty: the scene is well-posed
  std::vector<std::string> left_out;
  /// Indices of rows; nullopt: there is none.
  std::optional<std::size_t> fast, middle, accurate;

  /// Processor seconds at the usual pace of the machine: those measured, times the median pace of all runs over that of
  /// this run, so that a load that comes and goes does not look like a lever.
  double seconds(const Row& row) const;
  /// Over those of balanced.
  double time_ratio(const Row& row) const { return seconds(row) / seconds(rows.front()); }
  /// A run's error by quantity; NaN where it has none.
  static double number(const Record& record, const Quantity& quantity);
  /// Is the change of a run no larger than that of noise?
  bool is_noise(const Row& row, const Quantity& quantity) const;
};

/// Fills in fast, middle (balanced) and accurate.
void name_points(TradeResult& result);

/// Measures what is not in the folder yet and writes runs.csv, levers.csv, pareto_<quantity>.png and trade.md. Prints a
/// line a run. Returns false if an observer interrupted it. Throws std::invalid_argument where the scene or the folder
/// does not allow it, std::runtime_error if the balanced run fails or the disk is full.
bool trade(const TradeOptions& options);

/// Runs by Simulation, with a throw-away start before the first.
TradeOutcome run_of_trade(const TradeRun& run, const Scene& whole, const std::vector<Observer*>& observers);

/// levers.csv, pareto_<quantity>.png, trade.md.
void write_trade(const TradeResult& result, const std::filesystem::path& folder);

}  // namespace hourglass
