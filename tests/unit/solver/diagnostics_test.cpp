// Scales of a scene that its figures of merit are measured by.
#include <catch2/catch.hpp>

#include "solver/diagnostics.hpp"

using namespace hourglass;

TEST_CASE("discharge scale: rho sqrt(g) W^1.5 in a plane, W^2.5 around an axis") {
  Scene s;
  s.gravity = {0, -9};
  s.materials[0].density = 2;
  CHECK(discharge_scale(s, 4) == Approx(2 * 3 * 8));
  s.coordinates = Coordinates::axisymmetric;
  CHECK(discharge_scale(s, 4) == Approx(2 * 3 * 32));
}

TEST_CASE("total width: the whole silo's, an orifice in the middle of a mirrored one counts once") {
  Scene s;
  CHECK(total_width(s) == 0);
  s.orifices = {{Side::bottom, 0, 10}, {Side::bottom, 40, 6}, {Side::bottom, 1.5, 3}, {Side::right, 0.5, 1}};
  s.symmetry = Symmetry::mirror;
  CHECK(total_width(s) == 10 + 2 * (6 + 3 + 1));
  CHECK(images(s, s.orifices[0]) == 1);
  CHECK(images(s, s.orifices[1]) == 2);
  s.symmetry = Symmetry::none;
  CHECK(total_width(s) == 20);
  s.coordinates = Coordinates::axisymmetric;
  CHECK(total_width(s) == 10);
  s.orifices[0].wall = Side::top;
  CHECK(total_width(s) == 0);
}
