#pragma once
// The two components of a staggered vector, and the row-by-row view that Krylov methods take of any unknown.
#include <algorithm>

#include "kernels/field.hpp"
#include "kernels/team.hpp"

namespace hourglass {

/// A vector field on the faces of a patch.
template <class T>
struct VelocityOf {
  XFaceFieldOf<T> u;
  YFaceFieldOf<T> v;

  VelocityOf() = default;
  explicit VelocityOf(const Patch& p) : u(p), v(p) {}
  std::size_t bytes() const { return u.bytes() + v.bytes(); }
  const Patch& patch() const { return u.patch(); }
  void fill(T value) {
    u.fill(value);
    v.fill(value);
  }
};
using Velocity = VelocityOf<double>;

/// Rows of an unknown, all components: what Team::rows shares out and RowSums is sized by. The rows of u and
/// v alternate, so that a member's share of both is one slab of the patch.
template <class T>
int row_count(const CellFieldOf<T>& f) {
  return f.ny();
}
template <class T>
int row_count(const VelocityOf<T>& f) {
  return f.u.ny() + f.v.ny();
}

template <class T>
struct Row {
  T* data;  ///< data[0 .. n-1]
  int n;
};

template <class T>
Row<T> row_of(CellFieldOf<T>& f, int k) {
  return {f.row(k), f.nx()};
}
template <class T>
Row<const T> row_of(const CellFieldOf<T>& f, int k) {
  return {f.row(k), f.nx()};
}
template <class T>
Row<T> row_of(VelocityOf<T>& f, int k) {
  if (k % 2 == 0 && k / 2 < f.u.ny()) return {f.u.row(k / 2), f.u.nx()};
  return {f.v.row(k / 2), f.v.nx()};
}
template <class T>
Row<const T> row_of(const VelocityOf<T>& f, int k) {
  if (k % 2 == 0 && k / 2 < f.u.ny()) return {f.u.row(k / 2), f.u.nx()};
  return {f.v.row(k / 2), f.v.nx()};
}

/// Red-black colours of a row: point i of row j has colour (i + j) mod 2, counted from the nearer end of the row, so that
/// a mirrored problem is smoothed in mirrored order and keeps its symmetry to rounding. In rows with an even number of
/// points the two at the middle share a colour; they are updated at once from each other's old value.
struct ColourOfRow {
  int half, left,
      right;  ///< points i < half have the colour where (i & 1) == left, the others where (i & 1) == right
  ColourOfRow(int n, int j, int colour)
      : half(n % 2 == 0 ? n / 2 : n), left((colour + j) & 1), right(n % 2 == 0 ? 1 - left : left) {}
};

/// Takes over the updated values of one colour: out[i] = updated[i] where i has it.
template <class T>
void take_colour(const T* __restrict updated, int n, int j, int colour, T* __restrict out) {
  const ColourOfRow c(n, j, colour);
#pragma omp simd
  for (int i = 0; i < c.half; ++i) out[i] = (i & 1) == c.left ? updated[i] : out[i];
#pragma omp simd
  for (int i = c.half; i < n; ++i) out[i] = (i & 1) == c.right ? updated[i] : out[i];
}

/// Gauss-Seidel on one colour from x = 0: out[i] = b[i] / diagonal where i has the colour, else 0. (The two loops of
/// take_colour by a common loop over a lambda: this one then was no longer vector code, the descent 1.5 times as slow.)
template <class T>
void start_colour(const T* __restrict b, const T* __restrict inverse_diagonal, int n, int j, int colour,
                  T* __restrict out) {
  const ColourOfRow c(n, j, colour);
#pragma omp simd
  for (int i = 0; i < c.half; ++i) out[i] = T((i & 1) == c.left) * (b[i] * inverse_diagonal[i]);
#pragma omp simd
  for (int i = c.half; i < n; ++i) out[i] = T((i & 1) == c.right) * (b[i] * inverse_diagonal[i]);
}

/// Sets the points around the patch to 0, as the viscous operator wants them, on the rows of this member. Sync after.
template <class T>
void clear_halo(Team& team, VelocityOf<T>& w) {
  const int ny = w.patch().ny;
  const auto clear = [](auto& f, int j) {
    T* row = f.row(j);
    if (j < 0 || j >= f.ny()) {
      std::fill(row - halo, row + f.nx() + halo, T(0));
    } else {
      for (int k = 1; k <= halo; ++k) row[-k] = row[f.nx() - 1 + k] = T(0);
    }
  };
  const Rows rows = team.rows(ny + 1 + 2 * halo);
  for (int j = rows.begin - halo; j < rows.end - halo; ++j) {
    if (j < ny + halo) clear(w.u, j);
    clear(w.v, j);
  }
}

/// The same unknown with another number type.
template <class Unknown, class T>
struct Rebind;
template <At where, class S, class T>
struct Rebind<Field<where, S>, T> {
  using type = Field<where, T>;
};
template <class S, class T>
struct Rebind<VelocityOf<S>, T> {
  using type = VelocityOf<T>;
};
template <class Unknown, class T>
using rebind_t = typename Rebind<Unknown, T>::type;

}  // namespace hourglass
