#include "perf/harness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

#include "io/provenance.hpp"
#include "perf/stream.hpp"
#include "solver/timers.hpp"

namespace hourglass::perf {
namespace {

bool failed = false;
std::map<std::string, std::string> flags;
std::vector<Result> all_results;

double seconds_of(const Job& job, int times) {
  const auto start = Clock::now();
  const double ran = thread_seconds();
  job.run(times);
  return job.one_thread ? thread_seconds() - ran : seconds_since(start);
}

void measure(benchmark::State& state, const std::string& name, const Case& c, int threads) {
  const int n = static_cast<int>(state.range(0));
  const double cells = double(n) * n;
  const FlushDenormals flush;  // for the plain twin; teams have their own
  const double off = c.difference();
  if (!(off <= c.tolerance))
    return wrong(state, fmt::format("is off by {:.2g}, more than {:.2g}", off, c.tolerance));
  Triad triad(cells * c.resident);
  std::vector<Job> jobs{on_threads(threads, c.fast),
                        on_threads(threads, [&](Team& team) { triad.run(team); })};
  if (c.plain)
    jobs.push_back({[&](int times) {
      for (int k = 0; k < times; ++k) c.plain();
    }});
  for (auto _ : state) {
    const auto turns = take_turns(jobs);
    const double fast = median(turns[0]);
    state.SetIterationTime(fast);
    state.counters["cells/s"] = cells / fast;
    state.counters["B/cell"] = c.bytes;
    state.counters["triad_GB/s"] = triad.bytes() / median(turns[1]) / 1e9;
    state.counters["%roof"] = 100 * cells * c.bytes / triad.bytes() * median_ratio(turns[1], turns[0]);
    if (c.iterations > 0) state.counters["its"] = c.iterations;
    if (c.plain) state.counters["x_plain"] = median_ratio(turns[2], turns[0]);
    all_results.push_back({name, n, threads, c.bytes, cells / fast, c.plain ? cells / median(turns[2]) : 0});
  }
  if (!triad.right()) wrong(state, "the triad is wrong");
}

}  // namespace

double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < a.size(); ++k) ratios.push_back(a[k] / b[k]);
  return median(ratios);
}

Job on_threads(int threads, std::function<void(Team&)> body) {
  const auto run = [threads, body = std::move(body)](int times) {
    parallel(threads, [&](Team& team) {
      for (int k = 0; k < times; ++k) {
        body(team);
        team.sync();
      }
    });
  };
  return {run, threads == 1};
}

std::vector<std::vector<double>> take_turns(const std::vector<Job>& jobs) {
  constexpr double slice = 5e-4;
  constexpr std::size_t least = 9;
  static const double budget = std::stod(flag("seconds", "0.2"));
  std::vector<int> times;
  for (const Job& job : jobs) {
    job.run(1);
    const double once = std::min(seconds_of(job, 1), seconds_of(job, 1));
    times.push_back(std::clamp(static_cast<int>(slice / once), 1, 1000000));
  }
  std::vector<std::vector<double>> turns(jobs.size());
  for (const auto start = Clock::now(); turns[0].size() < least || seconds_since(start) < budget;)
    for (std::size_t k = 0; k < jobs.size(); ++k)
      turns[k].push_back(seconds_of(jobs[k], times[k]) / times[k]);
  return turns;
}

const std::vector<Result>& results() { return all_results; }

void add(const std::string& name, const std::vector<int>& sizes, const std::function<Case(int n)>& make) {
  for (int threads : {1, 2})
    for (int n : sizes)
      benchmark::RegisterBenchmark(name.c_str(),
                                   [name, threads, make](benchmark::State& state) {
                                     measure(state, name, make(static_cast<int>(state.range(0))), threads);
                                   })
          ->ArgNames({"", "threads"})
          ->Args({n, threads})
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMicrosecond);
}

void wrong(benchmark::State& state, const std::string& what) {
  failed = true;
  state.SkipWithError(what.c_str());
}

std::string flag(const std::string& name, const std::string& otherwise) {
  const auto found = flags.find(name);
  return found == flags.end() ? otherwise : found->second;
}

void start(int argc, char** argv, const std::vector<std::string>& own_flags) {
  static char table[] = "--benchmark_counters_tabular=true";
  std::vector<char*> others{argv[0], table};
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    const std::size_t equals = std::min(argument.find('='), argument.size());
    const std::string name = argument.substr(std::min<std::size_t>(2, equals), equals - 2);
    if (argument.starts_with("--") &&
        (name == "seconds" || std::find(own_flags.begin(), own_flags.end(), name) != own_flags.end())) {
      flags[name] = equals < argument.size() ? argument.substr(equals + 1) : "yes";
    } else {
      others.push_back(argv[k]);
    }
  }
  int count = static_cast<int>(others.size());
  benchmark::Initialize(&count, others.data());
  if (benchmark::ReportUnrecognizedArguments(count, others.data())) std::exit(2);
  const Provenance p = provenance();
  benchmark::AddCustomContext("revision", p.revision);
  benchmark::AddCustomContext("compiler", p.compiler);
  benchmark::AddCustomContext("flags", p.flags);
  benchmark::AddCustomContext("cpu", p.cpu);
}

int finish() {
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return failed ? 1 : 0;
}

}  // namespace hourglass::perf
