#include "studies/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>

#include "io/files.hpp"
#include "io/progress.hpp"
#include "io/scene_yaml.hpp"
#include "studies/child.hpp"
#include "studies/run_time.hpp"
#include "studies/slurm.hpp"
#include "studies/study.hpp"
#include "studies/sweep_table.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

constexpr long small_cells = 256L * 256;  ///< a run of so many gains little from a second thread
constexpr const char* own_files[] = {"study.yaml", "results.csv"};
constexpr const char *own_folders[] = {"inputs", "logs", "runs"}, *job_folder = "slurm";
constexpr std::chrono::seconds between_questions(1);  ///< to Slurm
constexpr int patience =
    5;  ///< questions until a task is lost that is neither in the queue nor has left anything

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n ");
  if (end == std::string::npos) return {};
  const std::size_t begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

class Sweep {
 public:
  Sweep(Study study, const SweepOptions& options)
      : o_(options), study_(std::move(study)), runs_(runs_of(study_, warnings_)),
        folder_(options.out.empty() ? fs::path("sweeps") / study_.name : options.out),
        cores_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {
    for (const std::string& warning : o_.warn ? warnings_ : std::vector<std::string>{}) tell(warning);
    for (const StudyRun& run : runs_)
      seconds_.push_back(cell_step_seconds * static_cast<double>(run.scene.patch().cells()) *
                         expected_steps(run.scene, expected_speed(run.scene)));
  }

  SweepResult dry_run() const {
    double total = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      fmt::print("{} {}: {} x {} cells, about {} on one thread\n", runs_[r].name, runs_[r].text(study_),
                 runs_[r].scene.patch().nx, runs_[r].scene.patch().ny, duration_text(seconds_[r]));
      total += seconds_[r];
    }
    fmt::print("{} runs, about {} in all\n", runs_.size(), duration_text(total / at_once()));
    return {.runs = static_cast<int>(runs_.size())};
  }

  SweepResult to_end() {
    if (o_.executor == Executor::slurm) slurm_.emplace(folder_);
    const FolderLock lock(folder_, "sweep");
    leave_jobs_alone();
    prepare();
    table_.emplace(folder_ / "results.csv", study_.axes, runs_);
    find_equal_runs();
    if (slurm_)
      by_slurm();
    else
      here();
    const int failed = table_->failed();
    if (interrupted_)
      fmt::print("interrupted with {} of {} runs done; the same command goes on from here{}\n",
                 table_->size(), runs_.size(),
                 slurm_ && !slurm_->jobs().empty()
                     ? fmt::format(". Slurm works on: scancel {} ends it", slurm_->jobs())
                     : "");
    else if (lost_ > 0)
      tell(
          fmt::format("{} of {} runs were ended by Slurm, not by themselves (sacct -j {} says why); the same "
                      "command tries them again",
                      lost_, runs_.size(), slurm_->jobs(",")));
    else
      fmt::print("{}: {} runs, {} failed\n", (folder_ / "results.csv").string(), runs_.size(), failed);
    return {static_cast<int>(runs_.size()), failed, lost_, interrupted_};
  }

 private:
  struct Going {
    std::size_t run;
    int cores;
    Clock::time_point start;
    Child child;
  };

  fs::path run_folder(std::size_t r) const { return folder_ / "runs" / runs_[r].name; }
  fs::path input(std::size_t r) const { return folder_ / "inputs" / (runs_[r].name + ".yaml"); }
  fs::path log(std::size_t r) const { return folder_ / "logs" / (runs_[r].name + ".txt"); }

  void look_for_interrupt() {
    interrupted_ = interrupted_ || std::ranges::any_of(o_.observers, [](Observer* observer) {
                     return !observer->interrupt().empty();
                   });
  }

  // ---- by processes of this one ------------------------------------------------------------------------------

  void here() {
    std::size_t next = 0;
    for (;;) {
      look_for_interrupt();
      if (interrupted_ && !told_) {
        for (Going& going : going_) going.child.terminate();
        told_ = true;
      }
      for (; !interrupted_ && next < runs_.size() && begin(next); ++next) {
      }
      collect();
      if (going_.empty() && (interrupted_ || next == runs_.size())) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  // ---- by Slurm ----------------------------------------------------------------------------------------------

  /// Throws std::invalid_argument where two would work on the same runs.
  void leave_jobs_alone() const {
    if (!Slurm::used(folder_) || !Slurm::missing().empty() || (slurm_ && !o_.force)) return;
    const Slurm before(folder_);
    if (const auto alive = before.alive(); !alive || !alive->empty())
      throw std::invalid_argument(fmt::format(
          "{}: Slurm is at work in it (job {}). Go on with --executor slurm, or end it with scancel first.",
          folder_.string(), before.jobs()));
  }

  /// What is known of a run that has ended of its own.
  std::optional<SweepTable::Cells> ended(std::size_t r) const {
    auto found = summary_of(run_folder(r));
    if (found) return found->at("status") != "interrupted" ? found : std::nullopt;
    if (!fs::exists(run_folder(r))) return std::nullopt;  // somebody wants it tried again
    const auto end = slurm_->end_of(runs_[r].name);
    return end ? std::optional(failed_cells(r, end->wait_status, end->seconds)) : std::nullopt;
  }

  void by_slurm() {
    std::map<std::size_t, int> waiting;  // how often it was missed, by run
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      if (table_->has(r)) continue;
      if (const auto found = ended(r))
        settle(r, *found);
      else
        waiting[r] = 0;
    }
    look_for_interrupt();
    auto alive = slurm_->alive();
    while (!alive && !interrupted_) alive = asked_again();
    std::vector<std::string> fresh;
    int cores = 1;
    for (const auto& [r, missed] : waiting)
      if (alive && !alive->contains(runs_[r].name)) {
        fresh.push_back(runs_[r].name);
        cores = std::max(cores, threads(r));
      }
    if (!fresh.empty() && !interrupted_) slurm_->submit(fresh, o_.program, cores, o_.jobs);
    if (!waiting.empty()) fmt::print("{} runs with Slurm, job {}\n", waiting.size(), slurm_->jobs());
    std::fflush(stdout);
    while (!waiting.empty() && !interrupted_) {
      alive = asked_again();
      for (auto at = waiting.begin(); alive && at != waiting.end();) {
        const std::size_t r = at->first;
        const bool in_queue = alive->contains(runs_[r].name);
        const auto found = in_queue && !slurm_->end_of(runs_[r].name) ? std::nullopt : ended(r);
        if (found) settle(r, *found);
        const bool is_lost = !found && !in_queue && ++at->second == patience;
        lost_ += is_lost;
        at = found || is_lost ? waiting.erase(at) : std::next(at);
      }
    }
  }

  std::optional<std::set<std::string>> asked_again() {
    for (int k = 0; k < 50 && !interrupted_; ++k) {
      std::this_thread::sleep_for(between_questions / 50);
      look_for_interrupt();
    }
    auto alive = slurm_->alive();
    if (!alive && !silent_) tell("squeue has no answer; waiting for it");
    silent_ = !alive;
    return alive;
  }

  // ---- cores -------------------------------------------------------------------------------------------------

  int threads(std::size_t r) const {
    if (runs_[r].scene.patch().cells() <= small_cells) return 1;
    return o_.jobs > 0 && !slurm_ ? std::max(1, cores_ / o_.jobs) : cores_;
  }
  bool room_for(std::size_t r) const {
    if (o_.jobs > 0) return std::ssize(going_) < o_.jobs;
    int busy = 0;
    for (const Going& going : going_) busy += going.cores;
    return busy + threads(r) <= cores_;
  }
  /// How many times faster than one thread all goes, at best.
  double at_once() const {
    int most = 1;
    for (std::size_t r = 0; r < runs_.size(); ++r) most = std::max(most, threads(r));
    return o_.jobs > 0 ? std::min(cores_, o_.jobs * most) : cores_;
  }

  // ---- the folder --------------------------------------------------------------------------------------------

  void prepare() {
    const auto refuse = [&](const std::string& what) {
      throw std::invalid_argument(fmt::format("{}: holds {}", folder_.string(), what));
    };
    if (!fs::exists(folder_ / own_files[0]))
      for (const char* name : own_folders)
        if (fs::exists(folder_ / name))
          refuse(fmt::format("{}, not written by a sweep. Choose another folder with --out.", name));
    if (o_.force) {
      for (const char* name : own_files) fs::remove(folder_ / name);
      for (const char* name : own_folders) fs::remove_all(folder_ / name);
      fs::remove_all(folder_ / job_folder);
    }
    for (std::size_t r = 0; r < runs_.size(); ++r)
      if (const std::string before = text_at(input(r)); !before.empty() && before != to_yaml(runs_[r].scene))
        refuse(fmt::format(
            "the runs of another study, or of a version with other keys ({}). Choose another folder "
            "with --out, or replace them with --force.",
            input(r).filename().string()));
    write_atomically(folder_ / own_files[0], text_at(study_.file));
    for (const char* name : own_folders) fs::create_directories(folder_ / name);
    for (std::size_t r = 0; r < runs_.size(); ++r)
      if (!fs::exists(input(r))) write_atomically(input(r), to_yaml(runs_[r].scene));
  }

  void find_equal_runs() {
    if (o_.equal_runs_in.empty()) return;
    for (const auto& sweep : fs::directory_iterator(o_.equal_runs_in)) {
      if (!fs::is_directory(sweep.path() / own_folders[0])) continue;
      for (const auto& scene : fs::directory_iterator(sweep.path() / own_folders[0])) {
        const fs::path run = sweep.path() / own_folders[2] / scene.path().stem();
        if (const auto found = summary_of(run); found && found->at("status") != "interrupted")
          equal_.emplace(text_at(scene.path()), fs::canonical(run));
      }
    }
  }

  // ---- runs --------------------------------------------------------------------------------------------------

  /// False if there is no room for it yet.
  bool begin(std::size_t r) {
    if (table_->has(r)) return true;
    if (const auto found = summary_of(run_folder(r)); found && found->at("status") != "interrupted") {
      add(r, *found);  // of a process that was killed before it came to its row
      return true;
    }
    if (const auto equal = equal_.find(text_at(input(r))); equal != equal_.end()) {
      fs::remove_all(run_folder(r));
      fs::create_directory_symlink(equal->second, run_folder(r));
      add(r, *summary_of(run_folder(r)));
      return true;
    }
    if (!room_for(r)) return false;
    going_.push_back({r, threads(r), Clock::now(),
                      Child({o_.program.string(), "run", input(r).string(), "--out", run_folder(r).string(),
                             "--resume", "--quiet", "--threads", fmt::format("{}", threads(r))},
                            log(r))});
    return true;
  }

  void collect() {
    for (std::size_t k = 0; k < going_.size();) {
      Going& going = going_[k];
      const std::optional<int> status = going.child.wait_status();
      if (!status) {
        ++k;
        continue;
      }
      const std::size_t r = going.run;
      const double seconds = std::chrono::duration<double>(Clock::now() - going.start).count();
      going_.erase(going_.begin() + static_cast<std::ptrdiff_t>(k));
      auto found = summary_of(run_folder(r));
      if (interrupted_ && (!found || found->at("status") == "interrupted")) continue;  // again next time
      settle(r, found ? *found : failed_cells(r, *status, seconds));
    }
  }

  /// Of a run that ended without a summary.
  SweepTable::Cells failed_cells(std::size_t r, int wait_status, double seconds) const {
    const std::string words = last_line(text_at(log(r)));
    return {{"status", "failed"},
            {"wall_seconds", fmt::format("{:.3f}", seconds)},
            {"reason", text_of_wait_status(wait_status) + (words.empty() ? "" : ": " + words)}};
  }

  void settle(std::size_t r, const SweepTable::Cells& cells) {
    if (cells.at("status") != "failed") fs::remove(log(r));  // run.log has it all
    add(r, cells);
  }

  void add(std::size_t r, const SweepTable::Cells& cells) {
    table_->add(r, cells);
    spent_ += std::stod(cells.at("wall_seconds"));
    foreseen_ += seconds_[r];
    double rest = 0;
    for (std::size_t k = 0; k < runs_.size(); ++k)
      if (!table_->has(k)) rest += seconds_[k];
    const double pace = foreseen_ > 0 ? spent_ / foreseen_ : 1;
    const auto rate = cells.find("discharge_rate");
    fmt::print(
        "[{}/{}] {} {}: {}{}, {}{}\n", table_->size(), runs_.size(), runs_[r].name, runs_[r].text(study_),
        cells.at("status"),
        rate != cells.end() ? fmt::format(", discharge {:.6s}", rate->second) : ", " + cells.at("reason"),
        duration_text(std::stod(cells.at("wall_seconds"))),
        rest > 0 ? fmt::format("; about {} left", duration_text(rest * pace / at_once())) : "");
    std::fflush(stdout);
  }

  const SweepOptions& o_;
  Study study_;
  std::vector<std::string> warnings_;
  std::vector<StudyRun> runs_;
  fs::path folder_;
  int cores_;
  std::vector<double> seconds_;  ///< by run, foreseen on one thread
  std::optional<SweepTable> table_;
  std::vector<Going> going_;
  std::map<std::string, fs::path> equal_;  ///< run folders of other sweeps by the text of their scenes
  std::optional<Slurm> slurm_;
  int lost_ = 0;
  bool interrupted_ = false, told_ = false, silent_ = false;
  double spent_ = 0, foreseen_ = 0;  ///< of the runs done by this call
};

}  // namespace

SweepResult sweep(const Study& study, const SweepOptions& options) {
  Sweep all(study, options);
  return options.dry_run ? all.dry_run() : all.to_end();
}

SweepResult sweep(const SweepOptions& options) { return sweep(read_study(options.study), options); }

}  // namespace hourglass
