// The standing suite of extreme scenes: each ends as it should, or the program ends with status 1.
//
//   extremes --all --out DIR        all of them; goes on where it was stopped
//   extremes --part 24              every fourteenth
//   extremes --only 17              one
//   extremes --scene 17             its scene file, for `hourglass run`
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <numeric>
#include <optional>

#include "io/csv.hpp"
#include "io/scene_yaml.hpp"
#include "tests/extremes/extreme_scene.hpp"
#include "tests/extremes/trial.hpp"

using namespace hourglass;

namespace {

/// What a stop's sentence has in common with others: numbers and what follows a colon left out.
std::string kind_of(const std::string& cause) {
  std::string kind;
  for (const char c : cause.substr(0, cause.find(" at t = "))) {
    const bool digit = (c >= '0' && c <= '9') || c == '.';
    if (!digit)
      kind += c;
    else if (kind.empty() || kind.back() != '#')
      kind += '#';
  }
  return kind.substr(0, 150);
}

/// The table at the end; whether no outcome is forbidden.
bool report(const std::vector<Trial>& trials) {
  std::map<std::string, int> count, causes;
  double seconds = 0;
  for (const Trial& t : trials) {
    ++count[t.at("outcome")];
    if (t.at("outcome") == "stopped" || t.at("outcome") == "refused")
      ++causes[t.at("outcome") + ": " + kind_of(t.at("cause"))];
    seconds += std::stod(t.at("cpu_seconds"));
  }
  fmt::print("\n{} scenes, {:.0f} processor seconds\n", trials.size(), seconds);
  bool sound = true;
  for (std::size_t k = 0; k < outcome_names.size(); ++k) {
    const bool forbidden = is_forbidden(static_cast<Outcome>(k));
    const int n = count[outcome_names[k]];
    fmt::print("{:>6}  {}{}\n", n, outcome_names[k], forbidden ? "  (must be 0)" : "");
    if (forbidden && n > 0) sound = false;
  }
  if (!causes.empty()) fmt::print("\nCauses\n");
  for (const auto& [cause, n] : causes) fmt::print("{:>6}  {}\n", n, cause);
  return sound;
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): what it throws may end it
  CLI::App app{
      "Extreme scenes: finished, stopped with a cause, or refused; never NaN, a hang, a crash or missing "
      "mass."};
  bool all = false;
  int part = 0, only = -1, scene = -1;
  double cpu_limit = 60;
  std::filesystem::path out;
  app.add_flag("--all", all, fmt::format("all {} scenes", extreme_scenes));
  app.add_option("--part", part, "so many, spread over all")->check(CLI::Range(1, extreme_scenes));
  app.add_option("--only", only, "the scene of this number")->check(CLI::Range(0, extreme_scenes - 1));
  app.add_option("--scene", scene, "print the file of the scene of this number")
      ->check(CLI::Range(0, extreme_scenes - 1));
  app.add_option("--out", out, "folder of extremes.csv, which a later call goes on with");
  app.add_option("--cpu-limit", cpu_limit, "processor seconds of one scene, beyond which it counts as hung");
  app.require_option(1, 3);
  CLI11_PARSE(app, argc, argv);
  if (scene >= 0) {
    fmt::print("{}", to_yaml(extreme_scene(scene).scene));
    return 0;
  }
  std::vector<int> numbers(only >= 0 ? 1 : all ? extreme_scenes : part);
  std::iota(numbers.begin(), numbers.end(), 0);
  for (int& n : numbers)
    n = only >= 0
            ? only
            : static_cast<int>(static_cast<long>(n) * extreme_scenes / static_cast<long>(numbers.size()));

  std::vector<std::string> columns{"number"};
  columns.insert(columns.end(), trial_columns().begin(), trial_columns().end());
  columns.insert(columns.end(), drawn_names().begin(), drawn_names().end());
  std::optional<Ledger> ledger;
  if (!out.empty()) {
    std::filesystem::create_directories(out);
    ledger.emplace(out / "extremes.csv", columns);
  }
  std::vector<Trial> trials;
  for (const int n : numbers) {
    const std::string key = std::to_string(n);
    if (ledger && ledger->find(key)) {
      trials.push_back(*ledger->find(key));
      continue;
    }
    const ExtremeScene extreme = extreme_scene(n);
    Trial trial = try_scene(extreme.scene, cpu_limit);
    fmt::print("{:>4}  {:<12} {:>6} s  {}\n", n, trial["outcome"], trial["cpu_seconds"], trial["cause"]);
    std::fflush(stdout);
    trial["number"] = key;
    trial.insert(extreme.drawn.begin(), extreme.drawn.end());
    if (ledger) ledger->add(trial);
    trials.push_back(std::move(trial));
  }
  return report(trials) ? 0 : 1;
}
