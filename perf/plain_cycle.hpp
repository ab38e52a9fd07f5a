#pragma once
// The plain twin of Multigrid::cycle: the same levels and coarsest solve, every pass over a level by itself.
#include "perf/plain.hpp"
#include "solver/levels.hpp"
#include "solver/multigrid.hpp"

namespace hourglass::perf {

/// As ViscousSolve and Projection have them.
template <class Level>
inline constexpr int finest_sweeps = std::is_same_v<Level, ViscousLevel<float>> ? 1 : 2;

template <class Level>
class PlainCycle {
 public:
  PlainCycle(Patch p, Boundary b) {
    levels_.emplace_back(p, b, true);
    while (p.nx % 2 == 0 && p.ny % 2 == 0 && p.nx >= 4 && p.ny >= 4 && p.cells() > 16) {
      p = p.coarser();
      b = b.coarser();
      levels_.emplace_back(p, b, false);
    }
  }
  Level& level(std::size_t l) { return levels_[l]; }
  Level& finest() { return levels_.front(); }

  void coarsen() {
    Team alone;
    for (std::size_t l = 1; l < levels_.size(); ++l) levels_[l].coarsen(alone, levels_[l - 1]);
    coarsest_.factor(levels_.back());
  }
  void cycle(std::size_t l = 0) {
    if (l + 1 == levels_.size()) return coarsest_.solve(levels_[l]);
    descend(l);
    restrict(levels_[l], levels_[l + 1]);
    cycle(l + 1);
    ascend(l);
  }
  void descend(std::size_t l) {
    Level& level = levels_[l];
    level.x.fill(0);
    for (int s = 0; s < sweeps(l); ++s) plain::relax(level.a, level.x, level.b, false);
    plain::residual(level.a, level.x, level.b, level.r);
  }
  void ascend(std::size_t l) {
    Level& level = levels_[l];
    prolong(levels_[l + 1], level);
    for (int s = 0; s < sweeps(l); ++s) plain::relax(level.a, level.x, level.b, true);
  }

 private:
  static int sweeps(std::size_t l) { return finest_sweeps<Level> + static_cast<int>(l); }
  using Viscous = ViscousLevel<float>;
  using Poisson = PoissonLevel<float>;
  static void restrict(const Viscous& fine, Viscous& coarse) {
    plain::restrict(fine.r, coarse.boundary(), coarse.b);
  }
  static void restrict(const Poisson& fine, Poisson& coarse) { plain::restrict(fine.r, coarse.b); }
  static void prolong(const Viscous& coarse, Viscous& fine) {
    plain::prolong(coarse.x, coarse.boundary(), fine.a.inverse_diagonal, fine.x);
  }
  static void prolong(const Poisson& coarse, Poisson& fine) { plain::prolong(coarse.a, coarse.x, fine.x); }

  std::vector<Level> levels_;
  CoarsestSolve<Level> coarsest_;
};

}  // namespace hourglass::perf
