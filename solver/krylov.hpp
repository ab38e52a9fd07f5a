#pragma once
// Conjugate gradients in double around one V-cycle: unknown and true residual are double; directions and the
// recursive residual have the preconditioner's precision (docs/accuracy.md, Tolerances: all in double takes
// as many iterations), sums are double. Flexible (Polak-Ribiere, Notay 2000) throughout, because a float
// V-cycle is never exactly symmetric:
//
//   z = M r,  beta = -(z, q)/(p, q),  p <- z + beta p,  q = A p,  alpha = (z, r)/(p, q),  x += alpha p,  r -= alpha q.
#include <cmath>

#include "kernels/norms.hpp"
#include "kernels/team.hpp"
#include "solver/multigrid.hpp"
#include "solver/solve_stats.hpp"

namespace hourglass {

enum class Measure {
  energy,   ///< sqrt(r . M r), about the energy norm of the error
  maximum,  ///< max |r|
  relative  ///< max |M r| / max(|x|, least), about the relative error everywhere
};

struct StopRule {
  Measure measure = Measure::energy;
  double tolerance = 0;  ///< in the measure's own unit
  int max_iterations = 200;
};

template <class Level>
class Krylov {
 public:
  using T = typename Level::Number;
  using Unknown = typename Level::Unknown;
  using Wide = rebind_t<Unknown, double>;

  explicit Krylov(const Patch& patch)
      : p_(patch), q_(patch), sums_{RowSums(row_count(p_)), RowSums(row_count(p_)), RowSums(row_count(p_)),
                                    RowSums(row_count(p_)), RowSums(row_count(p_))} {}

  /// Solves A x = b to the rule from the guess in x. Coarse levels must be up to date. x: halo 0 or wrapped,
  /// 0 on fixed points; b is read on unknown points only. Call from every member: each returns the same
  /// statistics.
  /// `least` is read by Measure::relative only.
  SolveStats solve(Team& team, Multigrid<Level>& multigrid, const Wide& b, Wide& x, const StopRule& rule,
                   const Wide* least = nullptr) {
    Level& level = multigrid.finest();
    SolveStats stats;
    stats.tolerance = rule.tolerance;
    for (int start = 0;; ++start) {
      const double largest = true_residual(team, level, b, x);
      if (rule.measure == Measure::maximum) {
        if (start == 0) stats.initial = largest;
        stats.final = largest;
        if (largest <= rule.tolerance) break;
      } else if (largest == 0) {
        break;
      }
      if (!std::isfinite(largest) || stats.iterations >= rule.max_iterations || start > 8) {
        stats.converged = false;
        break;
      }
      if (descend(team, multigrid, x, rule, least, largest, start == 0, stats)) break;
    }
    if (!stats.converged) locate_worst(team, level, stats);
    return stats;
  }

  std::size_t bytes() const { return p_.bytes() + q_.bytes() + 5 * sums_[0].bytes(); }

 private:
  /// The smallest reduction that the recursive residual is trusted with before the true one is taken again.
  static constexpr double trust = sizeof(T) == 4 ? 1e-4 : 1e-10;

  /// level.b = b - A x, in double before the cast; returns max |b - A x|.
  double true_residual(Team& team, Level& level, const Wide& b, const Wide& x) {
    double* __restrict scratch = row_scratch<double>(x.patch().nx + 1);
    const Rows rows = team.rows(row_count(p_));
    for (int k = rows.begin; k < rows.end; ++k) {
      level.apply_row(x, k, scratch);
      const double* __restrict rhs = row_of(b, k).data;
      auto r = row_of(level.b, k);
      for (int i = 0; i < r.n; ++i) r.data[i] = static_cast<T>(rhs[i] - scratch[i]);
      level.mask(level.b, k);
      sums_[4][k] = max_magnitude(r.data, r.n);
    }
    team.sync();
    const double largest = sums_[4].max();
    team.sync();
    return largest;
  }

  /// Iterates until the rule holds, or until the recursive residual has dropped as far as it is trusted.
  /// Returns true when nothing is left to do.
  bool descend(Team& team, Multigrid<Level>& multigrid, Wide& x, const StopRule& rule, const Wide* least,
               double largest, bool first, SolveStats& stats) {
    Level& level = multigrid.finest();
    const Rows rows = team.rows(row_count(p_));
    double pq = 0, rz_start = 0;
    for (int it = 0; stats.iterations < rule.max_iterations; ++it) {
      multigrid.cycle(team);
      ++stats.iterations;
      for (int k = rows.begin; k < rows.end; ++k) {
        sums_[0][k] = dot(row_of(level.x, k), row_of(level.b, k));
        sums_[1][k] = it > 0 ? dot(row_of(level.x, k), row_of(q_, k)) : 0;
        if (rule.measure == Measure::relative)
          sums_[4][k] = largest_share(row_of(level.x, k), row_of(x, k).data, row_of(*least, k).data);
      }
      team.sync();
      const double rz = sums_[0].sum();
      const double beta = it > 0 ? -sums_[1].sum() / pq : 0;
      if (!std::isfinite(rz) || !std::isfinite(beta)) {
        stats.converged = false;
        return true;
      }
      if (rule.measure != Measure::maximum) {
        const double error = rule.measure == Measure::relative ? sums_[4].max() : std::sqrt(std::abs(rz));
        if (it == 0) rz_start = rz;
        if (first && it == 0) stats.initial = error;
        stats.final = error;
        if (error <= rule.tolerance) {
          // z is at hand: one more correction for nothing.
          add(team, level, 1, level.x, x);
          return true;
        }
        if (std::abs(rz) < trust * trust * std::abs(rz_start)) {
          add(team, level, 1, level.x, x);
          return false;
        }
      }
      for (int k = rows.begin; k < rows.end; ++k) {
        const auto z = row_of(level.x, k);
        T* __restrict p = row_of(p_, k).data;
        const T s = static_cast<T>(beta);
        if (it == 0) {
          std::copy(z.data, z.data + z.n, p);
        } else {
#pragma omp simd
          for (int i = 0; i < z.n; ++i) p[i] = z.data[i] + s * p[i];
        }
        level.wrap(p_, k);
      }
      team.sync();
      for (int k = rows.begin; k < rows.end; ++k) {
        auto q = row_of(q_, k);
        level.apply_row(p_, k, q.data);
        sums_[2][k] = dot(row_of(p_, k), row_of(q_, k));
      }
      team.sync();
      pq = sums_[2].sum();
      if (!(pq > 0)) {  // p is in the null space, or something is not a number
        stats.converged = std::isfinite(pq) && largest <= 10 * rule.tolerance;
        return true;
      }
      const double alpha = rz / pq;
      for (int k = rows.begin; k < rows.end; ++k) {
        const auto q = row_of(q_, k);
        T* __restrict r = row_of(level.b, k).data;
        const T s = static_cast<T>(alpha);
#pragma omp simd
        for (int i = 0; i < q.n; ++i) r[i] -= s * q.data[i];
        if (rule.measure == Measure::maximum) sums_[3][k] = max_magnitude(r, q.n);
      }
      add(team, level, alpha, p_, x);
      if (rule.measure == Measure::maximum) {
        const double now = sums_[3].max();
        // A little below the tolerance, so that the true residual passes too.
        if (now <= 0.8 * rule.tolerance || now <= trust * largest) return false;
      }
    }
    stats.converged = false;
    return true;
  }

  /// x += s d, synced.
  void add(Team& team, const Level& level, double s, const Unknown& d, Wide& x) {
    const Rows rows = team.rows(row_count(p_));
    for (int k = rows.begin; k < rows.end; ++k) {
      const auto from = row_of(d, k);
      double* __restrict to = row_of(x, k).data;
#pragma omp simd
      for (int i = 0; i < from.n; ++i) to[i] += s * static_cast<double>(from.data[i]);
      level.wrap(x, k);
    }
    team.sync();
  }

  static double largest_share(Row<T> z, const double* __restrict x, const double* __restrict least) {
    double m = 0;
#pragma omp simd reduction(max : m)
    for (int i = 0; i < z.n; ++i) {
      const double share = std::abs(static_cast<double>(z.data[i])) / std::max(std::abs(x[i]), least[i]);
      m = share > m ? share : m;
    }
    return m;
  }
  static double dot(Row<const T> a, Row<const T> b) {
    double s = 0;
#pragma omp simd reduction(+ : s)
    for (int i = 0; i < a.n; ++i) s += static_cast<double>(a.data[i]) * static_cast<double>(b.data[i]);
    return s;
  }
  static double dot(Row<T> a, Row<T> b) { return dot(Row<const T>{a.data, a.n}, Row<const T>{b.data, b.n}); }
  static double dot(Row<T> a, Row<const T> b) { return dot(Row<const T>{a.data, a.n}, b); }

  void locate_worst(Team& team, const Level& level, SolveStats& stats) const {
    team.sync();
    double worst = -1;
    for (int k = 0; k < row_count(level.b); ++k) {
      const auto row = row_of(level.b, k);
      for (int i = 0; i < row.n; ++i)
        if (std::abs(row.data[i]) > worst || std::isnan(row.data[i])) {
          worst = std::abs(static_cast<double>(row.data[i]));
          stats.worst_i = i;
          stats.worst_j = row_count(level.b) > level.b.patch().ny ? k / 2 : k;
          if (std::isnan(row.data[i])) return;
        }
    }
  }

  Unknown p_, q_;
  /// One for each use, so that a member ahead never writes what another still reads.
  RowSums sums_[5];
};

}  // namespace hourglass
