#pragma once
// The folder that a run leaves behind: scene.yaml, run.log, series.csv, fields.h5 + fields.xdmf, snapshots/
// checkpoint.h5 and summary.json (docs/output.md). Every file is complete up to the last row or frame at any time.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {

struct RunOptions {
  std::filesystem::path out;  ///< empty: runs/<name of the scene>
  bool force = false;         ///< replace an earlier run in the same folder
  bool quiet = false;         ///< no progress on standard output
  Archive* from =
      nullptr;  ///< a checkpoint: the run in the folder goes on from it; what is later than it goes
};

/// Where a run of this scene goes by default: runs/<name>, with characters that could leave `runs` replaced.
std::filesystem::path default_run_folder(const std::string& scene_name);

/// Where a run of this scene goes with these options.
std::filesystem::path run_folder_of(const Scene& scene, const RunOptions& options);

/// Whether a run is in the folder. Throws std::invalid_argument if it is a file, or holds what no run wrote.
bool holds_run(const std::filesystem::path& folder);

/// `status` of a folder's summary.json; empty without one.
std::string status_of_run(const std::filesystem::path& folder);

/// Writes and draws what Simulation::run tells it.
class RunFolder : public Observer {
 public:
  /// Makes the folder, writes scene.yaml and the head of run.log. Throws std::invalid_argument, having
  /// written nothing, if the folder holds files of a run and `force` is off, or files that no run wrote stand
  /// in the way, or if another process runs there. `force` removes only what a run of hourglass wrote. Throws
  /// std::runtime_error if writing fails.
  RunFolder(const Scene& scene, const std::string& resolved_yaml, const RunOptions& options,
            const std::vector<std::string>& warnings = {});
  ~RunFolder() override;

  // All throw std::runtime_error with path and reason if writing fails, which ends the run; earlier rows and
  // frames stay intact.
  void on_series(const SeriesRow& row) override;
  void on_fields(const Simulation& simulation) override;
  void on_snapshot(const Simulation& simulation) override;
  void on_step(const StepReport& report, double fraction_done) override;
  bool wants_checkpoint() override;
  void on_checkpoint(const Simulation& simulation, const Walk& walk) override;
  void on_warning(const std::string& warning) override;

  /// A line for the log and, unless quiet, for standard output.
  void say(const std::string& line);
  /// All of a model that is a steady field: a row of the series, a frame, the pictures.
  void write(const SteadyFlow& flow);

  /// Ends the progress line and writes summary.json, in room that was claimed at the start: a run that ends for
  /// want of room on the disk has one too.
  void finish(const Summary& summary);

  const std::filesystem::path& path() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hourglass
