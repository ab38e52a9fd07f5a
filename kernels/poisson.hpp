#pragma once
// The pressure operator on a staggered patch, integrated over a cell:
//
//   (A q)_c = sum over the four faces of beta_f (q_c - q_nb),   beta = aperture / rho [L^2/M] on faces,
//
// and of the Helmholtz equation of the granular fluidity, which adds an absorption kappa_c q_c and has other beta,
// with q = 0 beyond every boundary: a wall has beta = 0, an open face 2 / rho (p = 0 half a cell away). A q =
// b with b the sum of face velocities into the cell, so that u - beta (q_right - q_left) is solenoidal.
#include <algorithm>
#include <limits>

#include "kernels/boundary.hpp"
#include "kernels/modules.hpp"
#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Coefficients of A; T is the precision of the preconditioner and, because the velocity correction reads the
/// same numbers, of nothing else: the divergence vanishes for these very coefficients.
template <class T>
struct PoissonCoefficients {
  VelocityOf<T> beta;               ///< on faces [L^2/M]
  CellFieldOf<T> inverse_diagonal;  ///< 1 / (sum of the four beta) [M/L^2]; 0 for a cell without open face
  CellFieldOf<T> absorption;        ///< kappa, in the unit of beta; not allocated for the pressure

  PoissonCoefficients() = default;
  explicit PoissonCoefficients(const Patch& p) : beta(p), inverse_diagonal(p) {}
  std::size_t bytes() const { return beta.bytes() + inverse_diagonal.bytes() + absorption.bytes(); }
};

/// Row j: the stencil. In outflow() differences come before beta: what leaves a cell is to the last bit what enters
/// the next, and a constant is no source, which a closed box cannot do without. Relaxation is cheaper without.
template <class T, class X>
struct PoissonRow {
  const T *bx, *bs, *bn;
  const X *q, *qs, *qn;
  PoissonRow(const PoissonCoefficients<T>& a, const CellFieldOf<X>& x, int j)
      : bx(a.beta.u.row(j)), bs(a.beta.v.row(j)), bn(a.beta.v.row(j + 1)), q(x.row(j)), qs(x.row(j - 1)),
        qn(x.row(j + 1)) {}
  X off_diagonal(int i) const {
    return (X(bx[i + 1]) * q[i + 1] + X(bx[i]) * q[i - 1]) + (X(bn[i]) * qn[i] + X(bs[i]) * qs[i]);
  }
  X outflow(int i) const {
    return (X(bx[i + 1]) * (q[i] - q[i + 1]) + X(bx[i]) * (q[i] - q[i - 1])) +
           (X(bn[i]) * (q[i] - qn[i]) + X(bs[i]) * (q[i] - qs[i]));
  }
};

/// Gauss-Seidel on the cells of row j of one colour (take_colour). in: x, halo 1 (0, or wrapped); out: row j
/// of x. Reads beta 8 B, inverse diagonal 4 B, b 4 B, x 4 B and writes x 4 B a cell (float).
template <class T>
void relax_poisson_row(const PoissonCoefficients<T>& a, CellFieldOf<T>& x, const CellFieldOf<T>& b, int j,
                       int colour, T* __restrict scratch) {
  const PoissonRow<T, T> row(a, x, j);
  const T* __restrict rhs = b.row(j);
  const T* __restrict inv = a.inverse_diagonal.row(j);
  const int n = x.nx();
#pragma omp simd
  for (int i = 0; i < n; ++i) scratch[i] = inv[i] * (rhs[i] + row.off_diagonal(i));
  take_colour(scratch, n, j, colour, x.row(j));
}

/// (A x) on row j. in: x, halo 1. 16 B/cell (float).
template <class T, class X>
void apply_poisson_row(const PoissonCoefficients<T>& a, const CellFieldOf<X>& x, int j, X* __restrict out) {
  const PoissonRow<T, X> row(a, x, j);
  const int n = x.nx();
#pragma omp simd
  for (int i = 0; i < n; ++i) out[i] = row.outflow(i);
  if (with_modules && a.absorption.allocated()) {
    const T* __restrict kappa = a.absorption.row(j);
#pragma omp simd
    for (int i = 0; i < n; ++i) out[i] += X(kappa[i]) * row.q[i];
  }
}

/// b - A x on row j. 20 B/cell (float).
template <class T, class X>
void residual_poisson_row(const PoissonCoefficients<T>& a, const CellFieldOf<X>& x, const CellFieldOf<X>& b,
                          int j, X* __restrict out) {
  const PoissonRow<T, X> row(a, x, j);
  const X* __restrict rhs = b.row(j);
  const int n = x.nx();
#pragma omp simd
  for (int i = 0; i < n; ++i) out[i] = rhs[i] - row.outflow(i);
  if (with_modules && a.absorption.allocated()) {
    const T* __restrict kappa = a.absorption.row(j);
#pragma omp simd
    for (int i = 0; i < n; ++i) out[i] -= X(kappa[i]) * row.q[i];
  }
}

template <class T>
void fill_inverse_diagonal(Team& team, PoissonCoefficients<T>& a) {
  const Rows rows = team.rows(a.inverse_diagonal.ny());
  for (int j = rows.begin; j < rows.end; ++j) {
    const T *bx = a.beta.u.row(j), *bs = a.beta.v.row(j), *bn = a.beta.v.row(j + 1);
    T* __restrict inv = a.inverse_diagonal.row(j);
    const int n = a.inverse_diagonal.nx();
    if (with_modules && a.absorption.allocated()) {
      const T* __restrict kappa = a.absorption.row(j);
#pragma omp simd
      for (int i = 0; i < n; ++i) inv[i] = kappa[i] + ((bx[i + 1] + bx[i]) + (bn[i] + bs[i]));
    } else {
#pragma omp simd
      for (int i = 0; i < n; ++i) inv[i] = (bx[i + 1] + bx[i]) + (bn[i] + bs[i]);
    }
#pragma omp simd
    for (int i = 0; i < n; ++i) inv[i] = T(inv[i] > T(0)) / std::max(inv[i], std::numeric_limits<T>::min());
  }
}

/// beta of the next coarser level: the mean of the two fine faces on each coarse face; at an orifice the
/// closed ones count as 0, which is the open share (docs/theory.md, Solvers). Rows of this member; sync
/// before and after.
template <class T>
void coarsen_poisson(Team& team, const PoissonCoefficients<T>& fine, PoissonCoefficients<T>& coarse) {
  const int nx = coarse.inverse_diagonal.nx(), ny = coarse.inverse_diagonal.ny();
  const Rows rows = team.rows(ny + 1);
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const T *b0 = fine.beta.u.row(2 * j), *b1 = fine.beta.u.row(2 * j + 1);
      T* __restrict out = coarse.beta.u.row(j);
      for (int i = 0; i <= nx; ++i) out[i] = T(0.5) * (b0[2 * i] + b1[2 * i]);
      if (with_modules && fine.absorption.allocated()) {  // an integral over the cell
        const T *k0 = fine.absorption.row(2 * j), *k1 = fine.absorption.row(2 * j + 1);
        T* __restrict kappa = coarse.absorption.row(j);
        for (int i = 0; i < nx; ++i) kappa[i] = (k0[2 * i] + k0[2 * i + 1]) + (k1[2 * i] + k1[2 * i + 1]);
      }
    }
    const T* b = fine.beta.v.row(2 * j);
    T* __restrict out = coarse.beta.v.row(j);
    for (int i = 0; i < nx; ++i) out[i] = T(0.5) * (b[2 * i] + b[2 * i + 1]);
  }
}

/// coarse = sum of the four fine cells. Rows of this member; sync before and after. 5 B a fine cell (float).
template <class T>
void restrict_poisson(Team& team, const CellFieldOf<T>& fine, CellFieldOf<T>& coarse) {
  const Rows rows = team.rows(coarse.ny());
  for (int j = rows.begin; j < rows.end; ++j) {
    const T *r0 = fine.row(2 * j), *r1 = fine.row(2 * j + 1);
    T* __restrict out = coarse.row(j);
    const int n = coarse.nx();
#pragma omp simd
    for (int i = 0; i < n; ++i) out[i] = (r0[2 * i] + r0[2 * i + 1]) + (r1[2 * i] + r1[2 * i + 1]);
  }
}

/// Interpolation weight of the neighbour behind a face, in units of the bilinear one: 1 in a uniform medium,
/// towards 0 from a light cell to a dense one. Across the free surface q is continuous in slope times beta,
/// so in the light medium it hardly changes and must not follow the dense one; at a wall (beta = 0) it is
/// level.
template <class T>
T interpolation_weight(T beta, T inverse_diagonal) {
  return std::min(T(1), T(6) * beta * inverse_diagonal);
}

/// Row j of fine += coarse, interpolated by products of (1 - w/4, w/4), w = interpolation_weight; behind an
/// open boundary face stands -q. Halo of fine is wrapped where periodic, else left 0. scratch: nx + 2 values.
/// 12 B a fine cell (float): fine 8, coarse q, beta and inverse diagonal 16 a coarse cell.
template <class T>
void prolong_poisson_row(const PoissonCoefficients<T>& a, const CellFieldOf<T>& coarse, bool periodic,
                         CellFieldOf<T>& fine, int j, T* __restrict scratch) {
  const int nx = coarse.nx(), ny = coarse.ny();
  T* __restrict line = scratch + 1;
  const int cj = j / 2, other = j % 2 == 0 ? cj - 1 : cj + 1;
  const bool outside = other < 0 || other >= ny;
  const T *near = coarse.row(cj), *far = outside ? near : coarse.row(other);
  const T sign = outside ? T(-1) : T(1);
  const T* by = a.beta.v.row(j % 2 == 0 ? cj : cj + 1);
  const T* bx = a.beta.u.row(cj);
  const T* inv = a.inverse_diagonal.row(cj);
#pragma omp simd
  for (int i = 0; i < nx; ++i)
    line[i] = near[i] + T(0.25) * interpolation_weight(by[i], inv[i]) * (sign * far[i] - near[i]);
  line[-1] = periodic ? line[nx - 1] : -line[0];
  line[nx] = periodic ? line[0] : -line[nx - 1];
  T* __restrict out = fine.row(j);
#pragma omp simd
  for (int i = 0; i < nx; ++i) {
    out[2 * i] += line[i] + T(0.25) * interpolation_weight(bx[i], inv[i]) * (line[i - 1] - line[i]);
    out[2 * i + 1] += line[i] + T(0.25) * interpolation_weight(bx[i + 1], inv[i]) * (line[i + 1] - line[i]);
  }
  if (periodic) wrap_row(out, 2 * nx);
}

/// All rows of this member; sync before and after.
template <class T>
void prolong_poisson(Team& team, const PoissonCoefficients<T>& a, const CellFieldOf<T>& coarse, bool periodic,
                     CellFieldOf<T>& fine, T* scratch) {
  const Rows rows = team.rows(fine.ny());
  for (int j = rows.begin; j < rows.end; ++j) prolong_poisson_row(a, coarse, periodic, fine, j, scratch);
}

}  // namespace hourglass
