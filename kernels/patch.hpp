#pragma once
// A patch: a rectangle of square cells on a staggered (MAC) grid. Kernels see patches only; nothing in
// kernels/ knows whether a patch is the whole domain, one refined block of it, or a multigrid level.
//
//   corner(i,j+1)---yface(i,j+1)---corner(i+1,j+1)
//        |                              |
//    xface(i,j)      cell(i,j)      xface(i+1,j)
//        |                              |
//   corner(i,j)-----yface(i,j)-----corner(i+1,j)
//
// Extents: cells nx x ny; x-faces (nx+1) x ny; y-faces nx x (ny+1); corners (nx+1) x (ny+1).

namespace hourglass {

/// Layers of storage outside the patch on every side, for every field.
inline constexpr int halo = 2;

struct Patch {
  int nx = 0, ny = 0;     ///< cells in x and y
  double h = 1;           ///< cell side [L]
  double x0 = 0, y0 = 0;  ///< position of corner (0, 0) [L]

  double x_centre(int i) const { return x0 + (i + 0.5) * h; }
  double y_centre(int j) const { return y0 + (j + 0.5) * h; }
  double x_corner(int i) const { return x0 + i * h; }
  double y_corner(int j) const { return y0 + j * h; }
  long cells() const { return static_cast<long>(nx) * ny; }

  /// The patch with half the cells in each direction (nx and ny must be even).
  Patch coarser() const { return {nx / 2, ny / 2, 2 * h, x0, y0}; }
  bool operator==(const Patch&) const = default;
};

}  // namespace hourglass
