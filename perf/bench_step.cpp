// Whole steps of the base silo, on one thread and on two in turns from the same state: both do the same work
// to the last bit, so each pair of steps gives a speed-up. States: the developed flow; the first 50 steps; a
// nearly empty silo. Every allocation within a step is counted. `--most=2048` adds finer grids; `--steps=N`
// sets the steps measured.
#include <pthread.h>

#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <thread>

#include "perf/developed.hpp"
#include "perf/harness.hpp"
#include "perf/plain_cycle.hpp"
#include "perf/stream.hpp"
#include "solver/boundary_of.hpp"
#include "solver/timers.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

// ---- allocations: glibc's functions under their own names, counted ----------------------------------------

static std::atomic<long> allocations{0};

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void* malloc(std::size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t m) {
  ++allocations;
  return __libc_calloc(n, m);
}
void* realloc(void* p, std::size_t n) {
  ++allocations;
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
  ++allocations;
  return __libc_memalign(alignment, n);
}
}

using namespace hourglass;

namespace {

/// What is left in the corners when the flow has stopped drawing on them.
Scene nearly_empty(int n) {
  Scene s = silo(n);
  s.fill = {{0, {{0, 0}, {68, 0}, {0, 40}}}, {0, {{82, 0}, {150, 0}, {150, 40}}}};
  return s;
}

struct Phase {
  const char* name;
  int warm_up, steps;  // on the coarser grids
};

std::unique_ptr<Simulation> simulation(const Phase& phase, int n, int threads) {
  Scene scene = phase.name == std::string("empty") ? nearly_empty(n) : silo(n);
  scene.threads = threads;
  auto s = std::make_unique<Simulation>(scene);
  if (phase.name == std::string("developed")) perf::start_developed(*s);
  for (int k = 0; k < phase.warm_up; ++k) s->step();
  return s;
}

bool same(const Fields& a, const Fields& b) {
  return same_bits(a.u, b.u) && same_bits(a.v, b.v) && same_bits(a.p, b.p) && same_bits(a.grains, b.grains);
}

/// Bytes a cell and step: README.md.
double bytes_of(const Simulation& s, double viscous_iterations, double pressure_iterations) {
  const auto passes = smoothing_passes(s.scene().rheology.smoothing_length, s.fields().patch().h).size();
  const double rheology = passes == 0 ? 48 : 24 + 64.0 * static_cast<double>(passes);
  return 664 + rheology + 296 * viscous_iterations + 148 * pressure_iterations;
}

/// Plain cycles on the levels of the silo; what the coefficients are does not matter to their cost.
template <class Level>
std::unique_ptr<perf::PlainCycle<Level>> plain_cycle(const Scene& scene) {
  auto cycle = std::make_unique<perf::PlainCycle<Level>>(scene.patch(), boundary_of(scene));
  Level& level = cycle->finest();
  if constexpr (std::is_same_v<Level, ViscousLevel<float>>) {
    level.a.eta_c.fill(1);
    level.a.eta_n.fill(1);
    level.a.mass.fill(1);
  } else {
    level.a.beta.fill(1);
  }
  Team alone;
  level.finish(alone);
  cycle->coarsen();
  level.b.fill(1);
  return cycle;
}

struct Seconds {
  double wall, ran;  ///< ran: this thread on its core
};
template <class F>
Seconds timed(F&& f) {
  const auto start = Clock::now();
  const double before = perf::thread_seconds();
  f();
  return {seconds_since(start), perf::thread_seconds() - before};
}

struct Cost {
  double cells, seconds, triad;  // B/s
};
std::map<std::string, std::vector<Cost>> costs;  // by flow, on one thread

void step(benchmark::State& state, const Phase& what) {
  const int n = static_cast<int>(state.range(0));
  const double cells = double(n) * n;
  const auto one = simulation(what, n, 1), two = simulation(what, n, 2);
  std::size_t held = 0;
  for (const auto& [name, bytes] : one->memory()) held += bytes;
  Triad triad(static_cast<double>(held));
  const perf::Job triads[2] = {perf::on_threads(1, [&](Team& team) { triad.run(team); }),
                               perf::on_threads(2, [&](Team& team) { triad.run(team); })};
  const int steps =
      std::stoi(perf::flag("steps", std::to_string(std::max(8, what.steps * 256 / std::max(n, 256)))));
  std::vector<double> wall[2], stream[2], ran, plain, viscous, pressure;
  const auto viscous_cycle = plain_cycle<ViscousLevel<float>>(one->scene());
  const auto pressure_cycle = plain_cycle<PoissonLevel<float>>(one->scene());
  long counted = 0;
  for (auto _ : state) {
    for (int k = 0; k < steps; ++k) {
      StepReport reports[2];
      Simulation* const both[2] = {one.get(), two.get()};
      for (int t : {0, 1}) {
        const long before = allocations;
        const Seconds s = timed([&] { reports[t] = both[t]->step(); });
        if (t == 0) counted += allocations - before;
        wall[t].push_back(s.wall);
        if (t == 0) ran.push_back(s.ran);
        const Seconds r = timed([&] { triads[t].run(3); });
        stream[t].push_back((t == 0 ? r.ran : r.wall) / 3);
      }
      for (const StepReport& r : reports)
        if (!r.viscous.converged || !r.pressure.converged)
          return perf::wrong(state, "a solve missed its tolerance");
      const FlushDenormals flush;
      plain.push_back(reports[0].viscous.iterations * timed([&] { viscous_cycle->cycle(); }).ran +
                      reports[0].pressure.iterations * timed([&] { pressure_cycle->cycle(); }).ran);
      viscous.push_back(reports[0].viscous.iterations);
      pressure.push_back(reports[0].pressure.iterations);
    }
    state.SetIterationTime(perf::median(ran));
  }
  if (!same(one->fields(), two->fields())) return perf::wrong(state, "two threads differ from one");
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0;
    for (double x : v) sum += x;
    return sum / static_cast<double>(v.size());
  };
  const double iv = mean(viscous), ip = mean(pressure), bytes = bytes_of(*one, iv, ip);
  const double t1 = perf::median(ran);
  // The roof of a step: its bytes at the triad's rate, in the same turn.
  const auto roof = [&](const std::vector<double>& triad_seconds, const std::vector<double>& step_seconds) {
    return 100 * cells * bytes / triad.bytes() * perf::median_ratio(triad_seconds, step_seconds);
  };
  state.counters["cells/s"] = cells / t1;
  state.counters["cells/s_2"] = cells / perf::median(wall[1]);
  state.counters["speedup_2"] = perf::median_ratio(wall[0], wall[1]);
  state.counters["viscous_its"] = iv;
  state.counters["pressure_its"] = ip;
  state.counters["B/cell"] = bytes;
  state.counters["triad_GB/s"] = triad.bytes() / perf::median(stream[0]) / 1e9;
  state.counters["%roof"] = roof(stream[0], ran);
  state.counters["%roof_2"] = roof(stream[1], wall[1]);
  state.counters["allocs/step"] = static_cast<double>(counted) / steps;
  // What the cycles alone would cost in plain code: a lower bound of the speed-up, for there is no plain
  // step.
  state.counters["x_plain"] = perf::median_ratio(plain, ran);
  costs[what.name].push_back({cells, t1, triad.bytes() / perf::median(stream[0])});
}

/// Seconds a step grow as cells^exponent: as they are (raw), and with the triad's rate at each size divided
/// out. Least squares from 256^2 on.
void exponent(benchmark::State& state) {
  const auto slope = [](const std::vector<Cost>& flow, auto&& cost) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const Cost& c : flow) {
      if (c.cells < 256 * 256) continue;
      const double x = std::log(c.cells), y = std::log(cost(c));
      n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return n > 1 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : std::nan("");
  };
  for (auto _ : state) state.SetIterationTime(0);
  for (const auto& [name, flow] : costs) {
    state.counters[name] = slope(flow, [](const Cost& c) { return c.seconds * c.triad; });
    state.counters[name + "_raw"] = slope(flow, [](const Cost& c) { return c.seconds; });
  }
}

/// Somebody else keeps the last core busy: what a run on two threads then takes, over the same run on one;
/// all of its steps, and the later half, when it has had time to find out.
void neighbour(benchmark::State& state) {
  const Phase what{"developed", 30, 0};
  const int n = static_cast<int>(state.range(0)), steps = 100;
  const auto one = simulation(what, n, 1), two = simulation(what, n, 2);
  std::atomic<bool> done{false};
  std::thread busy([&] {
    cpu_set_t core;
    CPU_ZERO(&core);
    CPU_SET(omp_get_num_procs() - 1, &core);
    pthread_setaffinity_np(pthread_self(), sizeof core, &core);
    while (!done) {
    }
  });
  double seconds[2] = {0, 0}, later[2] = {0, 0};
  for (auto _ : state) {
    for (int k = 0; k < steps; ++k)
      for (int t : {0, 1}) {
        const double wall = timed([&] { (t == 0 ? one : two)->step(); }).wall;
        seconds[t] += wall;
        if (k >= steps / 2) later[t] += wall;
      }
    state.SetIterationTime(seconds[1] / steps);
  }
  done = true;
  busy.join();
  if (!same(one->fields(), two->fields())) return perf::wrong(state, "two threads differ from one");
  state.counters["of_one_thread"] = seconds[1] / seconds[0];
  state.counters["later"] = later[1] / later[0];
}

}  // namespace

int main(int argc, char** argv) {
  perf::start(argc, argv, {"most", "steps"});
  const int most = std::stoi(perf::flag("most", "1024"));
  const auto add = [](const std::string& name, auto body) {
    return benchmark::RegisterBenchmark(("step/" + name).c_str(), body)
        ->Iterations(1)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  static const Phase phases[] = {{"developed", 30, 40}, {"start", 0, 50}, {"empty", 30, 40}};
  for (const Phase& s : phases)
    for (int n = 128; n <= most; n *= 2)
      add(s.name, [&s](benchmark::State& state) { step(state, s); })->Arg(n);
  add("exponent", exponent);
  add("neighbour", neighbour)->Arg(256);
  return perf::finish();
}
