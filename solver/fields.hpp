#pragma once
// Everything that evolves from step to step; allocated once.
#include <cmath>
#include <vector>

#include "kernels/geometry.hpp"

namespace hourglass {

/// The velocity, u on x-faces and v on y-faces [L/T], solenoidal, and what goes with it.
struct Fields : Velocity {
  CellField p;       ///< pressure in cells [M/T^2]
  CellField grains;  ///< share of the cell filled by grains of any material, in [0, 1]
  std::vector<CellField>
      tracers;         ///< [k]: share of the cell filled by material k + 1; empty for one material
  CellField fluidity;  ///< granular fluidity g = P/eta [1/T]; only with physics.nonlocal
  /// Only with physics.dilatancy: share of the cell filled at the packing phi_max, of all grains [0] and of
  /// material k [k]: their volumes times phi / phi_max.
  std::vector<CellField> solid;

  explicit Fields(const Patch& patch, int materials, bool nonlocal = false, bool dilatant = false)
      : Velocity(patch), p(patch), grains(patch), tracers(materials - 1, CellField(patch)),
        solid(dilatant ? materials : 0, CellField(patch)) {
    if (nonlocal) fluidity = CellField(patch);
  }
};

/// At a cell's centre [L/T].
inline double cell_speed(const Fields& f, int i, int j) {
  const double u = 0.5 * (f.u(i, j) + f.u(i + 1, j)), v = 0.5 * (f.v(i, j) + f.v(i, j + 1));
  return std::sqrt(u * u + v * v);
}

/// Shares of grains and tracers in the cells of solids (fill_solid). Call from one member.
inline void fill_solid_shares(const Geometry& geometry, Fields& fields) {
  fill_solid(geometry, fields.grains);
  for (CellField& tracer : fields.tracers) fill_solid(geometry, tracer);
}

}  // namespace hourglass
