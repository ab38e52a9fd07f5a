#pragma once
// A state to begin with in place of the fills: that of another run of the same domain, on any grid.
#include <vector>

#include "kernels/field.hpp"

namespace hourglass {

struct InitialState {
  CellField velocity_x, velocity_y;  ///< at cell centres [L/T]
  CellField pressure;                ///< [M/T^2]
  std::vector<CellField>
      shares;         ///< of the grains, then of materials 1, 2, ... in the open part of cells [1]
  CellField packing;  ///< phi [1]; not allocated: phi_max
};

/// Means over the cells of `to` of fields that are linear in each cell of theirs, with slopes limited so that no new
/// extremes arise (van Leer 1977, J. Comput. Phys. 23:276). The integral of each field over the domain, the same for both
/// grids, is kept to rounding; on an equal grid the fields are. shares[0] bounds the sum of the others, which stay above
/// 0.
std::vector<CellField> regrid(const std::vector<CellField>& shares, const Patch& to);
CellField regrid(const CellField& field, const Patch& to);

}  // namespace hourglass
