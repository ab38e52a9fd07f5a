#pragma once
// The viscous operator on a staggered patch, from the discrete energy (Batty & Bridson 2008)
//
//   E(u) = 1/2 sum_f m_f u_f^2 + sum_c eta_c [(dx u)^2 + (dy v)^2] h^2 + 1/2 sum_n eta_n (dy u + dx v)^2 h^2,
//
// so A = E'' is symmetric and positive. Written out, with m = V rho h^2 / dt [M/T] on faces, V the share of a
// full control volume (1/2 on open boundary faces), eta_c [M/T] in cells, eta_n [M/T] at corners:
//
//   (A u)_u = (m + 2 eta_E + 2 eta_W + eta_N + eta_S) u - 2 eta_E u_E - 2 eta_W u_W
//             - eta_N (u_N + v_NE - v_NW) - eta_S (u_S - v_SE + v_SW),   and the same for v with x and y exchanged.
//
// A x = b has the unit of force. Fixed faces (walls) have inverse diagonal 0: they keep the value 0 and
// residual 0. Halos of eta are 0 and halos of x are 0, except where periodic; corner weights at walls sit in
// eta_n (SideFaces).
#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/boundary.hpp"
#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Coefficients of A; T is the precision of the preconditioner. 6 arrays.
template <class T>
struct ViscousCoefficients {
  CellFieldOf<T> eta_c;            ///< [M/T]
  CornerFieldOf<T> eta_n;          ///< weighted at boundaries [M/T]
  VelocityOf<T> mass;              ///< m [M/T]
  VelocityOf<T> inverse_diagonal;  ///< 1/diagonal, 0 on fixed faces [T/M]

  ViscousCoefficients() = default;
  explicit ViscousCoefficients(const Patch& p) : eta_c(p), eta_n(p), mass(p), inverse_diagonal(p) {}
  std::size_t bytes() const {
    return eta_c.bytes() + eta_n.bytes() + mass.bytes() + inverse_diagonal.bytes();
  }
};

/// Row j of the u-equations: the stencil, written once. X is the precision of the unknown. Differences are
/// taken before eta multiplies them: in float, eta U - eta U would leave a force of 1e-7 eta U on a body that
/// moves as a whole, more than what holds it where eta is large.
template <class T, class X>
struct URow {
  const T *ec, *nn, *ns;
  const X *u, *un, *us, *vn, *vs;
  URow(const ViscousCoefficients<T>& a, const VelocityOf<X>& x, int j)
      : ec(a.eta_c.row(j)), nn(a.eta_n.row(j + 1)), ns(a.eta_n.row(j)), u(x.u.row(j)), un(x.u.row(j + 1)),
        us(x.u.row(j - 1)), vn(x.v.row(j + 1)), vs(x.v.row(j)) {}
  [[gnu::always_inline]] X stress(int i) const {
    return X(2) * (X(ec[i]) * (u[i] - u[i + 1]) + X(ec[i - 1]) * (u[i] - u[i - 1])) +
           (X(nn[i]) * ((u[i] - un[i]) - (vn[i] - vn[i - 1])) +
            X(ns[i]) * ((u[i] - us[i]) + (vs[i] - vs[i - 1])));
  }
};

/// Row j of the v-equations.
template <class T, class X>
struct VRow {
  const T *en, *es, *nc;
  const X *v, *vn, *vs, *un, *us;
  VRow(const ViscousCoefficients<T>& a, const VelocityOf<X>& x, int j)
      : en(a.eta_c.row(j)), es(a.eta_c.row(j - 1)), nc(a.eta_n.row(j)), v(x.v.row(j)), vn(x.v.row(j + 1)),
        vs(x.v.row(j - 1)), un(x.u.row(j)), us(x.u.row(j - 1)) {}
  [[gnu::always_inline]] X stress(int i) const {
    return X(2) * (X(en[i]) * (v[i] - vn[i]) + X(es[i]) * (v[i] - vs[i])) +
           (X(nc[i + 1]) * ((v[i] - v[i + 1]) - (un[i + 1] - us[i + 1])) +
            X(nc[i]) * ((v[i] - v[i - 1]) + (un[i] - us[i])));
  }
};

/// Gauss-Seidel on the points of row j of one colour, 0 or 1 (take_colour).
/// in: x, halo 1; b, coefficients; scratch: nx + 1 values; out: row j of x.u. 4 coefficients, b and both
/// components read, one written: 32 B/point (float).
template <class T>
void relax_u_row(const ViscousCoefficients<T>& a, VelocityOf<T>& x, const VelocityOf<T>& b, int j, int colour,
                 T* __restrict scratch) {
  const URow<T, T> row(a, x, j);
  const T* __restrict rhs = b.u.row(j);
  const T* __restrict m = a.mass.u.row(j);
  const T* __restrict old = x.u.row(j);
  const T* __restrict inv = a.inverse_diagonal.u.row(j);
  const int n = x.u.nx();
  // The new row goes through scratch: stores into x would be reloaded by the next vector's x[i - 1].
#pragma omp simd
  for (int i = 0; i < n; ++i) scratch[i] = old[i] + inv[i] * (rhs[i] - m[i] * old[i] - row.stress(i));
  take_colour(scratch, n, j, colour, x.u.row(j));
}

template <class T>
void relax_v_row(const ViscousCoefficients<T>& a, VelocityOf<T>& x, const VelocityOf<T>& b, int j, int colour,
                 T* __restrict scratch) {
  const VRow<T, T> row(a, x, j);
  const T* __restrict rhs = b.v.row(j);
  const T* __restrict m = a.mass.v.row(j);
  const T* __restrict old = x.v.row(j);
  const T* __restrict inv = a.inverse_diagonal.v.row(j);
  const int n = x.v.nx();
#pragma omp simd
  for (int i = 0; i < n; ++i) scratch[i] = old[i] + inv[i] * (rhs[i] - m[i] * old[i] - row.stress(i));
  take_colour(scratch, n, j, colour, x.v.row(j));
}

/// out = f(i, (A x)_i) on row k of the unknown (row_of's numbering), 0 on fixed faces. in: x, halo 1. (A
/// product with 0 or 1, not a choice: GCC moves what a choice leaves unused behind a branch, and then has no
/// vector code for it.)
template <class T, class X, class F>
void map_viscous_row(const ViscousCoefficients<T>& a, const VelocityOf<X>& x, int k, X* __restrict out, F f) {
  const int j = k / 2;
  if (k % 2 == 0 && j < x.u.ny()) {
    const URow<T, X> row(a, x, j);
    const T* __restrict m = a.mass.u.row(j);
    const T* __restrict inv = a.inverse_diagonal.u.row(j);
    const int n = x.u.nx();
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      out[i] = X(inv[i] != T(0)) * f(i, X(m[i]) * row.u[i] + row.stress(i));
    }
  } else {
    const VRow<T, X> row(a, x, j);
    const T* __restrict m = a.mass.v.row(j);
    const T* __restrict inv = a.inverse_diagonal.v.row(j);
    const int n = x.v.nx();
#pragma omp simd
    for (int i = 0; i < n; ++i) {
      out[i] = X(inv[i] != T(0)) * f(i, X(m[i]) * row.v[i] + row.stress(i));
    }
  }
}

/// A x, and b - A x, on row k. 40 and 48 B/cell (float), both components.
template <class T, class X>
void apply_viscous_row(const ViscousCoefficients<T>& a, const VelocityOf<X>& x, int k, X* out) {
  map_viscous_row(a, x, k, out, [](int, X ax) { return ax; });
}
template <class T, class X>
void residual_viscous_row(const ViscousCoefficients<T>& a, const VelocityOf<X>& x, const VelocityOf<X>& b,
                          int k, X* out) {
  const X* rhs = row_of(b, k).data;
  map_viscous_row(a, x, k, out, [rhs](int i, X ax) { return rhs[i] - ax; });
}

/// 1/x, or 0 where not `moves`; without a branch.
template <class T>
T inverse_if(bool moves, T x) {
  return T(moves) / std::max(x, std::numeric_limits<T>::min());
}

/// inverse_diagonal from the other coefficients; fixed are faces of the boundary that are walls, and faces without mass,
/// which lie in solids. Rows of this member; sync after.
template <class T>
void fill_inverse_diagonal(Team& team, const Boundary& boundary, ViscousCoefficients<T>& a) {
  const int nx = a.eta_c.nx(), ny = a.eta_c.ny();
  const Rows rows = team.rows(ny + 1);
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const T* ec = a.eta_c.row(j);
      const T *nn = a.eta_n.row(j + 1), *ns = a.eta_n.row(j);
      const T* m = a.mass.u.row(j);
      T* __restrict inv = a.inverse_diagonal.u.row(j);
#pragma omp simd
      for (int i = 0; i <= nx; ++i)
        inv[i] = inverse_if(m[i] > T(0), m[i] + T(2) * (ec[i] + ec[i - 1]) + (nn[i] + ns[i]));
      if (!boundary.periodic_x && !Boundary::unknown(boundary.left.open[j])) inv[0] = 0;
      if (boundary.periodic_x || !Boundary::unknown(boundary.right.open[j]))
        inv[nx] = 0;  // periodic: the same as face 0
    }
    const T *en = a.eta_c.row(j), *es = a.eta_c.row(j - 1);
    const T* nc = a.eta_n.row(j);
    const T* m = a.mass.v.row(j);
    T* __restrict inv = a.inverse_diagonal.v.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i)
      inv[i] = inverse_if(m[i] > T(0), m[i] + T(2) * (en[i] + es[i]) + (nc[i + 1] + nc[i]));
    if (j == 0 || j == ny) {
      const SideFaces& side = j == 0 ? boundary.bottom : boundary.top;
      for (int i = 0; i < nx; ++i)
        if (!Boundary::unknown(side.open[i])) inv[i] = 0;
    }
  }
}

/// Coefficients of the next coarser level by full weighting with the weights of P: 1-3-3-1 across (eta_c in
/// both directions), 1-2-1 along. Means over all that P reaches bound the Galerkin operator from above to
/// within 4/3, so the coarse correction never overshoots (docs/theory.md, Solvers); a mean of 4 for eta_c
/// does, by the contrast / 300. in: fine, halo 1; out: coarse, but for its halo and inverse diagonal. Rows of
/// this member; sync before and after.
template <class T>
void coarsen_viscous(Team& team, const ViscousCoefficients<T>& fine, bool periodic_x,
                     ViscousCoefficients<T>& coarse) {
  const int nx = coarse.eta_c.nx(), ny = coarse.eta_c.ny();
  const Rows rows = team.rows(ny + 1);
  // First combine fine rows into one line, then its points into coarse ones.
  T* __restrict line = row_scratch<T>(2 * nx + 2);
  const auto extend_cells = [&](T* l) {
    l[-1] = periodic_x ? l[2 * nx - 1] : l[0];
    l[2 * nx] = periodic_x ? l[0] : l[2 * nx - 1];
  };
  const auto extend_faces = [&](T* l) {
    l[-1] = periodic_x ? l[2 * nx - 1] : T(0);
    l[2 * nx + 1] = periodic_x ? l[1] : T(0);
  };
  for (int j = rows.begin; j < rows.end; ++j) {
    if (j < ny) {
      const int below = std::max(2 * j - 1, 0), above = std::min(2 * j + 2, 2 * ny - 1);
      const auto across = [&](const auto& f, int n) {  // 1-3-3-1 over rows
        const T *b = f.row(below), *c = f.row(2 * j), *d = f.row(2 * j + 1), *a = f.row(above);
#pragma omp simd
        for (int i = 0; i < n; ++i) line[i] = T(0.375) * (c[i] + d[i]) + T(0.125) * (b[i] + a[i]);
      };
      across(fine.eta_c, 2 * nx);
      extend_cells(line);
      T* __restrict ec = coarse.eta_c.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i)
        ec[i] = T(0.375) * (line[2 * i] + line[2 * i + 1]) + T(0.125) * (line[2 * i - 1] + line[2 * i + 2]);
      across(fine.mass.u, 2 * nx + 1);
      extend_faces(line);
      T* __restrict m = coarse.mass.u.row(j);
#pragma omp simd
      for (int i = 0; i <= nx; ++i) m[i] = T(2) * line[2 * i] + (line[2 * i - 1] + line[2 * i + 1]);
      const T *m0 = fine.mass.u.row(2 * j), *m1 = fine.mass.u.row(2 * j + 1);
#pragma omp simd
      for (int i = 0; i <= nx; ++i) m[i] *= T(m0[2 * i] + m1[2 * i] > T(0));  // solid where both faces are
    }
    const bool inside_y = j > 0 && j < ny;
    {
      const T ws = j > 0 ? T(0.5) : T(0), wn = j < ny ? T(0.5) : T(0);
      const T* c = fine.mass.v.row(2 * j);
      const T *s = fine.mass.v.row(j > 0 ? 2 * j - 1 : 0), *n = fine.mass.v.row(j < ny ? 2 * j + 1 : 2 * ny);
#pragma omp simd
      for (int i = 0; i < 2 * nx; ++i) line[i] = c[i] + (ws * s[i] + wn * n[i]);
      extend_cells(line);
      T* __restrict m = coarse.mass.v.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i)
        m[i] = T(0.75) * (line[2 * i] + line[2 * i + 1]) + T(0.25) * (line[2 * i - 1] + line[2 * i + 2]);
#pragma omp simd
      for (int i = 0; i < nx; ++i) m[i] *= T(c[2 * i] + c[2 * i + 1] > T(0));
    }
    // Corners: 1-2-1 along a boundary, 1-2-1 x 1-2-1 inside.
    const T* c = fine.eta_n.row(2 * j);
    const T *s = inside_y ? fine.eta_n.row(2 * j - 1) : c, *n = inside_y ? fine.eta_n.row(2 * j + 1) : c;
#pragma omp simd
    for (int i = 0; i <= 2 * nx; ++i) line[i] = T(0.25) * (T(2) * c[i] + (s[i] + n[i]));
    extend_faces(line);
    T* __restrict out = coarse.eta_n.row(j);
#pragma omp simd
    for (int i = 0; i <= nx; ++i)
      out[i] = T(0.25) * (T(2) * line[2 * i] + (line[2 * i - 1] + line[2 * i + 1]));
    if (!periodic_x) {
      out[0] = line[0];
      out[nx] = line[2 * nx];
    }
  }
}

/// coarse = P^T fine, the transpose of prolong_viscous. in: fine residual, 0 on fixed faces, halo 1
/// (periodic). Rows of this member; sync before and after. 10 B a fine cell (float).
template <class T>
void restrict_viscous(Team& team, const VelocityOf<T>& fine, const Boundary& coarse_boundary,
                      VelocityOf<T>& coarse) {
  const int nx = coarse.patch().nx, ny = coarse.patch().ny;
  const Rows rows = team.rows(ny + 1);
  const bool periodic = coarse_boundary.periodic_x;
  for (int j = rows.begin; j < rows.end; ++j) {
    T* __restrict line = row_scratch<T>(2 * nx + 2);
    if (j < ny) {
      const T *r0 = fine.u.row(2 * j), *r1 = fine.u.row(2 * j + 1);
      const bool floor = j == 0, ceiling = j == ny - 1;
      const T *below = floor ? r0 : fine.u.row(2 * j - 1), *above = ceiling ? r1 : fine.u.row(2 * j + 2);
      const T wb = floor ? T(0) : T(0.25), wa = ceiling ? T(0) : T(0.25);
#pragma omp simd
      for (int i = -1; i <= 2 * nx + 1; ++i)
        line[i] = T(0.75) * (r0[i] + r1[i]) + (wb * below[i] + wa * above[i]);
      T* __restrict out = coarse.u.row(j);
#pragma omp simd
      for (int i = 0; i <= nx; ++i) out[i] = line[2 * i] + T(0.5) * (line[2 * i - 1] + line[2 * i + 1]);
      const auto add_ghost = [&](const T* r, const SideFaces& side) {
        for (int i = 0; i <= nx; ++i)
          out[i] +=
              T(0.25 * ghost_factor(side.shear[i])) * (r[2 * i] + T(0.5) * (r[2 * i - 1] + r[2 * i + 1]));
      };
      if (floor) add_ghost(r0, coarse_boundary.bottom);
      if (ceiling) add_ghost(r1, coarse_boundary.top);
    }
    const T *c = fine.v.row(2 * j), *s = fine.v.row(2 * j - 1),
            *n = fine.v.row(2 * j + 1);  // beyond the patch: halo, 0
#pragma omp simd
    for (int i = 0; i < 2 * nx; ++i) line[i] = c[i] + T(0.5) * (s[i] + n[i]);
    line[-1] = periodic ? line[2 * nx - 1] : T(ghost_factor(coarse_boundary.left.shear[j])) * line[0];
    line[2 * nx] = periodic ? line[0] : T(ghost_factor(coarse_boundary.right.shear[j])) * line[2 * nx - 1];
    T* __restrict out = coarse.v.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i)
      out[i] = T(0.75) * (line[2 * i] + line[2 * i + 1]) + T(0.25) * (line[2 * i - 1] + line[2 * i + 2]);
  }
}

/// Row j of fine (u row j and v row j) += P coarse on unknown faces: linear along a component's own
/// direction, (3/4, 1/4) across it with ghost_factor at boundaries, so that a rigid rotation is reproduced
/// exactly. Halo of fine is wrapped where periodic. 26 B a fine cell (float): fine 16, inverse diagonal 8,
/// coarse 8 a coarse cell.
template <class T>
void prolong_viscous_row(const VelocityOf<T>& coarse, const Boundary& coarse_boundary,
                         const VelocityOf<T>& fine_inverse_diagonal, VelocityOf<T>& fine, int j) {
  const int nx = coarse.patch().nx, ny = coarse.patch().ny;
  const bool periodic = coarse_boundary.periodic_x;
  const int cj = j / 2;
  if (j < 2 * ny) {
    const T* near = coarse.u.row(cj);
    const int other = j % 2 == 0 ? cj - 1 : cj + 1;
    const bool ghost = other < 0 || other >= ny;
    const T* far = ghost ? near : coarse.u.row(other);
    const SideFaces& side = other < 0 ? coarse_boundary.bottom : coarse_boundary.top;
    const T* __restrict inv = fine_inverse_diagonal.u.row(j);
    T* __restrict out = fine.u.row(j);
    const auto blend = [&](int i) {
      const T s = ghost ? T(ghost_factor(side.shear[i])) : T(1);
      return T(0.75) * near[i] + T(0.25) * s * far[i];
    };
    if (!ghost) {
#pragma omp simd
      for (int i = 0; i < nx; ++i) {
        const T here = T(0.75) * near[i] + T(0.25) * far[i];
        const T next = T(0.75) * near[i + 1] + T(0.25) * far[i + 1];
        out[2 * i] += T(inv[2 * i] != T(0)) * here;
        out[2 * i + 1] += T(inv[2 * i + 1] != T(0)) * (T(0.5) * (here + next));
      }
    } else {
      for (int i = 0; i < nx; ++i) {
        if (inv[2 * i] != T(0)) out[2 * i] += blend(i);
        if (inv[2 * i + 1] != T(0)) out[2 * i + 1] += T(0.5) * (blend(i) + blend(i + 1));
      }
    }
    if (inv[2 * nx] != T(0)) out[2 * nx] += blend(nx);
    if (periodic) wrap_row(out, 2 * nx);
  }
  {
    const T* here = coarse.v.row(cj);
    const T* next = coarse.v.row(j % 2 == 0 ? cj : cj + 1);
    const T* __restrict inv = fine_inverse_diagonal.v.row(j);
    T* __restrict out = fine.v.row(j);
    const auto line = [&](int i) { return T(0.5) * (here[i] + next[i]); };
    const int nj = j % 2 == 0 ? cj : cj + 1;
    const auto ghost = [&](const SideFaces& side, int i) {
      return T(0.5) * (T(ghost_factor(side.shear[cj])) * here[i] + T(ghost_factor(side.shear[nj])) * next[i]);
    };
    const T left = periodic ? line(nx - 1) : ghost(coarse_boundary.left, 0);
    const T right = periodic ? line(0) : ghost(coarse_boundary.right, nx - 1);
    const auto add = [&](int i, T l, T c, T r) {
      if (inv[2 * i] != T(0)) out[2 * i] += T(0.75) * c + T(0.25) * l;
      if (inv[2 * i + 1] != T(0)) out[2 * i + 1] += T(0.75) * c + T(0.25) * r;
    };
    add(0, left, line(0), nx > 1 ? line(1) : right);
#pragma omp simd
    for (int i = 1; i < nx - 1; ++i) {
      const T l = line(i - 1), c = line(i), r = line(i + 1);
      out[2 * i] += T(inv[2 * i] != T(0)) * (T(0.75) * c + T(0.25) * l);
      out[2 * i + 1] += T(inv[2 * i + 1] != T(0)) * (T(0.75) * c + T(0.25) * r);
    }
    if (nx > 1) add(nx - 1, line(nx - 2), line(nx - 1), right);
    if (periodic) wrap_row(out, 2 * nx);
  }
}

/// All rows of this member; sync before and after.
template <class T>
void prolong_viscous(Team& team, const VelocityOf<T>& coarse, const Boundary& coarse_boundary,
                     const VelocityOf<T>& fine_inverse_diagonal, VelocityOf<T>& fine) {
  const Rows rows = team.rows(2 * coarse.patch().ny + 1);
  for (int j = rows.begin; j < rows.end; ++j)
    prolong_viscous_row(coarse, coarse_boundary, fine_inverse_diagonal, fine, j);
}

}  // namespace hourglass
