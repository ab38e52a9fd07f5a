#include "studies/trade_store.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <stdexcept>

#include "io/files.hpp"
#include "io/scene_yaml.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

const std::vector<std::string> columns{"run",        "group",          "cells_x",
                                       "cells",      "steps",          "repeats",
                                       "status",     "cpu_seconds",    "wall_seconds",
                                       "pace",       "spent_seconds",  "missed_tolerances",
                                       "ill_posed",  "discharge_rate", "quasi_static_fraction",
                                       "mass_error", "reason"};

std::string text_of(double x) { return fmt::format("{}", x); }

std::string file_name(const std::string& run) {
  std::string out;
  for (const char c : run)
    out += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' ? c : '_';
  return out + ".csv";
}

}  // namespace

TradeStore::TradeStore(const fs::path& folder, const Scene& balanced, bool force)
    : folder_(folder), lock_(folder, "trade") {
  const fs::path scene = folder / "scene.yaml", runs = folder / "runs.csv";
  if (force) {
    fs::remove(runs);
    fs::remove_all(folder / "runs");
  } else if (fs::exists(runs) && text_at(scene) != to_yaml(balanced)) {
    throw std::invalid_argument(
        fmt::format("{}: holds the trade of another scene, or of a version with other keys (scene.yaml). "
                    "Choose another folder "
                    "with --out, or replace it with --force.",
                    folder.string()));
  }
  fs::create_directories(folder / "runs");
  write_atomically(scene, to_yaml(balanced));
  ledger_.emplace(runs, columns);
}

fs::path TradeStore::record_of(const std::string& run) const { return folder_ / "runs" / file_name(run); }

std::optional<TradeOutcome> TradeStore::find(const std::string& run) const {
  const Ledger::Row* row = ledger_->find(run);
  if (!row) return std::nullopt;
  TradeOutcome o;
  const auto number = [&](const char* column) { return std::stod(row->at(column)); };
  for (const Status s : {Status::finished, Status::stopped, Status::diverged, Status::interrupted})
    if (row->at("status") == name_of(s)) o.status = s;
  o.reason = row->at("reason");
  o.cells = std::stol(row->at("cells"));
  o.steps = std::stol(row->at("steps"));
  o.missed_tolerances = std::stol(row->at("missed_tolerances"));
  o.repeats = std::stoi(row->at("repeats"));
  o.cpu_seconds = number("cpu_seconds");
  o.wall_seconds = number("wall_seconds");
  o.pace = number("pace");
  o.spent_seconds = number("spent_seconds");
  o.ill_posed = number("ill_posed");
  if (o.status == Status::finished || o.status == Status::stopped) o.record = read_record(record_of(run));
  return o;
}
void TradeStore::add(const TradeRun& run, const TradeOutcome& o) {
  write_record(record_of(run.name), o.record);
  ledger_->add({{"run", run.name},
                {"group", run.group},
                {"cells_x", fmt::format("{}", run.scene.cells_x)},
                {"cells", fmt::format("{}", o.cells)},
                {"steps", fmt::format("{}", o.steps)},
                {"repeats", fmt::format("{}", o.repeats)},
                {"status", name_of(o.status)},
                {"cpu_seconds", text_of(o.cpu_seconds)},
                {"wall_seconds", text_of(o.wall_seconds)},
                {"pace", text_of(o.pace)},
                {"spent_seconds", text_of(o.spent_seconds)},
                {"missed_tolerances", fmt::format("{}", o.missed_tolerances)},
                {"ill_posed", text_of(o.ill_posed)},
                {"discharge_rate", text_of(first_of(o.record, "discharge"))},
                {"quasi_static_fraction", text_of(first_of(o.record, "quasi_static"))},
                {"mass_error", text_of(first_of(o.record, "mass_defect"))},
                {"reason", o.reason}});
}

}  // namespace hourglass
