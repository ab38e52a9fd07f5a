#pragma once
// How far a flow is from the mirror image of another.
#include <algorithm>
#include <cmath>

#include "solver/fields.hpp"

namespace hourglass {

/// L1 distance of v to the mirror image of `other`, over the L1 norm of v: inside the phase of cells with at least this
/// share of grains.
inline double asymmetry(const Fields& f, const Fields& other, double grains = 0.999) {
  const int nx = f.p.nx(), ny = f.p.ny();
  double difference = 0, size = 0;
  for (int j = 1; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (std::min(f.grains(i, j), f.grains(i, j - 1)) < grains) continue;
      difference += std::abs(f.v(i, j) - other.v(nx - 1 - i, j));
      size += std::abs(f.v(i, j));
    }
  return difference / size;
}

}  // namespace hourglass
