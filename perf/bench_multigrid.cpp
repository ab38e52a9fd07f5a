// The preconditioner and the solves: legs of a cycle, a whole V-cycle, the coefficients of the coarse levels,
// a solve. The plain twin of a cycle sweeps level by level, pass by pass (perf/plain.hpp).
#include <memory>

#include "perf/harness.hpp"
#include "perf/plain_cycle.hpp"
#include "solver/boundary_of.hpp"
#include "solver/projection.hpp"
#include "solver/viscous_solve.hpp"
#include "tests/support/make_operator.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
using perf::Case;
using perf::PlainCycle;

namespace {

using V = ViscousLevel<float>;
using P = PoissonLevel<float>;

/// Bytes a cell of the finest level; of a solve, an iteration and what comes once. README.md says how they
/// come about.
template <class Level>
struct Bytes;
template <>
struct Bytes<V> {
  static constexpr double descend = 48, ascend = 50, cycle = 144, coarsen = 35, held = 48, iteration = 296,
                          once = 56;
};
template <>
struct Bytes<P> {
  static constexpr double descend = 24, ascend = 28, cycle = 76, coarsen = 17, held = 24, iteration = 148,
                          once = 168;
};

constexpr double float_rounding = 1e-3;  // of a cycle at contrast 1e3

template <class Level>
void random_coefficients(Level& level) {
  Noise noise;
  if constexpr (std::is_same_v<Level, V>) {
    level.a = random_viscous<float>(level.x.patch(), level.boundary(), noise, 1e3);
  } else {
    level.a = random_poisson<float>(level.x.patch(), level.boundary(), noise, 1e3);
  }
  fill_random(level.b, noise);
  for (int k = 0; k < row_count(level.b); ++k) level.mask(level.b, k);
}

template <class Level>
struct Twins {
  Multigrid<Level> fast;
  PlainCycle<Level> plain;
  explicit Twins(const Scene& scene)
      : fast(scene.patch(), boundary_of(scene), perf::finest_sweeps<Level>),
        plain(scene.patch(), boundary_of(scene)) {
    random_coefficients(fast.finest());
    plain.finest().a = fast.finest().a;
    plain.finest().b = fast.finest().b;
    plain.coarsen();
    Team alone;
    fast.coarsen(alone);
  }
};

/// How far the corrections of both twins lie apart after a run of each.
template <class Level>
double difference(const Case& c, Twins<Level>& s) {
  Team alone;
  c.fast(alone);
  c.plain();
  return perf::relative_difference(s.fast.finest().x, s.plain.finest().x);
}

template <class Level>
Case cycle(int n) {
  const auto s = std::make_shared<Twins<Level>>(silo(n));
  Case c{Bytes<Level>::cycle,
         Bytes<Level>::held * 4 / 3,
         [s](Team& team) { s->fast.cycle(team); },
         [s] { s->plain.cycle(); },
         {},
         float_rounding};
  c.difference = [s, c] { return difference(c, *s); };
  return c;
}

/// One leg on the finest level; both twins start from x = 0 or from what a descent has left.
template <class Level>
Case leg(int n, bool down) {
  const auto s = std::make_shared<Twins<Level>>(silo(n));
  Case c{down ? Bytes<Level>::descend : Bytes<Level>::ascend, Bytes<Level>::held, {}, {}, {}, float_rounding};
  if (down) {
    c.fast = [s](Team& team) { s->fast.finest().descend(team, perf::finest_sweeps<Level>); };
    c.plain = [s] { s->plain.descend(0); };
  } else {
    c.fast = [s](Team& team) {
      s->fast.finest().ascend(team, s->plain.level(1), perf::finest_sweeps<Level>);
    };
    c.plain = [s] { s->plain.ascend(0); };
  }
  c.difference = [s, c] {
    Noise noise;
    Level& coarse = s->plain.level(1);
    fill_random(coarse.x, noise);
    for (int k = 0; k < row_count(coarse.x); ++k) coarse.mask(coarse.x, k);
    for (Level* level : {&s->fast.finest(), &s->plain.finest()}) level->x.fill(0);
    return difference(c, *s);
  };
  return c;
}

template <class Level>
Case coarsen(int n) {
  const auto s = std::make_shared<Twins<Level>>(silo(n));
  // No twin: once a step, and what it does is tested by tests/unit.
  return {Bytes<Level>::coarsen,
          Bytes<Level>::held,
          [s](Team& team) { s->fast.coarsen(team); },
          {},
          [] { return 0.0; },
          0};
}

/// Noise in the silo: one solve from zero to the tolerances of a step. Half of the grains
/// are at rest, eta_max, half flow.
template <class Solver>
struct Solve {
  Scene scene;
  Boundary boundary = boundary_of(scene);
  Solver solver{scene.patch(), boundary};
  CellField eta{scene.patch()}, density{scene.patch()}, p{scene.patch()};
  Velocity noise{scene.patch()}, w{scene.patch()}, x{scene.patch()};
  SolveStats stats;
  static constexpr bool viscous = std::is_same_v<Solver, ViscousSolve<float>>;

  explicit Solve(int n) : scene(silo(n)) {
    const Patch patch = scene.patch();
    for (int j = -halo; j < n + halo; ++j)
      for (int i = -halo; i < n + halo; ++i) {
        const double beside = std::abs(patch.x_centre(i) - 75), y = patch.y_centre(j);
        eta(i, j) = y > 135 ? scene.air.viscosity : beside < 10 + y / 2 ? 100 : scene.rheology.eta_max;
        density(i, j) = y > 135 ? scene.air.density : 1;
      }
    Noise random;
    fill_random(noise, random);
    Team alone;
    if constexpr (viscous) {
      solver.assemble(alone, eta, true, density, scene.time.dt_max);
    } else {
      solver.assemble(alone, density);
      solver.add_gravity_and_pressure(alone, p, {0, 0}, 0, noise);  // zero on walls
    }
    run(alone);
  }
  void run(Team& team) {
    const Rows rows = team.rows(row_count(w));
    for (int k = rows.begin; k < rows.end; ++k) {
      const auto from = row_of(noise, k);
      std::copy(from.data, from.data + from.n, row_of(w, k).data);
      std::fill(row_of(x, k).data, row_of(x, k).data + from.n, 0.0);
    }
    if constexpr (!viscous) {
      if (team.leads()) solver.forget();  // or the answer of the last run would be the guess of this one
    }
    team.sync();
    const SolveStats s = [&] {
      if constexpr (viscous) {
        return solver.solve(team, w, x, scene.accuracy.viscous_tolerance, 0, 100);
      } else {
        return solver.solve(team, scene.time.dt_max, scene.accuracy.pressure_tolerance, 100, w, p);
      }
    }();
    if (team.leads()) stats = s;
  }
};

template <class Solver>
Case solve(int n) {
  using Level = std::conditional_t<Solve<Solver>::viscous, V, P>;
  const auto s = std::make_shared<Solve<Solver>>(n);
  const int iterations = s->stats.iterations;
  return {Bytes<Level>::once + Bytes<Level>::iteration * iterations,
          Bytes<Level>::held * 4 / 3 + 48,
          [s](Team& team) { s->run(team); },
          {},
          [s] { return s->stats.converged ? 0.0 : 1.0; },
          0,
          static_cast<double>(iterations)};
}

}  // namespace

int main(int argc, char** argv) {
  perf::start(argc, argv);
  const std::vector<int> sizes{128, 256, 512, 1024};
  perf::add("viscous_descend", sizes, [](int n) { return leg<V>(n, true); });
  perf::add("viscous_ascend", sizes, [](int n) { return leg<V>(n, false); });
  perf::add("viscous_cycle", sizes, cycle<V>);
  perf::add("viscous_coarsen", sizes, coarsen<V>);
  perf::add("viscous_solve", sizes, solve<ViscousSolve<float>>);
  perf::add("poisson_descend", sizes, [](int n) { return leg<P>(n, true); });
  perf::add("poisson_ascend", sizes, [](int n) { return leg<P>(n, false); });
  perf::add("poisson_cycle", sizes, cycle<P>);
  perf::add("poisson_coarsen", sizes, coarsen<P>);
  perf::add("poisson_solve", sizes, solve<Projection<float>>);
  return perf::finish();
}
