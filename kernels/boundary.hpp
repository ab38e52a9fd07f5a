#pragma once
// What the sides of a patch do, face by face, and the halo fills that follow from it.
#include <algorithm>
#include <vector>

#include "kernels/field.hpp"
#include "kernels/team.hpp"

namespace hourglass {

/// One side of a patch. Faces and corners are counted along the side, from left to right or from bottom to
/// top.
struct SideFaces {
  /// [faces] Open share of each boundary face, 0 (wall) to 1 (p = 0, no traction).
  std::vector<double> open;
  /// [faces + 1] Weight of the shear energy at each boundary corner in units of an inner corner's: 2 on a
  /// no-slip wall (the gradient is taken over half a cell, half a control volume), 0 on a free-slip wall and
  /// where open.
  std::vector<double> shear;
};

/// Shear, seen as a ghost value: tangential velocity outside = ghost_factor * inside.
inline double ghost_factor(double shear_weight) { return 1 - shear_weight; }

/// What lies beyond the ends of a row: its other end, or its mirror image beyond the left one.
struct Ends {
  bool periodic = false, mirror = false;
};

struct Boundary {
  SideFaces left, right, bottom, top;
  bool periodic_x = false;
  bool mirror_left =
      false;  ///< the left side is the middle of what is meant: a plane of symmetry, or the axis

  /// The same boundary seen by the patch with half the cells: open shares and shear weights are averaged, so
  /// an orifice thinner than a coarse cell stays open on it.
  Boundary coarser() const;
  Ends ends() const { return {periodic_x, mirror_left}; }
  /// The same with every face that is open at all open enough to carry an unknown.
  Boundary with_partly_open() const;
  /// Whether a boundary face carries an unknown normal velocity on this level.
  static bool unknown(double open) { return open >= 0.5; }
  bool any_open() const;
};

inline SideFaces coarser(const SideFaces& s, bool periodic = false) {
  SideFaces c;
  const int n = static_cast<int>(s.open.size()) / 2;
  c.open.resize(n);
  c.shear.resize(n + 1);
  for (int k = 0; k < n; ++k) c.open[k] = 0.5 * (s.open[2 * k] + s.open[2 * k + 1]);
  for (int k = 0; k <= n; ++k) {
    const double left = s.shear[k > 0 ? 2 * k - 1 : periodic ? 2 * n - 1 : 0];
    const double right = s.shear[k < n ? 2 * k + 1 : periodic ? 1 : 2 * n];
    c.shear[k] = 0.25 * (left + 2 * s.shear[2 * k] + right);
  }
  return c;
}

inline Boundary Boundary::coarser() const {
  return {hourglass::coarser(left),
          hourglass::coarser(right),
          hourglass::coarser(bottom, periodic_x),
          hourglass::coarser(top, periodic_x),
          periodic_x,
          mirror_left};
}

inline Boundary Boundary::with_partly_open() const {
  Boundary all = *this;
  for (SideFaces* side : {&all.left, &all.right, &all.bottom, &all.top})
    for (double& open : side->open) open = open > 0 ? std::max(open, 0.5) : 0;
  return all;
}

inline bool Boundary::any_open() const {
  for (const SideFaces* s : {&left, &right, &bottom, &top})
    for (double open : s->open)
      if (open > 0) return true;
  return false;
}

/// Wraps one row of a periodic field; `period` cells, one value repeated beyond it on faces.
template <class T>
void wrap_row(T* row, int period) {
  row[-1] = row[period - 1];
  row[-2] = row[period - 2];
  row[period] = row[0];
  row[period + 1] = row[1];
}

/// Reflects one row of cells about its left end.
template <class T>
void mirror_row(T* row, int cells) {
  row[-1] = row[0];
  row[-2] = row[std::min(1, cells - 1)];
}

/// Halo of one row of cells beyond such ends; elsewhere it stays as it is.
template <class T>
void fill_ends(Ends ends, T* row, int cells) {
  if (ends.periodic) wrap_row(row, cells);
  if (ends.mirror) mirror_row(row, cells);
}

/// Halo of a velocity for advection and strain rates, two layers: ghost_factor * inside for the tangential
/// component, zero gradient for the normal one, wrapped where periodic. Call from one member.
inline void fill_velocity_halo(const Boundary& b, XFaceField& u, YFaceField& v) {
  const int nx = u.patch().nx, ny = u.patch().ny;
  for (int j = 0; j < ny; ++j) {
    double* r = u.row(j);
    if (b.periodic_x) {
      r[nx] = r[0];
      wrap_row(r, nx);
      r[nx + 2] = r[2 % nx];
    } else {
      r[-1] = b.mirror_left ? -r[1] : r[0];
      r[-2] = b.mirror_left ? -r[std::min(2, nx)] : r[0];
      r[nx + 1] = r[nx + 2] = r[nx];
    }
  }
  for (int j = 0; j <= ny; ++j) {
    double* r = v.row(j);
    r[-1] = r[-2] = ghost_factor(b.left.shear[j]) * r[0];
    r[nx] = r[nx + 1] = ghost_factor(b.right.shear[j]) * r[nx - 1];
    fill_ends(b.ends(), r, nx);
  }
  for (int i = -halo; i <= nx + halo; ++i) {
    const int k = b.periodic_x ? (i + 2 * nx) % nx : i < 0 ? (b.mirror_left ? -i : 0) : i > nx ? nx : i;
    u(i, -1) = u(i, -2) = ghost_factor(b.bottom.shear[k]) * u(i, 0);
    u(i, ny) = u(i, ny + 1) = ghost_factor(b.top.shear[k]) * u(i, ny - 1);
  }
  for (int i = -halo; i < nx + halo; ++i) {
    v(i, -1) = v(i, -2) = v(i, 0);
    v(i, ny + 1) = v(i, ny + 2) = v(i, ny);
  }
}

/// Halo of a cell field, two layers: copies of the edge cell, or wrapped where periodic.
template <class T>
void fill_cell_halo(const Boundary& b, CellFieldOf<T>& c) {
  const int nx = c.patch().nx, ny = c.patch().ny;
  for (int j = 0; j < ny; ++j) {
    T* r = c.row(j);
    for (int k = 1; k <= halo; ++k) {
      r[-k] = r[0];
      r[nx - 1 + k] = r[nx - 1];
    }
    fill_ends(b.ends(), r, nx);
  }
  for (int k = 1; k <= halo; ++k)
    for (int i = -halo; i < nx + halo; ++i) {
      c(i, -k) = c(i, 0);
      c(i, ny - 1 + k) = c(i, ny - 1);
    }
}

}  // namespace hourglass
