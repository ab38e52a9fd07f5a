#pragma once
// Multigrid over any operator. A Level offers: Unknown, Number; fields x (correction), b (right-hand side), r
// (residual); descend(team, sweeps): x = 0, smooth, residual; ascend(team, coarse, sweeps): add the
// correction, smooth in reversed order; restrict_from(team, fine residual); coarsen(team, fine level);
// apply_row, wrap and fixed for the coarsest solve. It knows its stencil; this file does not.
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <limits>
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// L D L^T of a small symmetric positive definite matrix. Allocates when resized only. (Eigen's dense one is as good, but
/// GCC 12 warns of uninitialised values in what it becomes with AVX-512.)
class DenseLdlt {
 public:
  void resize(int n) {
    n_ = n;
    values_.resize(static_cast<std::size_t>(n) * n);
  }
  void set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }
  /// Before factor(): the matrix, of which the lower half is read. After: D on the diagonal, L^T above it.
  double& operator()(int row, int column) { return values_[static_cast<std::size_t>(row) * n_ + column]; }
  void factor() {
    auto& m = *this;
    for (int k = 0; k < n_; ++k)
      for (int r = k + 1; r < n_; ++r) {
        const double factor = m(r, k) / m(k, k);
        for (int c = k + 1; factor != 0 && c <= r; ++c) m(r, c) -= factor * m(c, k);
        m(k, r) = factor;  // not in place of m(r, k), which rows below still read
      }
  }
  void solve_in_place(Eigen::VectorXd& x) {
    auto& m = *this;
    for (int r = 0; r < n_; ++r)
      for (int c = 0; c < r; ++c) x[r] -= m(c, r) * x[c];
    for (int r = 0; r < n_; ++r) x[r] /= m(r, r);
    for (int r = n_ - 1; r >= 0; --r)
      for (int c = r + 1; c < n_; ++c) x[r] -= m(r, c) * x[c];
  }

 private:
  int n_ = 0;
  std::vector<double> values_;
};

/// Direct solve on the coarsest level. The matrix is read off the operator by unit vectors. Up to `most_dense` unknowns,
/// as on every grid that halves well, it is dense and allocates nothing after the first time.
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
      rhs_.resize(n);
      if (n <= most_dense) dense_.resize(n);
    }
    const int n = offsets_.back();
    const bool dense = n <= most_dense;
    std::vector<Eigen::Triplet<double>> entries;
    if (dense) dense_.set_zero();
    T* out = row_scratch<T>(x.patch().nx + 1);
    double largest = 0;
    // A whisker on the diagonal makes the closed box solvable; it must outweigh the rounding of T, which leaves
    // constants an eigenvalue of either sign.
    const double whisker = std::max(1e-9, 64.0 * std::numeric_limits<T>::epsilon());
    x.fill(T(0));
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < row_of(x, k).n; ++i) {
        const int column = offsets_[k] + i;
        const auto enter = [&](int row, double value) {
          if (row == column) {
            value *= 1 + whisker;
            largest = std::max(largest, value);
          }
          if (dense) {
            dense_(row, column) = value;
          } else {
            entries.emplace_back(row, column, value);
          }
        };
        if (level.fixed(k, i)) {  // a wall's own column would make the matrix unsymmetric, the solve wrong
          enter(column, 1);
          continue;
        }
        row_of(x, k).data[i] = T(1);
        level.wrap(x, k);
        for (int m = std::max(0, k - 3); m <= std::min(rows - 1, k + 3); ++m) {
          level.apply_row(x, m, out);
          for (int c = 0; c < row_of(x, m).n; ++c)
            if (out[c] != T(0) || offsets_[m] + c == column) enter(offsets_[m] + c, out[c]);
        }
        row_of(x, k).data[i] = T(0);
        level.wrap(x, k);
      }
    if (dense) {
      for (int i = 0; i < n; ++i) pad(dense_(i, i), largest);
      dense_.factor();
    } else {
      Eigen::SparseMatrix<double> matrix(n, n);
      matrix.setFromTriplets(entries.begin(), entries.end());
      for (int i = 0; i < n; ++i) pad(matrix.coeffRef(i, i), largest);
      sparse_.compute(matrix);
    }
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
    if (rhs_.size() <= most_dense) {
      dense_.solve_in_place(rhs_);
    } else {
      rhs_ = sparse_.solve(rhs_);
    }
    for (int k = 0; k < rows; ++k) {
      const auto row = row_of(x, k);
      for (int i = 0; i < row.n; ++i)
        row.data[i] = static_cast<typename Level::Number>(rhs_[offsets_[k] + i]);
      level.wrap(x, k);
    }
  }

 private:
  static constexpr int most_dense = 128;
  /// A point that nothing holds, an air pocket between walls, gets 1.
  static void pad(double& diagonal, double largest) {
    diagonal = diagonal > 0 ? diagonal + 1e-30 * largest : 1;
  }

  std::vector<int> offsets_;
  Eigen::VectorXd rhs_;
  DenseLdlt dense_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> sparse_;
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

  template <class Change>
  void each_level(Change&& change) {
    for (Level& level : levels_) change(level);
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
  static constexpr long cells_for_one_member = 32 * 32;

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
