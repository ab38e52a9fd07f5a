#pragma once
// Evenly spaced streamlines in the plane: Jobard & Lefer 1997, Visualization in Scientific Computing '97, 43-55.
#include <array>
#include <functional>
#include <vector>

#include "kernels/polygon.hpp"

namespace hourglass {

using Point = std::array<double, 2>;

struct StreamlineField {
  double width = 0, height = 0;                 ///< lines stay in [0, width] x [0, height]
  std::function<Point(const Point&)> velocity;  ///< asked for inside only
  std::function<bool(const Point&)> flows;      ///< lines end where not
  double least_speed = 0;                       ///< and where it is slower
};

/// Lines about `spacing` apart, nowhere closer than half of it, along the flow. Each is a row of points.
std::vector<Polygon> streamlines(const StreamlineField& field, double spacing);

}  // namespace hourglass
