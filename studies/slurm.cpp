#include "studies/slurm.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "studies/child.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most_tasks =
    1000;  ///< of an array: Slurm's own limit unless its administrators raise it

// Called with the list of runs, the program and the folder. The status of the run is written last: a task that Slurm ends
// leaves none.
constexpr const char* script = R"sh(#!/bin/bash
# Written by hourglass sweep --executor slurm: one task, one run.
cd "$3" || exit 1
run=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" "$1")
[ -n "$run" ] || exit 1
rm -rf "runs/$run" "slurm/$run.end" && mkdir "runs/$run" || exit 1
"$2" run "inputs/$run.yaml" --out "runs/$run" --quiet --threads "${SLURM_CPUS_PER_TASK:-1}" \
  >/dev/null 2>"logs/$run.txt" </dev/null
status=$?
echo "$status $SECONDS" >"slurm/$run.end.new" && mv "slurm/$run.end.new" "slurm/$run.end"
exit $status
)sh";

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + '/' + program).c_str(), X_OK) == 0) return true;
  return false;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace

Slurm::Slurm(const fs::path& folder) : folder_(fs::absolute(folder)) {
  if (const std::string program = missing(); !program.empty())
    throw std::invalid_argument(
        fmt::format("--executor slurm: there is no {} here. Run it where jobs are submitted to Slurm, or "
                    "use --executor local.",
                    program));
}

std::string Slurm::missing() {
  for (const char* program : {"sbatch", "squeue"})
    if (!on_path(program)) return program;
  return {};
}

bool Slurm::used(const fs::path& folder) { return fs::exists(folder / "slurm/jobs.csv"); }

std::vector<std::string> Slurm::listed(const std::string& list) const {
  return lines_of(text_at(own() / list));
}

std::string Slurm::jobs(const char* between) const {
  std::vector<std::string> names;
  for (const auto& row : csv_rows(text_at(own() / "jobs.csv"))) names.push_back(row.at(0));
  return fmt::format("{}", fmt::join(names.begin() + !names.empty(), names.end(), between));
}

std::optional<std::set<std::string>> Slurm::alive() const {
  std::map<std::string, std::vector<std::string>> runs;  // by job
  for (const auto& row : csv_rows(text_at(own() / "jobs.csv")))
    if (row.at(0) != "job") runs[row.at(0)] = listed(row.at(1));
  if (runs.empty()) return std::set<std::string>{};
  // All of this user's: asked about a job that it has forgotten, squeue fails as it does without its server.
  const ProgramOutput queue =
      output_of({"squeue", "--noheader", "--array", fmt::format("--user={}", ::getuid()), "--format=%F %K"});
  if (queue.wait_status != 0) return std::nullopt;
  std::set<std::string> out;
  for (const std::string& line : lines_of(queue.out)) {
    const std::size_t space = line.find(' ');
    const auto job = runs.find(line.substr(0, space));
    const std::size_t task = std::strtoul(line.c_str() + std::min(space, line.size()), nullptr, 10);
    if (job != runs.end() && task < job->second.size()) out.insert(job->second[task]);
  }
  return out;
}

void Slurm::submit(const std::vector<std::string>& runs, const fs::path& program, int threads, int at_once) {
  fs::create_directories(own());
  write_atomically(own() / "job.sh", script);
  std::string table = text_at(own() / "jobs.csv");
  if (table.empty()) table = "job,runs\n";
  for (std::size_t first = 0; first < runs.size(); first += most_tasks) {
    const std::size_t end = std::min(first + most_tasks, runs.size());
    const std::string list = fmt::format("runs_{}.txt", std::ranges::count(table, '\n'));
    std::string names;
    for (std::size_t k = first; k < end; ++k) {
      names += runs[k] + '\n';
      fs::remove(own() / (runs[k] + ".end"));
    }
    write_atomically(own() / list, names);
    const ProgramOutput job = output_of(
        {"sbatch", "--parsable", "--job-name=" + folder_.filename().string(), "--output=/dev/null",
         "--chdir=" + folder_.string(), fmt::format("--cpus-per-task={}", threads),
         fmt::format("--array=0-{}{}", end - first - 1, at_once > 0 ? fmt::format("%{}", at_once) : ""),
         (own() / "job.sh").string(), (own() / list).string(), fs::canonical(program).string(),
         folder_.string()});
    if (job.wait_status != 0)
      throw std::runtime_error(fmt::format("sbatch, {}: {}", text_of_wait_status(job.wait_status), job.err));
    // "12" or "12;cluster"
    table += csv_row({job.out.substr(0, job.out.find_first_of(";\n")), list});
    write_atomically(own() / "jobs.csv", table);
  }
}

std::optional<TaskEnd> Slurm::end_of(const std::string& run) const {
  int status = 0;
  TaskEnd end;
  std::istringstream text(text_at(own() / (run + ".end")));
  if (!(text >> status >> end.seconds)) return std::nullopt;
  // The shell tells of a signal n as of status 128 + n.
  end.wait_status = status > 128 ? status - 128 : status << 8;
  return end;
}

}  // namespace hourglass
