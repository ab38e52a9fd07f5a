#include "solver/solids.hpp"

#include <cmath>

namespace hourglass {

Polygon outline_of(const Insert& s) {
  const auto [x, y] = s.centre;
  const double a = 0.5 * s.width, b = 0.5 * (s.shape == Shape::square ? s.width : s.height);
  switch (s.shape) {
    case Shape::square:
    case Shape::rectangle:
      return {{x - a, y - b}, {x + a, y - b}, {x + a, y + b}, {x - a, y + b}};
    case Shape::diamond:
      return {{x, y - b}, {x + a, y}, {x, y + b}, {x - a, y}};
    case Shape::triangle_up:
      return {{x - a, y - b}, {x + a, y - b}, {x, y + b}};
    case Shape::triangle_down:
      return {{x, y - b}, {x + a, y + b}, {x - a, y + b}};
    case Shape::circle: {
      constexpr int corners = 720;  // a multiple of 8: as symmetric as the circle on a square grid
      const double step = 2 * M_PI / corners, radius = a * std::sqrt(step / std::sin(step));
      Polygon circle;
      for (int k = 0; k < corners; ++k)
        circle.push_back({x + radius * std::cos((k + 0.5) * step), y + radius * std::sin((k + 0.5) * step)});
      return circle;
    }
    case Shape::polygon:
      break;
  }
  return {s.points.begin(), s.points.end()};
}

std::vector<Polygon> solids_of(const Scene& scene) {
  std::vector<Polygon> solids;
  for (const Insert& insert : scene.inserts) solids.push_back(outline_of(insert));
  return solids;
}

}  // namespace hourglass
