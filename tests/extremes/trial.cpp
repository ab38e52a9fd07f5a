#include "tests/extremes/trial.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "io/csv.hpp"
#include "solver/diagnostics.hpp"
#include "solver/simulation.hpp"

namespace hourglass {
namespace {

constexpr double mass_tolerance = 1e-4, most_speed = 100;

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

bool is_finite(const SeriesRow& r) {
  return all_finite({r.step.t, r.step.dt, r.mass, r.outflow, r.fed.value_or(0), r.quasi_static_fraction,
                     r.quasi_static_1e2, r.quasi_static_1e4, r.quasi_static_above_flat_top.value_or(0),
                     r.ill_posed_fraction, r.max_speed, r.step.max_divergence, r.step.max_speed}) &&
         all_finite(r.orifice_outflow) && all_finite(r.material_mass) && all_finite(r.material_outflow);
}

class FiniteSeries : public Observer {
 public:
  void on_series(const SeriesRow& row) override {
    if (holds && !is_finite(row)) holds = false, t = row.step.t;
    fastest = std::max(fastest, row.max_speed);
  }
  bool holds = true;
  double t = 0, fastest = 0;
};

/// The first of the fields that output.fields may name, and of those that are advected, which holds a value that is not
/// finite; empty if there is none.
std::string bad_field(const Simulation& simulation) {
  if (std::string bad = not_finite(simulation.fields()); !bad.empty()) return bad;
  for (const FieldInfo& info : known_fields()) {
    if (!has_field(simulation.scene(), info)) continue;
    const CellField field = simulation.derived(info.name);
    for (int j = 0; j < field.ny(); ++j)
      for (int i = 0; i < field.nx(); ++i)
        if (!std::isfinite(field(i, j)))
          return fmt::format("{} is {} at cell ({}, {})", info.name, field(i, j), i, j);
  }
  return {};
}

bool warned_of(const Summary& summary, const char* word) {
  return std::any_of(summary.warnings.begin(), summary.warnings.end(),
                     [&](const std::string& w) { return w.find(word) != std::string::npos; });
}

Trial run(const Scene& scene) {
  const auto refused = check(scene);
  const auto fatal = std::find_if(refused.begin(), refused.end(), [](const Problem& p) { return p.fatal; });
  if (fatal != refused.end()) return {{"outcome", "refused"}, {"cause", fatal->path + ": " + fatal->message}};

  Simulation simulation(scene);
  FiniteSeries series;
  const Summary summary = simulation.run({&series});
  const double fall = std::sqrt(2 * scene.g() * scene.height);
  Outcome outcome = Outcome::finished;
  std::string cause = summary.reason;
  const std::string bad = bad_field(simulation);
  if (!bad.empty() || !series.holds) {
    outcome = Outcome::not_a_number;
    cause = (bad.empty() ? fmt::format("series at t = {:.6g}", series.t) : bad) + "; " + summary.reason;
  } else if (summary.reason.empty()) {
    outcome = Outcome::no_cause;
  } else if (summary.missed_tolerances > 0 && summary.warnings.empty()) {
    outcome = Outcome::silent_miss;
  } else if (!(summary.mass_error <= mass_tolerance) && !warned_of(summary, "mass")) {
    outcome = Outcome::mass_missed;
  } else if (summary.status != Status::finished) {
    outcome = Outcome::stopped;
  } else if (series.fastest > most_speed * fall && !warned_of(summary, "speed")) {
    outcome = Outcome::runaway;
  } else if (summary.back_offs > 0) {
    outcome = Outcome::backed_off;
  }
  return {{"outcome", outcome_names[static_cast<std::size_t>(outcome)]},
          {"status", name_of(summary.status)},
          {"cause", cause},
          {"steps", std::to_string(summary.steps)},
          {"back_offs", std::to_string(summary.back_offs)},
          {"mass_error", fmt::format("{:.2g}", summary.mass_error)},
          {"missed_tolerances", std::to_string(summary.missed_tolerances)},
          {"speed_over_fall", fmt::format("{:.3g}", series.fastest / fall)},
          {"warnings", std::to_string(summary.warnings.size())},
          {"first_warning", summary.warnings.empty() ? "" : summary.warnings.front()}};
}

[[noreturn]] void child(const Scene& scene, double cpu_limit, int out) {
  const auto seconds = static_cast<rlim_t>(std::ceil(cpu_limit));
  const rlimit cpu{seconds, seconds}, none{0, 0};
  setrlimit(RLIMIT_CPU, &cpu);
  setrlimit(RLIMIT_CORE, &none);
  alarm(static_cast<unsigned>(20 * seconds));  // it may wait instead
  Trial trial;
  try {
    trial = run(scene);
  } catch (const std::exception& error) {
    trial = {{"outcome", "crashed"}, {"cause", error.what()}};
  }
  std::vector<std::string> cells;
  for (const std::string& column : trial_columns()) cells.push_back(trial[column]);
  const std::string text = csv_row(cells);
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(out, text.data() + done, text.size() - done);
    if (n <= 0) _exit(1);
    done += static_cast<std::size_t>(n);
  }
  _exit(0);
}

}  // namespace

const std::vector<std::string>& trial_columns() {
  static const std::vector<std::string> columns{
      "outcome",           "status",          "cause",    "steps",         "back_offs",  "mass_error",
      "missed_tolerances", "speed_over_fall", "warnings", "first_warning", "cpu_seconds"};
  return columns;
}

Trial try_scene(const Scene& scene, double cpu_limit) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("no process");
  if (pid == 0) {
    close(ends[0]);
    child(scene, cpu_limit, ends[1]);
  }
  close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  rusage used{};
  wait4(pid, &status, 0, &used);
  Trial trial;
  const auto rows = csv_rows(text);
  if (rows.size() == 1 && rows[0].size() == trial_columns().size()) {
    for (std::size_t c = 0; c < rows[0].size(); ++c) trial[trial_columns()[c]] = rows[0][c];
  } else {
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const bool hung = signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL;
    trial["outcome"] = outcome_names[static_cast<std::size_t>(hung ? Outcome::hung : Outcome::crashed)];
    trial["cause"] = signal ? fmt::format("signal {} ({})", signal, strsignal(signal))
                            : fmt::format("exit status {}", WEXITSTATUS(status));
  }
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  trial["cpu_seconds"] = fmt::format("{:.2f}", seconds(used.ru_utime) + seconds(used.ru_stime));
  return trial;
}

}  // namespace hourglass
