#pragma once
// results.csv of a sweep: a row each run, in the order of the runs, whole at any time.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/study.hpp"

namespace hourglass {

/// The figures of merit that the table takes from summary.json, by their names.
inline const std::vector<std::string> figures_of_merit{"discharge_rate",
                                                       "discharge_constant",
                                                       "quasi_static_fraction",
                                                       "quasi_static_1e-2",
                                                       "quasi_static_1e-4",
                                                       "quasi_static_above_flat_top",
                                                       "mass_error",
                                                       "steps",
                                                       "cells",
                                                       "back_offs",
                                                       "missed_tolerances",
                                                       "wall_seconds"};

class SweepTable {
 public:
  using Cells = std::map<std::string, std::string>;  ///< by column: status, figures of merit, reason

  /// Reads the rows that are there. Throws std::invalid_argument if they are not of this study.
  SweepTable(const std::filesystem::path& path, const std::vector<StudyAxis>& axes,
             const std::vector<StudyRun>& runs);

  bool has(std::size_t run) const { return rows_.count(run) > 0; }
  std::size_t size() const { return rows_.size(); }
  int failed() const;  ///< runs that neither finished nor stopped by their own rule
  /// On disk when it returns.
  void add(std::size_t run, const Cells& cells);

 private:
  std::filesystem::path path_;
  const std::vector<StudyRun>& runs_;
  std::vector<std::string> columns_;
  std::map<std::size_t, std::vector<std::string>> rows_;  ///< by run
};

/// Status, reason and figures of merit of a run that has ended; nothing where there is no summary.json.
std::optional<SweepTable::Cells> summary_of(const std::filesystem::path& run_folder);

}  // namespace hourglass
