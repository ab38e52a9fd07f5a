#pragma once
// A Latin hypercube: along each axis every one of `points` equal slices holds exactly one point.
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace hourglass {

class LatinHypercube {
 public:
  LatinHypercube(int points, int axes, unsigned seed)
      : points_(points), slice_(axes, std::vector<int>(points)) {
    std::mt19937 random(seed);  // its values are fixed by the standard, those of distributions are not
    for (std::vector<int>& slices : slice_) {
      std::iota(slices.begin(), slices.end(), 0);
      for (int k = points - 1; k > 0; --k)
        std::swap(slices[k], slices[random() % static_cast<unsigned>(k + 1)]);
    }
  }
  /// Coordinate in (0, 1): the middle of its slice.
  double operator()(int point, int axis) const { return (slice_[axis][point] + 0.5) / points_; }

 private:
  int points_;
  std::vector<std::vector<int>> slice_;  // by axis, by point
};

}  // namespace hourglass
