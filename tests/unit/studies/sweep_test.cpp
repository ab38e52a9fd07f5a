#include "studies/sweep.hpp"

#include <stdlib.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/scene_yaml.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

// Stands for hourglass: called as run SCENE --out DIR ..., what happens depends on the number of the run.
constexpr const char* stand_in = R"sh(#!/bin/sh
mkdir -p "$4" && echo "$2" >> "$(dirname "$4")/../calls"
summary() { echo "{\"status\": \"$1\", \"reason\": \"$2\", \"discharge_rate\": 1.5, \"wall_seconds\": 0.25}" > "$3"; }
case "$(basename "$4")" in
  0002) echo "first line" >&2; echo "the cause" >&2; exit 1;;
  0003) kill -SEGV $$;;
  0004) summary diverged "NaN, at step 7" "$4/summary.json"; exit 1;;
  *) summary finished "reached time.end" "$4/summary.json";;
esac
)sh";

class StudyOfSix {
 public:
  StudyOfSix() {
    folder_.write("silo.yaml", to_yaml(sound_scene()));
    study("[1, 2, 3, 4, 5, 6]");
    folder_.write("program", stand_in);
    fs::permissions(folder_ / "program", fs::perms::owner_all);
  }
  void study(const std::string& values) const {
    folder_.write("study.yaml", "name: six\nscene: silo.yaml\naxes: {time.end: " + values + "}\n");
  }
  SweepOptions options(int jobs) const {
    return {.study = folder_ / "study.yaml",
            .out = folder_ / "out",
            .jobs = jobs,
            .program = folder_ / "program"};
  }
  std::string table() const { return text_at(folder_ / "out/results.csv"); }
  long calls() const {
    const std::string text = text_at(folder_ / "out/calls");
    return std::count(text.begin(), text.end(), '\n');
  }
  const TestFolder& folder() const { return folder_; }

 private:
  TestFolder folder_;
};

// Stand for Slurm: sbatch does all tasks at once, but for those in the file `skipped`; squeue tells what is in `queue`.
constexpr const char* stand_in_sbatch = R"sh(#!/bin/sh
for word; do
  case "$word" in
    --array=0-*) last=${word#--array=0-};;
    --*) ;;
    *) break;;
  esac
  shift
done
here=$(dirname "$0")
echo "$*" >> "$here/submitted"
shift $(($# - 4))
for task in $(seq 0 "${last%\%*}"); do
  grep -qx "$task" "$here/skipped" || SLURM_ARRAY_TASK_ID=$task bash "$@" 2>/dev/null
done
echo "17;cluster"
)sh";
constexpr const char* stand_in_squeue = R"sh(#!/bin/sh
cat "$(dirname "$0")/queue"
)sh";

/// A study with these two first on the PATH.
class StudyWithSlurm : public StudyOfSix {
 public:
  StudyWithSlurm() {
    const fs::path bin = folder() / "bin";
    fs::create_directories(bin);
    write_atomically(bin / "sbatch", stand_in_sbatch);
    write_atomically(bin / "squeue", stand_in_squeue);
    for (const char* name : {"sbatch", "squeue"}) fs::permissions(bin / name, fs::perms::owner_all);
    say("skipped", "");
    say("queue", "");
    ::setenv("PATH", (bin.string() + ":" + path_).c_str(), 1);
  }
  ~StudyWithSlurm() { ::setenv("PATH", path_.c_str(), 1); }
  void say(const std::string& file, const std::string& text) const {
    write_atomically(folder() / "bin" / file, text);
  }
  SweepOptions by_slurm() const {
    SweepOptions o = options(0);
    o.executor = Executor::slurm;
    return o;
  }
  long submitted() const {
    const std::string text = text_at(folder() / "bin/submitted");
    return std::count(text.begin(), text.end(), '\n');
  }
  /// Without the times.
  std::vector<std::vector<std::string>> rows() const {
    auto rows = csv_rows(table());
    const auto at = std::ranges::find(rows[0], "wall_seconds") - rows[0].begin();
    for (auto& row : rows) row.erase(row.begin() + at);
    return rows;
  }

 private:
  std::string path_ = std::getenv("PATH");
};

class StopsAtOnce : public Observer {
  std::string interrupt() override { return "stop"; }
};

}  // namespace

TEST_CASE("a sweep: a row each run in their order, failed ones with their cause") {
  const StudyOfSix six;
  const SweepResult result = sweep(six.options(3));
  CHECK(result.runs == 6);
  CHECK(result.failed == 3);
  CHECK_FALSE(result.interrupted);
  const auto rows = csv_rows(six.table());
  REQUIRE(rows.size() == 7);
  CHECK(rows[0] == std::vector<std::string>{"run", "time.end", "status", "discharge_rate",
                                            "discharge_constant", "quasi_static_fraction",
                                            "quasi_static_1e-2", "quasi_static_1e-4",
                                            "quasi_static_above_flat_top", "mass_error", "steps", "cells",
                                            "back_offs", "missed_tolerances", "wall_seconds", "reason"});
  for (int k = 1; k <= 6; ++k) {
    CHECK(rows[k][0] == "000" + std::to_string(k));
    CHECK(rows[k][1] == std::to_string(k));
  }
  CHECK(rows[1][2] == "finished");
  CHECK(rows[1][3] == "1.5");
  CHECK(rows[1][14] == "0.25");
  CHECK(rows[2][2] == "failed");
  CHECK(rows[2][3].empty());
  CHECK(rows[2][15] == "exit status 1: the cause");
  CHECK(rows[3][2] == "failed");
  CHECK_THAT(rows[3][15], Contains("killed by signal 11"));
  CHECK(rows[4][2] == "diverged");
  CHECK(rows[4][15] == "NaN, at step 7");

  const std::string before = six.table();
  sweep(six.options(1));
  CHECK(six.calls() == 6);  // all were there
  CHECK(six.table() == before);
}

TEST_CASE("a sweep goes on: only what is missing runs, and more values may be added at the end") {
  const StudyOfSix six;
  sweep(six.options(2));
  const std::string whole = six.table();
  const auto lines = csv_rows(whole);
  write_atomically(six.folder() / "out/results.csv",
                   csv_row(lines[0]) + csv_row(lines[1]) + csv_row(lines[6]));
  fs::remove(six.folder() /
             "out/runs/0005/summary.json");  // as if it had been killed; 0004 lacks its row only
  sweep(six.options(1));
  CHECK(six.calls() == 6 + 3);  // 2, 3 and 5
  CHECK(csv_rows(six.table())[5] == lines[5]);
  CHECK(csv_rows(six.table())[2][15] == "exit status 1: the cause");

  six.study("[1, 2, 3, 4, 5, 6, 7]");
  CHECK(sweep(six.options(1)).runs == 7);
  CHECK(six.calls() == 10);

  six.study("[1, 2, 3, 4, 5]");
  CHECK_THROWS_WITH(sweep(six.options(1)), Contains("row 0006 is of no run of this study"));
  six.study("[1, 2, 3, 4, 5, 8, 7]");
  CHECK_THROWS_WITH(sweep(six.options(1)),
                    Contains("holds the runs of another study") && Contains("--force"));
  SweepOptions force = six.options(1);
  force.force = true;
  CHECK(sweep(force).runs == 7);
  CHECK(csv_rows(six.table())[6][1] == "8");
}

TEST_CASE("a sweep takes over what another one has run of an equal scene") {
  const StudyOfSix six;
  sweep(six.options(2));
  six.study("[7, 6, 1]");
  SweepOptions second = six.options(1);
  second.out = six.folder() / "second";
  second.equal_runs_in = second.out.parent_path();
  CHECK(sweep(second).failed == 0);
  const std::string calls = text_at(second.out / "calls");
  CHECK(std::count(calls.begin(), calls.end(), '\n') == 1);  // 7
  CHECK(fs::is_symlink(second.out / "runs/0002"));
  const auto rows = csv_rows(text_at(second.out / "results.csv"));
  REQUIRE(rows.size() == 4);
  CHECK(rows[2][3] == "1.5");
}

TEST_CASE("a sweep leaves alone what it has not written, and one folder has one sweep") {
  const StudyOfSix six;
  fs::create_directories(six.folder() / "out/runs");
  SweepOptions force = six.options(1);
  force.force = true;
  CHECK_THROWS_WITH(sweep(force), Contains("holds runs, not written by a sweep"));
  fs::remove_all(six.folder() / "out/runs");
  const FolderLock lock(six.folder() / "out", "sweep");
  CHECK_THROWS_WITH(sweep(six.options(1)), Contains("another sweep is at work in it"));
}

TEST_CASE("a sweep that is told to stop begins no run, and a dry run writes nothing") {
  const StudyOfSix six;
  SweepOptions options = six.options(1);
  options.dry_run = true;
  CHECK(sweep(options).runs == 6);
  CHECK_FALSE(fs::exists(six.folder() / "out"));
  StopsAtOnce stops;
  options = six.options(1);
  options.observers = {&stops};
  CHECK(sweep(options).interrupted);
  CHECK(six.calls() == 0);
}

TEST_CASE("a sweep by Slurm: the same table, and the same causes of failure") {
  const StudyWithSlurm six;
  sweep(six.options(2));
  const auto rows = six.rows();
  fs::remove_all(six.folder() / "out");
  CHECK(sweep(six.by_slurm()).failed == 3);
  CHECK(six.rows() == rows);
  CHECK(sweep(six.by_slurm()).failed == 3);
  CHECK(six.submitted() == 1);
  CHECK(six.calls() == 6);

  // To try one again: without its row and its folder.
  const auto lines = csv_rows(six.table());
  std::string others;
  for (std::size_t k = 0; k < lines.size(); ++k) others += k == 3 ? "" : csv_row(lines[k]);
  write_atomically(six.folder() / "out/results.csv", others);
  fs::remove_all(six.folder() / "out/runs/0003");
  CHECK(sweep(six.by_slurm()).failed == 3);
  CHECK(six.calls() == 7);
  CHECK(six.rows() == rows);
}

TEST_CASE("a sweep by Slurm: what it ended is lost, and tried again by the next call") {
  const StudyWithSlurm six;
  six.say("skipped", "0\n4\n");
  const SweepResult first = sweep(six.by_slurm());
  CHECK(first.lost == 2);
  CHECK(csv_rows(six.table()).size() == 5);
  six.say("skipped", "");
  const SweepResult second = sweep(six.by_slurm());
  CHECK(second.lost == 0);
  CHECK(csv_rows(six.table()).size() == 7);
  CHECK(six.submitted() == 2);
  CHECK(six.calls() == 6);
  CHECK_THAT(text_at(six.folder() / "out/slurm/runs_2.txt"), Catch::Equals("0001\n0005\n"));
}

TEST_CASE("a sweep by Slurm: what is in its queue is left to it") {
  const StudyWithSlurm six;
  six.say("skipped", "0\n4\n");
  sweep(six.by_slurm());
  six.say("queue", "16 0\n17 4\n");  // another's job, and run 0005
  CHECK_THROWS_WITH(sweep(six.options(1)), Contains("Slurm is at work in it (job 17)"));
  SweepOptions force = six.by_slurm();
  force.force = true;
  CHECK_THROWS_WITH(sweep(force), Contains("end it with scancel first"));
  StopsAtOnce stops;
  SweepOptions options = six.by_slurm();
  options.observers = {&stops};
  CHECK(sweep(options).interrupted);
  six.say("queue", "");
  CHECK(sweep(six.options(1)).failed == 3);  // by this process, now that Slurm is done
  CHECK(six.submitted() == 1);
}

TEST_CASE("a sweep by Slurm: without it, or refused by it, nothing is written") {
  const StudyWithSlurm six;
  six.say("sbatch", "#!/bin/sh\necho 'sbatch: error: invalid partition' >&2\nexit 1\n");
  fs::permissions(six.folder() / "bin/sbatch", fs::perms::owner_all);
  CHECK_THROWS_WITH(sweep(six.by_slurm()), Contains("exit status 1: sbatch: error: invalid partition"));
  fs::remove_all(six.folder() / "out");
  fs::remove(six.folder() / "bin/sbatch");
  ::setenv("PATH", (six.folder() / "bin").c_str(), 1);
  CHECK_THROWS_WITH(sweep(six.by_slurm()), Contains("there is no sbatch here"));
  CHECK_FALSE(fs::exists(six.folder() / "out"));
}
