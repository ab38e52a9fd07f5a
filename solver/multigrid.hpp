#pragma once
// Multigrid over any operator. A Level offers: Unknown, Number; fields x (correction), b (right-hand side), r
// (residual); descend(team, sweeps): x = 0, smooth, residual; ascend(team, coarse, sweeps): add the
// correction, smooth in reversed order; restrict_from(team, fine residual); coarsen(team, fine level);
// apply_row, wrap and fixed for the coarsest solve. It knows its stencil; this file does not.
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <limits>
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Direct solve on the coarsest level. The matrix is read off the operator by unit vectors; the sparsity is
/// found anew only when the operator's pattern may have changed, that is never.
template <class Level>
class CoarsestSolve {
 public:
  void factor(Level& level) {
    using T = typename Level::Number;
    auto& x = level.x;
    const int rows = row_count(x);
    if (offsets_.empty()) {
      int n = 0;
      for (int k = 0; k < rows; ++k) {
        offsets_.push_back(n);
        n += row_of(x, k).n;
      }
      offsets_.push_back(n);
    }
    const int n = offsets_.back();
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<T> out(x.patch().nx + 1);
    double largest = 0;
    x.fill(T(0));
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < row_of(x, k).n; ++i) {
        if (level.fixed(k, i))
          continue;  // a wall's column would make the matrix unsymmetric, the solve wrong
        row_of(x, k).data[i] = T(1);
        level.wrap(x, k);
        const int column = offsets_[k] + i;
        for (int m = std::max(0, k - 3); m <= std::min(rows - 1, k + 3); ++m) {
          level.apply_row(x, m, out.data());
          for (int c = 0; c < row_of(x, m).n; ++c)
            if (out[c] != T(0)) entries.emplace_back(offsets_[m] + c, column, out[c]);
        }
        row_of(x, k).data[i] = T(0);
        level.wrap(x, k);
      }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    for (int i = 0; i < n; ++i) largest = std::max(largest, matrix.coeff(i, i));
    // Fixed points get 1. A whisker on the diagonal makes the closed box solvable; it must outweigh the rounding of
    // T, which leaves constants an eigenvalue of either sign.
    const double whisker = std::max(1e-9, 64.0 * std::numeric_limits<T>::epsilon());
    for (int i = 0; i < n; ++i) {
      const double d = matrix.coeff(i, i);
      matrix.coeffRef(i, i) = d > 0 ? d * (1 + whisker) + 1e-30 * largest : 1;
    }
    matrix.makeCompressed();
    solver_.compute(matrix);
    rhs_.resize(n);
  }

  void solve(Level& level) {
    auto& x = level.x;
    const auto& b = level.b;
    const int rows = row_count(x);
    for (int k = 0; k < rows; ++k) {
      const auto row = row_of(b, k);
      for (int i = 0; i < row.n; ++i) rhs_[offsets_[k] + i] = level.fixed(k, i) ? 0 : row.data[i];
    }
    // What rounding left of a source in a closed box would come back divided by the whisker.
    if (level.singular()) {
      double sum = 0;
      for (double source : rhs_) sum += source;
      for (double& source : rhs_) source -= sum / static_cast<double>(rhs_.size());
    }
    rhs_ = solver_.solve(rhs_);
    for (int k = 0; k < rows; ++k) {
      const auto row = row_of(x, k);
      for (int i = 0; i < row.n; ++i)
        row.data[i] = static_cast<typename Level::Number>(rhs_[offsets_[k] + i]);
      level.wrap(x, k);
    }
  }

 private:
  std::vector<int> offsets_;
  Eigen::VectorXd rhs_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

template <class Level>
class Multigrid {
 public:
  /// Halves the patch as long as both extents stay even and at least 2, down to about 16 cells. `finest_sweeps` sweeps
  /// before and after the correction on the finest level, one more on each coarser one (variable V-cycle, Bramble &
  /// Pasciak 1987): coarse sweeps are cheap, and they are what makes the count independent of the grid.
  Multigrid(const Patch& patch, const Boundary& boundary, int finest_sweeps) : finest_sweeps_(finest_sweeps) {
    Patch p = patch;
    Boundary b = boundary;
    levels_.emplace_back(p, b, true);
    while (p.nx % 2 == 0 && p.ny % 2 == 0 && p.nx >= 4 && p.ny >= 4 && p.cells() > 16) {
      p = p.coarser();
      b = b.coarser();
      levels_.emplace_back(p, b, false);
    }
  }

  Level& finest() { return levels_.front(); }
  const Level& finest() const { return levels_.front(); }
  int depth() const { return static_cast<int>(levels_.size()); }

  /// Builds the coarse levels from the finest one's coefficients. Call from every member; synced on return.
  void coarsen(Team& team) { coarsen_below(team, 0); }

  /// finest().x = M finest().b, one V-cycle from zero. Call from every member; synced on return.
  void cycle(Team& team) { cycle(team, 0); }

  std::size_t bytes() const {
    std::size_t total = 0;
    for (const Level& l : levels_) total += l.bytes();
    return total;
  }

 private:
  /// Below this a barrier costs more than the work that it shares out.
  static constexpr long cells_for_one_member = 64 * 64;

  bool serial(const Team& team, int l) const {
    return team.size() > 1 && l > 0 && levels_[l].x.patch().cells() <= cells_for_one_member;
  }

  void coarsen_below(Team& team, int l) {
    if (l + 1 == depth()) {
      if (team.leads()) coarsest_.factor(levels_[l]);
      team.sync();
      return;
    }
    if (serial(team, l + 1)) {
      if (team.leads()) {
        Team alone;
        descend(alone, l);
      }
      team.sync();
      return;
    }
    descend(team, l);
  }
  void descend(Team& team, int l) {
    levels_[l + 1].coarsen(team, levels_[l]);
    coarsen_below(team, l + 1);
  }

  int sweeps(int l) const { return finest_sweeps_ + l; }

  void cycle(Team& team, int l) {
    if (serial(team, l)) {
      if (team.leads()) {
        Team alone;
        cycle(alone, l);
      }
      team.sync();
      return;
    }
    Level& level = levels_[l];
    if (l + 1 == depth()) {
      if (team.leads()) coarsest_.solve(level);
      team.sync();
      return;
    }
    level.descend(team, sweeps(l));
    levels_[l + 1].restrict_from(team, level.r);
    cycle(team, l + 1);
    level.ascend(team, levels_[l + 1], sweeps(l));
  }

  std::vector<Level> levels_;
  CoarsestSolve<Level> coarsest_;
  int finest_sweeps_;
};

}  // namespace hourglass
