#pragma once
// The runs of a trade on disk: a row of runs.csv each, and their records beside it.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "studies/trade.hpp"

namespace hourglass {

/// Goes on where an earlier process was stopped. One process a folder.
class TradeStore {
 public:
  /// `force`: without the runs that are there. Throws std::invalid_argument if the folder holds the trade of another scene,
  /// or another process works in it; std::runtime_error where it cannot be written.
  TradeStore(const std::filesystem::path& folder, const Scene& balanced, bool force);

  std::optional<TradeOutcome> find(const std::string& run) const;
  void add(const TradeRun& run, const TradeOutcome& outcome);
  /// In the order in which they were added.
  const std::vector<Ledger::Row>& rows() const { return ledger_->rows(); }

 private:
  std::filesystem::path record_of(const std::string& run) const;

  std::filesystem::path folder_;
  FolderLock lock_;
  std::optional<Ledger> ledger_;
};

}  // namespace hourglass
