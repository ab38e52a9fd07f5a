#pragma once
// Runs of a sweep as tasks of array jobs of Slurm (Yoo, Jette & Grondona 2003), which outlive who submits them.
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace hourglass {

/// What a task left that ended: written by the script of the job behind the run itself.
struct TaskEnd {
  int wait_status = 0;  ///< as of waitpid()
  double seconds = 0;
};

class Slurm {
 public:
  /// folder: of the study, on a file system that the nodes see too. Throws std::invalid_argument without sbatch or squeue.
  explicit Slurm(const std::filesystem::path& folder);

  /// Runs by name that wait or are at work, of all jobs that were submitted from this folder; nothing while Slurm cannot be
  /// asked.
  std::optional<std::set<std::string>> alive() const;
  /// The numbers of their jobs, "12 13".
  std::string jobs(const char* between = " ") const;

  /// One array job, a task each run; several where there are more runs than an array may have. at_once: tasks at a time,
  /// 0: as many as Slurm likes. Throws std::runtime_error with the words of sbatch if it refuses.
  void submit(const std::vector<std::string>& runs, const std::filesystem::path& program, int threads,
              int at_once);

  /// How the task of a run ended; nothing if it has not, or was ended by Slurm.
  std::optional<TaskEnd> end_of(const std::string& run) const;

  /// The program of Slurm that is not there; empty if all are.
  static std::string missing();
  /// Whether a folder has had jobs.
  static bool used(const std::filesystem::path& folder);

 private:
  std::filesystem::path own() const { return folder_ / "slurm"; }
  std::vector<std::string> listed(const std::string& list) const;

  std::filesystem::path folder_;
};

}  // namespace hourglass
