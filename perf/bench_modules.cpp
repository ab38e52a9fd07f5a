// What the modules of `physics:` cost a step that names them, and a step that does not.
//
//   bench_modules [--grids=256,1024] [--steps=40] [--picture=docs/physics_price.png] [--prices=no]
//
// Prices: the developed base silo with one module and without any, step by step in turns on one thread, by the clock of
// that thread; medians. Then the engine as it is against one that was compiled without modules (kernels/modules.hpp), the
// plain silo in turns: the same fields to the last bit, and the ratio of their times.
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <string>

#include "perf/developed.hpp"
#include "perf/harness.hpp"
#include "perf/modules_chart.hpp"
#include "perf/twin_steps.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

struct Choice {
  const char* name;
  std::function<void(Scene&)> make;
};

Scene with_second_material(Scene s, double mu_s) {
  Material second = s.materials[0];
  second.name = "second";
  second.mu_s = mu_s;
  s.materials.push_back(second);
  s.fill.push_back(fill_box(1, 0, s.width, 0, 75));
  return s;
}

const std::vector<Choice> choices{
    {"nonlocal, thesis", [](Scene& s) { s.nonlocal = Nonlocal{}; }},
    {"nonlocal, kamrin", [](Scene& s) { s.nonlocal = Nonlocal{.closure = Closure::kamrin}; }},
    {"dilatancy, source", [](Scene& s) { s.dilatancy = Dilatancy{}; }},
    {"dilatancy, relax", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::relax}; }},
    {"dilatancy, weight", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::weight}; }},
    {"wall friction", [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167}; }},
    {"wall friction, limiter",
     [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167, .mode = FrictionMode::limiter}; }},
    {"inert tracer", [](Scene& s) { s = with_second_material(s, s.materials[0].mu_s); }},
    {"second material", [](Scene& s) { s = with_second_material(s, 0.47); }},
    {"cohesion", [](Scene& s) { s.materials[0].cohesion = 0.1; }},
    {"smooth cap", [](Scene& s) { s.rheology.cap = Cap::smooth; }},
    {"two rounds a step", [](Scene& s) { s.accuracy.splitting.outer = 2; }},
    {"two viscosities a step", [](Scene& s) { s.accuracy.splitting.picard = 2; }},
    {"all three modules",
     [](Scene& s) {
       s.nonlocal = Nonlocal{};
       s.dilatancy = Dilatancy{};
       s.wall_friction = WallFriction{.F = 0.0167};
     }},
};

double bytes_a_cell(const Simulation& s) {
  double sum = 0;
  for (const auto& [name, bytes] : s.memory()) sum += static_cast<double>(bytes);
  return sum / static_cast<double>(s.fields().patch().cells());
}

/// Of a Simulation or a twin.
template <class Steps>
double seconds_of_step(Steps& s) {
  const double before = perf::thread_seconds();
  s.step();
  return perf::thread_seconds() - before;
}

/// Per cent of time that a choice adds to a step, and bytes a cell.
std::pair<double, double> price(const Choice& choice, int n, int steps) {
  Scene scene = silo(n);
  Simulation plain(scene);
  choice.make(scene);
  Simulation priced(scene);
  perf::start_developed(plain);
  perf::start_developed(priced);
  for (std::size_t k = 0; k < priced.fields().tracers.size(); ++k) {  // below half of the height
    CellField& tracer = priced.fields().tracers[k];
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) tracer(i, j) = j < n / 2 ? priced.fields().grains(i, j) : 0;
  }
  for (int k = 0; k < 20; ++k) {
    plain.step();
    priced.step();
  }
  std::vector<double> without, with;
  for (int k = 0; k < steps; ++k) {
    without.push_back(seconds_of_step(plain));
    with.push_back(seconds_of_step(priced));
  }
  return {100 * (perf::median(with) / perf::median(without) - 1), bytes_a_cell(priced) - bytes_a_cell(plain)};
}

/// Times of the engine as it is over those of one without modules: median over rounds, each with silos of its own, for
/// where arrays come to lie makes a step faster or slower by a per cent or two.
double price_of_generality(int n, int steps) {
  std::vector<double> rounds;
  for (int round = 0; round < 8; ++round) {
    auto full = round % 2 == 0 ? twins::full(n) : nullptr;
    const auto bare = twins::bare(n);
    if (!full) full = twins::full(n);
    std::vector<double> a, b;
    for (int k = 0; k < 20 + steps; ++k) {
      // Who goes first changes, for the second finds a warmer core.
      const bool first = k % 2 == 0;
      const double x = seconds_of_step(first ? *full : *bare), y = seconds_of_step(first ? *bare : *full);
      if (k < 20) continue;
      a.push_back(first ? x : y);
      b.push_back(first ? y : x);
    }
    const double p = full->fingerprint(), q = bare->fingerprint();
    if (std::memcmp(&p, &q, sizeof p) != 0) {
      fmt::print(stderr, "the engine without modules differs\n");
      std::exit(1);
    }
    rounds.push_back(perf::median_ratio(a, b));
  }
  return perf::median(rounds);
}

}  // namespace

int main(int argc, char** argv) {
  perf::start(argc, argv, {"grids", "steps", "picture", "prices"});
  const int steps = std::stoi(perf::flag("steps", "40"));
  std::vector<int> grids;
  const std::string list = perf::flag("grids", "256,1024");
  for (std::size_t at = 0; at < list.size();
       at = list.find(',', at) == std::string::npos ? list.size() : list.find(',', at) + 1)
    grids.push_back(std::stoi(list.substr(at)));

  std::vector<perf::ModulePrice> prices;
  fmt::print("| | more B/cell |");
  for (int n : grids) fmt::print(" {}² |", n);
  fmt::print("\n|---|---|");
  for (std::size_t k = 0; k < grids.size(); ++k) fmt::print("---|");
  fmt::print("\n");
  const bool free_only = perf::flag("prices", "yes") == "no";
  for (const Choice& choice : free_only ? std::vector<Choice>{} : choices) {
    perf::ModulePrice p{choice.name, 0, {}};
    for (int n : grids) {
      const auto [percent, bytes] = price(choice, n, std::max(3, steps * 256 / std::max(n, 256)));
      p.bytes = bytes;
      p.percent.push_back(percent);
    }
    fmt::print("| {} | {:.0f} |", p.name, p.bytes);
    for (double percent : p.percent) fmt::print(" {:+.0f} % |", percent);
    fmt::print("\n");
    std::fflush(stdout);
    prices.push_back(p);
  }
  for (int n : grids) {
    if (n > 512) continue;
    const double ratio = price_of_generality(n, 2 * steps);
    fmt::print(
        "{}², no module named: {:+.2f} % over an engine without modules, fields equal to the last bit\n", n,
        100 * (ratio - 1));
  }
  const std::string picture = perf::flag("picture");
  if (!picture.empty()) perf::draw_prices(prices, grids, picture);
}
