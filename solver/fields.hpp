#pragma once
// Everything that evolves from step to step; allocated once.
#include <vector>

#include "kernels/field.hpp"

namespace hourglass {

struct Fields {
  XFaceField u;      ///< x-velocity on x-faces [L/T], solenoidal with v
  YFaceField v;      ///< y-velocity on y-faces [L/T]
  CellField p;       ///< pressure in cells [M/T^2]
  CellField grains;  ///< share of the cell filled by grains of any material, in [0, 1]
  std::vector<CellField>
      tracers;  ///< [k]: share of the cell filled by material k + 1; empty for one material

  explicit Fields(const Patch& patch, int materials)
      : u(patch), v(patch), p(patch), grains(patch), tracers(materials - 1, CellField(patch)) {}

  const Patch& patch() const { return p.patch(); }
};

}  // namespace hourglass
