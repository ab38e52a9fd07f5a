#pragma once
// `hourglass sweep`: the runs of a study, several at a time, each in a process of its own: one that crashes is a row of
// the table and ends nothing else. What is in a folder of a sweep: docs/studies.md.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "solver/simulation.hpp"
#include "studies/study.hpp"

namespace hourglass {

/// Where runs are executed: by this process, or by Slurm, which goes on without it.
enum class Executor { local, slurm };
inline constexpr std::array executor_names{"local", "slurm"};

struct SweepOptions {
  std::filesystem::path study;
  std::filesystem::path out{};  ///< empty: sweeps/<name of the study>
  Executor executor = Executor::local;
  /// Runs at a time; 0: as many as the cores can take, by the cells of each, or as Slurm likes.
  int jobs = 0;
  bool force = false;  ///< without what is in the folder
  bool dry_run = false;
  bool warn = true;  ///< of what is doubtful about the scenes
  /// Holds folders of other sweeps: what has ended there is linked to instead of run again where the scenes are equal.
  std::filesystem::path equal_runs_in{};
  std::vector<Observer*> observers{};  ///< asked whether to stop
  std::filesystem::path program =
      "/proc/self/exe";  ///< called as hourglass run SCENE --out DIR --quiet --threads N
};

struct SweepResult {
  int runs = 0, failed = 0;
  int lost = 0;              ///< whose task ended without a word; the same call tries again
  bool interrupted = false;  ///< the same call goes on
};

/// Goes on where an earlier process was stopped. Throws std::invalid_argument, having written nothing, if the study or one
/// of its scenes is wrong, the folder holds another study or another process works in it; std::runtime_error if it
/// cannot be written.
SweepResult sweep(const SweepOptions& options);

/// The same of a study that is read already; options.study is not looked at.
SweepResult sweep(const Study& study, const SweepOptions& options);

}  // namespace hourglass
