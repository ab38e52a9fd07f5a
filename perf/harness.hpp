#pragma once
// What the benchmark programs share. A case runs a kernel, its plain twin and the triad in turns of about
// half a millisecond, for what disturbs the machine disturbs neighbours alike; figures are medians over
// turns, and ratios are medians of ratios within a turn. One iteration of Google Benchmark is one such
// series; its "time" is the median.
#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass::perf {

double median(std::vector<double> values);
/// Median of a[k] / b[k].
double median_ratio(const std::vector<double>& a, const std::vector<double>& b);

/// Seconds that this thread has run: what a neighbour takes of its core is not in it. Of a job on more
/// threads the wall clock tells.
double thread_seconds();

struct Job {
  std::function<void(int times)> run;
  bool one_thread = true;
};
/// Runs `body` on a team; one region for all times, as in a stage of the solver.
Job on_threads(int threads, std::function<void(Team&)> body);

/// [job][turn]: seconds a run. At least nine turns, and about as long as --seconds says.
std::vector<std::vector<double>> take_turns(const std::vector<Job>& jobs);

/// A kernel on n x n cells and its plain twin.
struct Case {
  double bytes;     ///< moved a cell, by the kernel's contract
  double resident;  ///< held a cell by the arrays that it touches; the triad's arrays are as large
  std::function<void(Team&)> fast;
  std::function<void()> plain;         ///< may be empty
  std::function<double()> difference;  ///< runs both from the same state; relative to the largest value
  double tolerance;                    ///< of the difference
  double iterations = 0;               ///< of a solve
};

struct Result {
  std::string name;
  int n, threads;
  double bytes, cells_per_second, plain_cells_per_second;
};
/// Of every case measured so far.
const std::vector<Result>& results();

/// Registers name/n/threads:t for each n and 1 and 2 threads; `make` builds the case for n.
void add(const std::string& name, const std::vector<int>& sizes, const std::function<Case(int n)>& make);

/// The case is reported as wrong, and the program will exit with 1.
void wrong(benchmark::State& state, const std::string& what);

/// The value of --NAME=..., or otherwise. Ask after start().
std::string flag(const std::string& name, const std::string& otherwise = "");

/// Takes our own flags (--seconds=0.2 a case, and what flag() asks for) from the command line, hands the
/// others to Google Benchmark, and notes compiler, flags and revision.
void start(int argc, char** argv, const std::vector<std::string>& own_flags = {});
/// Runs what is registered; the exit status.
int finish();

// ---- differences of answers ----

/// max |a - b| / max |b| over the points of one kind.
template <class F>
double relative_difference(const F& a, const F& b) {
  double worst = 0, largest = 0;
  for (int k = 0; k < row_count(a); ++k) {
    const auto x = row_of(a, k), y = row_of(b, k);
    for (int i = 0; i < x.n; ++i) {
      const double off = std::abs(static_cast<double>(x.data[i]) - static_cast<double>(y.data[i]));
      if (std::isnan(off)) return off;
      worst = std::max(worst, off);
      largest = std::max(largest, std::abs(static_cast<double>(y.data[i])));
    }
  }
  return worst / largest;
}

}  // namespace hourglass::perf
