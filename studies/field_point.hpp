#pragma once
// What stored fields are at a place, which need not be the centre of a cell.
#include <string>
#include <vector>

#include "kernels/geometry.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// A place in the silo. Stored values are those at the centres of cells; between them they are interpolated bilinearly, over
/// those of the four cells around that hold what is asked for. Beyond a left edge that is the middle of the silo lies the
/// image of what is computed, beyond a periodic side its other end; within half a cell of any other side the value is that
/// of the nearest centres.
class FieldPoint {
 public:
  /// geometry: nullptr, or that of the scene. Throws std::invalid_argument for a place outside of the silo.
  FieldPoint(const Scene& scene, const Geometry* geometry, double x, double y);

  double x() const { return x_; }
  double y() const { return y_; }
  /// NaN in a solid and, but for the field `grains`, in a cell of which grains fill less than half.
  double value(const std::string& field, const CellField& values, const CellField& grains) const;

 private:
  struct Cell {
    int i, j;
    double weight;
    bool image;  ///< at the left edge
  };
  double x_, y_;
  std::vector<Cell> cells_;  ///< open ones; the first one holds the place; none in a solid
};

}  // namespace hourglass
