#pragma once
// The multigrid levels of the two operators: coefficients, work fields and boundary on one patch.
#include <algorithm>
#include <vector>

#include "kernels/poisson.hpp"
#include "kernels/viscous.hpp"

namespace hourglass {

/// ∇·((1/ρ)∇q) = b on one patch.
template <class T>
class PoissonLevel {
 public:
  using Number = T;
  using Unknown = CellFieldOf<T>;

  PoissonLevel(const Patch& p, const Boundary& boundary, bool /*finest*/)
      : a(p), x(p), b(p), r(p), boundary_(boundary) {}

  PoissonCoefficients<T> a;
  Unknown x, b, r;

  const Boundary& boundary() const { return boundary_; }
  void finish(Team& team) {
    fill_inverse_diagonal(team, a);
    team.sync();
  }
  void coarsen(Team& team, const PoissonLevel& fine) {
    coarsen_poisson(team, fine.a, a);
    team.sync();
    finish(team);
  }
  void relax(Team& team, Unknown& q, const Unknown& rhs, bool reversed) const {
    const Rows rows = team.rows(q.ny());
    T* scratch = row_scratch<T>(q.nx());
    for (int pass = 0; pass < 2; ++pass) {
      const int colour = reversed ? 1 - pass : pass;
      for (int j = rows.begin; j < rows.end; ++j) relax_row(q, rhs, j, colour, scratch);
      team.sync();
    }
  }
  void residual(Team& team, const Unknown& q, const Unknown& rhs, Unknown& out) const {
    const Rows rows = team.rows(q.ny());
    for (int j = rows.begin; j < rows.end; ++j) residual_row(q, rhs, out, j);
    team.sync();
  }
  template <class X>
  void apply_row(const CellFieldOf<X>& q, int k, X* out) const {
    apply_poisson_row(a, q, k, out);
  }
  /// `sweeps` sweeps from x = 0, r = b - A x, in one pass through memory. Synced on return, as ascend().
  void descend(Team& team, int sweeps) {
    T* scratch = row_scratch<T>(x.nx() + 2);
    wavefront(team, x.ny(), 2 * sweeps + 1, [&](int s, int j) {
      if (s == 0) {
        start_colour(b.row(j), a.inverse_diagonal.row(j), x.nx(), j, 0, x.row(j));
        wrap(x, j);
      } else if (s < 2 * sweeps) {
        relax_row(x, b, j, s % 2, scratch);
      } else {
        residual_row(x, b, r, j);
      }
    });
  }
  /// x += P coarse, `sweeps` sweeps in reversed order.
  void ascend(Team& team, const PoissonLevel& coarse, int sweeps) {
    T* scratch = row_scratch<T>(x.nx() + 2);
    wavefront(team, x.ny(), 2 * sweeps + 1, [&](int s, int j) {
      if (s == 0) {
        prolong_poisson_row(coarse.a, coarse.x, boundary_.periodic_x, x, j, scratch);
      } else {
        relax_row(x, b, j, s % 2, scratch);
      }
    });
  }
  void restrict_from(Team& team, const Unknown& fine) {
    restrict_poisson(team, fine, b);
    team.sync();
  }
  void prolong_to(Team& team, PoissonLevel& fine) const {
    prolong_poisson(team, a, x, boundary_.periodic_x, fine.x, row_scratch<T>(x.nx() + 2));
    team.sync();
  }
  template <class X>
  void wrap(CellFieldOf<X>& q, int k) const {
    if (boundary_.periodic_x) wrap_row(q.row(k), q.nx());
  }
  template <class X>
  void mask(CellFieldOf<X>&, int) const {}  // every cell is an unknown
  bool fixed(int, int) const { return false; }
  /// A closed box: constants are solutions without a source.
  bool singular() const { return !boundary_.any_open() && !a.absorption.allocated(); }
  std::size_t bytes() const { return a.bytes() + x.bytes() + b.bytes() + r.bytes(); }

 private:
  void residual_row(const Unknown& q, const Unknown& rhs, Unknown& out, int j) const {
    residual_poisson_row(a, q, rhs, j, out.row(j));
    wrap(out, j);
  }
  void relax_row(Unknown& q, const Unknown& rhs, int j, int colour, T* scratch) const {
    relax_poisson_row(a, q, rhs, j, colour, scratch);
    wrap(q, j);
  }

  Boundary boundary_;
};

/// κ q - ∇·(β ∇q) = b on one patch: the granular fluidity.
template <class T>
class HelmholtzLevel : public PoissonLevel<T> {
 public:
  HelmholtzLevel(const Patch& p, const Boundary& boundary, bool finest)
      : PoissonLevel<T>(p, boundary, finest) {
    this->a.absorption = CellFieldOf<T>(p);
  }
  bool singular() const { return false; }
};

/// ρ u - Δt ∇·(2ηD) = ρ u* on one patch.
template <class T>
class ViscousLevel {
 public:
  using Number = T;
  using Unknown = VelocityOf<T>;

  ViscousLevel(const Patch& p, const Boundary& boundary, bool /*finest*/)
      : a(p), x(p), b(p), r(p), boundary_(boundary) {}

  ViscousCoefficients<T> a;
  Unknown x, b, r;

  const Boundary& boundary() const { return boundary_; }
  /// Halos and inverse diagonals, once eta_c, eta_n and mass are set. Synced on return.
  void finish(Team& team) {
    if (boundary_.periodic_x) {
      const int nx = a.eta_c.nx(), ny = a.eta_c.ny();
      const Rows rows = team.rows(ny + 1);
      for (int j = rows.begin; j < rows.end; ++j) {
        if (j < ny) {
          wrap_row(a.eta_c.row(j), nx);
          wrap_row(a.mass.u.row(j), nx);
        }
        wrap_row(a.eta_n.row(j), nx);
        wrap_row(a.mass.v.row(j), nx);
      }
      team.sync();
    }
    fill_inverse_diagonal(team, boundary_, a);
    team.sync();
  }
  void coarsen(Team& team, const ViscousLevel& fine) {
    coarsen_viscous(team, fine.a, boundary_.periodic_x, a);
    team.sync();
    finish(team);
  }
  void relax(Team& team, Unknown& w, const Unknown& rhs, bool reversed) const {
    const Rows rows = team.rows(a.eta_c.ny() + 1);
    T* scratch = row_scratch<T>(a.eta_c.nx() + 1);
    for (int pass = 0; pass < 4; ++pass) {
      for (int j = rows.begin; j < rows.end; ++j) relax_row(w, rhs, j, reversed ? 3 - pass : pass, scratch);
      team.sync();
    }
  }
  /// `sweeps` sweeps from x = 0, r = b - A x, in one pass through memory. Synced on return, as ascend().
  void descend(Team& team, int sweeps) {
    T* scratch = row_scratch<T>(a.eta_c.nx() + 1);
    wavefront(team, a.eta_c.ny() + 1, 4 * sweeps + 1, [&](int s, int j) {
      if (s == 0) {
        if (j < x.u.ny()) {
          start_colour(b.u.row(j), a.inverse_diagonal.u.row(j), x.u.nx(), j, 0, x.u.row(j));
          wrap(x, 2 * j);
        }
        std::fill(x.v.row(j) - halo, x.v.row(j) + x.v.nx() + halo, T(0));
      } else if (s < 4 * sweeps) {
        relax_row(x, b, j, s % 4, scratch);
      } else {
        if (j < x.u.ny()) residual_row(x, b, r, 2 * j);
        residual_row(x, b, r, j < x.u.ny() ? 2 * j + 1 : 2 * j);
      }
    });
  }
  /// x += P coarse, `sweeps` sweeps in reversed order.
  void ascend(Team& team, const ViscousLevel& coarse, int sweeps) {
    T* scratch = row_scratch<T>(a.eta_c.nx() + 1);
    wavefront(team, a.eta_c.ny() + 1, 4 * sweeps + 1, [&](int s, int j) {
      if (s == 0) {
        prolong_viscous_row(coarse.x, coarse.boundary_, a.inverse_diagonal, x, j);
      } else {
        relax_row(x, b, j, 3 - (s - 1) % 4, scratch);
      }
    });
  }
  void residual(Team& team, const Unknown& w, const Unknown& rhs, Unknown& out) const {
    const Rows rows = team.rows(row_count(w));
    for (int k = rows.begin; k < rows.end; ++k) residual_row(w, rhs, out, k);
    team.sync();
  }
  template <class X>
  void apply_row(const VelocityOf<X>& w, int k, X* out) const {
    apply_viscous_row(a, w, k, out);
  }
  void restrict_from(Team& team, const Unknown& fine) {
    restrict_viscous(team, fine, boundary_, b);
    team.sync();
  }
  void prolong_to(Team& team, ViscousLevel& fine) const {
    prolong_viscous(team, x, boundary_, fine.a.inverse_diagonal, fine.x);
    team.sync();
  }
  template <class X>
  void wrap(VelocityOf<X>& w, int k) const {
    if (boundary_.periodic_x) wrap_row(row_of(w, k).data, a.eta_c.nx());
  }
  /// Zero on fixed faces.
  template <class X>
  void mask(VelocityOf<X>& w, int k) const {
    auto row = row_of(w, k);
    const T* __restrict inv = row_of(a.inverse_diagonal, k).data;
#pragma omp simd
    for (int i = 0; i < row.n; ++i) row.data[i] = inv[i] != T(0) ? row.data[i] : X(0);
  }
  bool singular() const { return false; }  // mass holds whatever moves
  bool fixed(int k, int i) const { return row_of(a.inverse_diagonal, k).data[i] == T(0); }
  std::size_t bytes() const { return a.bytes() + x.bytes() + b.bytes() + r.bytes(); }

 private:
  void residual_row(const Unknown& w, const Unknown& rhs, Unknown& out, int k) const {
    residual_viscous_row(a, w, rhs, k, row_of(out, k).data);
    wrap(out, k);
  }
  /// Stage 0, 1: u red, black; 2, 3: v red, black. Row j of u, or of v.
  void relax_row(Unknown& w, const Unknown& rhs, int j, int stage, T* scratch) const {
    if (stage < 2) {
      if (j >= w.u.ny()) return;
      relax_u_row(a, w, rhs, j, stage % 2, scratch);
      if (boundary_.periodic_x) wrap_row(w.u.row(j), a.eta_c.nx());
    } else {
      relax_v_row(a, w, rhs, j, stage % 2, scratch);
      if (boundary_.periodic_x) wrap_row(w.v.row(j), a.eta_c.nx());
    }
  }

  Boundary boundary_;
};

}  // namespace hourglass
