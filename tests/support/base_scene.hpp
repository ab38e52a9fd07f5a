#pragma once
// The thesis's base scene, built in C++: 150 d x 150 d, filled to 135 d, one orifice in the floor.
#include "solver/simulation.hpp"

namespace hourglass::test {

inline Fill box(double x0, double x1, double y0, double y1, int material = 0) {
  return {material, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}};
}

inline Scene base_scene(int cells, double end, double orifice_centre = 75, double orifice_width = 18.75) {
  Scene s;
  s.cells_x = cells;
  s.fill = {box(0, 150, 0, 135)};
  s.orifices = {{Side::bottom, orifice_centre, orifice_width}};
  s.time.end = end;
  s.output.series_every = s.output.fields_every = s.output.snapshots_every = 0;
  s.threads = 1;
  return s;
}

/// One code unit of discharge in grain units (docs/accuracy.md).
inline constexpr double code_unit = 164.3;

}  // namespace hourglass::test
