#pragma once
// Boundaries of all kinds for tests of kernels, built face by face.
#include <algorithm>
#include <string>
#include <vector>

#include "kernels/boundary.hpp"

namespace hourglass {

inline constexpr double no_slip = 2, free_slip = 0;  // shear weights of a wall

inline SideFaces wall_side(int faces, double shear) {
  return {std::vector<double>(faces, 0.0), std::vector<double>(faces + 1, shear)};
}
inline SideFaces open_side(int faces) {
  return {std::vector<double>(faces, 1.0), std::vector<double>(faces + 1, 0.0)};
}
/// A wall with an opening over faces [first, last); its two edges carry the weight `edge`.
inline SideFaces pierced_side(int faces, double shear, int first, int last, double edge) {
  SideFaces s = wall_side(faces, shear);
  std::fill(s.open.begin() + first, s.open.begin() + last, 1.0);
  std::fill(s.shear.begin() + first, s.shear.begin() + last + 1, 0.0);
  if (first > 0) s.shear[first] = edge;
  if (last < faces) s.shear[last] = edge;
  return s;
}

struct NamedBoundary {
  std::string name;
  Boundary boundary;
};

/// Needs at least 6 cells each way.
inline std::vector<NamedBoundary> all_kinds_of_boundaries(int nx, int ny) {
  const auto walls = [&](double shear) {
    return Boundary{wall_side(ny, shear), wall_side(ny, shear), wall_side(nx, shear), wall_side(nx, shear),
                    false};
  };
  Boundary silo = walls(no_slip);
  silo.bottom = pierced_side(nx, no_slip, 2, 5, 1);
  silo.top = open_side(nx);
  Boundary holes{pierced_side(ny, no_slip, 1, 2, 0), pierced_side(ny, free_slip, 3, 5, 0),
                 pierced_side(nx, no_slip, 0, 1, 2), pierced_side(nx, no_slip, nx - 3, nx - 1, 1), false};
  Boundary channel = walls(no_slip);
  channel.periodic_x = true;
  Boundary sieve = channel;
  sieve.bottom = pierced_side(nx, no_slip, 1, 4, 1);
  sieve.top = open_side(nx);
  const Boundary open{open_side(ny), open_side(ny), open_side(nx), open_side(nx), false};
  return {{"no slip", walls(no_slip)},
          {"free slip", walls(free_slip)},
          {"silo", silo},
          {"holes on every side", holes},
          {"open", open},
          {"periodic channel", channel},
          {"periodic sieve", sieve}};
}

}  // namespace hourglass
