#pragma once
// What solids, orifices off the grid and axisymmetric coordinates leave of a patch: shares of cells, faces and control
// volumes (docs/geometry.md). A scene that has none of them has no Geometry: everything is 1 and nothing is stored.
#include <array>
#include <vector>

#include "kernels/velocity.hpp"

namespace hourglass {

struct Geometry {
  /// V: open share of a cell, in axisymmetric coordinates times r/R; 0 in solids. The discrete equations are
  ///   V dc/dt + Σ A u (c) / h = 0,  Σ A u = 0.
  CellField volume;
  CellField inverse_volume;  ///< 1/V, 0 in solids
  /// A: open share of a face, times r/R; the face's velocity is the mean over the open part. 0 on walls, and beside a cell
  /// without volume, so that nothing leaks.
  Velocity aperture;
  Velocity inverse_aperture;  ///< 1/A, 0 on closed faces
  /// Open share of the control volume of a corner, of that part of it which lies in the patch; times r/R.
  CornerField corner_volume;
  /// Of a control volume of the momentum, its open share, at least half a control volume: advection must not overtake itself
  /// in a sliver, where walls hold everything anyway.
  Velocity inverse_inertia;
  /// Shear at solids, and the hoop stress: a force eta wall u against u, in the unit of the viscous operator [1].
  Velocity wall;
  /// Closed area of the cell's solid walls over h, times r/R; with axisymmetric coordinates it is that of solids alone.
  CellField wall_area;

  /// Cells of solid that touch open ones, and the open cells around each: what lies in a solid follows what is beside it.
  struct Ghost {
    int i, j;
    std::vector<std::array<int, 2>> beside;
  };
  std::vector<Ghost> ghosts;
  /// Closed faces beside open ones of their kind; their velocity continues that of the others linearly through 0 at the wall.
  struct GhostFace {
    struct Source {
      int i, j;
      double factor;
    };
    int i, j;
    std::vector<Source> from;
  };
  std::vector<GhostFace> ghost_u, ghost_v;

  bool axisymmetric = false;
  /// Of a cell, without r/R.
  double open_share(int i, int j) const {
    return axisymmetric ? volume(i, j) * volume.nx() / (i + 0.5) : volume(i, j);
  }

  std::size_t bytes() const {
    return volume.bytes() + inverse_volume.bytes() + aperture.bytes() + inverse_aperture.bytes() +
           inverse_inertia.bytes() + corner_volume.bytes() + wall.bytes() + wall_area.bytes();
  }
};

/// Sets a field in the cells of solids to the mean of the open cells around: reconstructions and slopes beside a solid then
/// see no jump. Call from one member.
inline void fill_solid(const Geometry& geometry, CellField& f) {
  for (const Geometry::Ghost& g : geometry.ghosts) {
    double sum = 0;
    for (const auto& [i, j] : g.beside) sum += f(i, j);
    f(g.i, g.j) = sum / static_cast<double>(g.beside.size());
  }
}

/// The same for velocities, for slopes and strain rates; A = 0 there, so no flux sees them. Call from one member.
inline void fill_solid(const Geometry& geometry, Velocity& w) {
  const auto fill = [](const std::vector<Geometry::GhostFace>& faces, auto& f) {
    for (const Geometry::GhostFace& g : faces) {
      double sum = 0;
      for (const auto& s : g.from) sum += s.factor * f(s.i, s.j);
      f(g.i, g.j) = sum;
    }
  };
  fill(geometry.ghost_u, w.u);
  fill(geometry.ghost_v, w.v);
}

}  // namespace hourglass
