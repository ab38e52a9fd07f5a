#include "solver/boundary_of.hpp"

#include <catch2/catch.hpp>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// A scene of n x n cells with h = 1 and these orifices.
Scene square(int n, std::vector<Orifice> orifices) {
  Scene s;
  s.width = s.height = n;
  s.cells_x = n;
  s.orifices = std::move(orifices);
  return s;
}

using Faces = std::vector<double>;

}  // namespace

TEST_CASE("an orifice opens the faces between its edges, on any side") {
  const Patch p = square(8, {}).patch();
  CHECK(faces_of({Side::bottom, 4, 2}, p) == std::vector<OpenFace>{{3, 1}, {4, 1}});
  CHECK(faces_of({Side::left, 4, 8}, p).size() == 8);
  CHECK(faces_of({Side::right, 2.5, 1}, p) == std::vector<OpenFace>{{2, 1}});
  CHECK(faces_of({Side::top, 4, 1.9999999}, p) == std::vector<OpenFace>{{3, 1}, {4, 1}});
  CHECK(faces_of({Side::bottom, 4.25, 2}, p) == std::vector<OpenFace>{{3, 0.75}, {4, 1}, {5, 0.25}});
  CHECK(faces_of({Side::bottom, 0, 3}, p) == std::vector<OpenFace>{{0, 1}, {1, 0.5}});  // about a mirror plane

  const Boundary b = boundary_of(square(8, {{Side::bottom, 4, 2}, {Side::left, 6.5, 1}}));
  CHECK(b.bottom.open == Faces{0, 0, 0, 1, 1, 0, 0, 0});
  CHECK(b.left.open == Faces{0, 0, 0, 0, 0, 0, 1, 0});
  CHECK(b.top.open == Faces(8, 1));
  CHECK(b.any_open());
}

TEST_CASE("orifices that meet within a face share it; its corners stand between wall, edge and opening") {
  const Scene s = square(8, {{Side::bottom, 2.75, 1.5}, {Side::bottom, 4.5, 2}});  // to 3.5, and from there to 5.5
  const Boundary b = boundary_of(s);
  CHECK(b.bottom.open == Faces{0, 0, 1, 1, 1, 0.5, 0, 0});
  CHECK(shares_of(s.orifices[0], b, s.patch()) == std::vector<OpenFace>{{2, 1}, {3, 0.5}});
  CHECK(shares_of(s.orifices[1], b, s.patch()) == std::vector<OpenFace>{{3, 0.5}, {4, 1}, {5, 1}});
  CHECK(b.bottom.shear == Faces{2, 2, 1, 0, 0, 0.5, 1.5, 2, 2});
  CHECK(b.with_partly_open().bottom.open == Faces{0, 0, 1, 1, 1, 0.5, 0, 0});
}

TEST_CASE("shear weights: 2 on a no-slip wall, 0 where it slips or is open, the rule's at an edge") {
  Scene s = square(8, {{Side::bottom, 4, 2}});
  for (const auto& [rule, edge] :
       {std::pair{EdgeRule::half_wall, 1.0}, {EdgeRule::free, 0.0}, {EdgeRule::wall, 2.0}}) {
    s.rheology.orifice_edge = rule;
    CHECK(boundary_of(s).bottom.shear == Faces{2, 2, 2, edge, 0, edge, 2, 2, 2});
  }
  CHECK(boundary_of(s).top.shear == Faces(9, 0));
  s.walls[static_cast<int>(Side::bottom)] = Wall::free_slip;
  CHECK(boundary_of(s).bottom.shear == Faces(9, 0));
  s.orifices = {{Side::bottom, 1, 2}};  // at the end of the wall
  s.walls[static_cast<int>(Side::bottom)] = Wall::no_slip;
  CHECK(boundary_of(s).bottom.shear == Faces{0, 0, 2, 2, 2, 2, 2, 2, 2});
}

TEST_CASE("a closed box has no opening, a periodic one wraps") {
  Scene s = square(8, {});
  s.walls = {Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::no_slip};
  CHECK_FALSE(boundary_of(s).any_open());
  CHECK_FALSE(boundary_of(s).periodic_x);
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::no_slip};
  CHECK(boundary_of(s).periodic_x);
  CHECK_FALSE(boundary_of(s).any_open());
}

TEST_CASE("mirrored orifices make mirrored boundaries, on every level") {
  Boundary a = boundary_of(square(32, {{Side::bottom, 7, 3 * 2}, {Side::left, 20, 4}}));
  Boundary b = boundary_of(square(32, {{Side::bottom, 32 - 7, 3 * 2}, {Side::right, 20, 4}}));
  for (int level = 0; level < 4; ++level, a = a.coarser(), b = b.coarser()) {
    Faces open = a.bottom.open, shear = a.bottom.shear;
    std::reverse(open.begin(), open.end());
    std::reverse(shear.begin(), shear.end());
    CHECK(b.bottom.open == open);
    CHECK(b.bottom.shear == shear);
    CHECK(b.right.open == a.left.open);
  }
}

TEST_CASE(
    "velocity halos: mirrored with a change of sign at no-slip walls, copied where it slips or is open") {
  Scene s = square(8, {{Side::bottom, 4, 2}});
  s.rheology.orifice_edge = EdgeRule::free;
  const Boundary b = boundary_of(s);
  XFaceField u(s.patch(), 1.0);
  YFaceField v(s.patch(), 1.0);
  fill_velocity_halo(b, u, v);
  for (int i = 0; i <= 8; ++i) CHECK(u(i, -1) == (i >= 3 && i <= 5 ? 1 : -1));
  for (int i = 0; i <= 8; ++i) CHECK(u(i, 8) == 1);
  for (int j = 0; j < 8; ++j) CHECK((v(-1, j) == -1 && v(8, j) == -1 && v(-2, j) == -1));
  for (int i = 0; i < 8; ++i) CHECK((v(i, -1) == 1 && v(i, 9) == 1));
}

TEST_CASE(
    "one projection of noise is solenoidal: orifices of one cell and none, closed, periodic, on odd grids") {
  for (int n : {16, 20, 33}) {
    for (const auto& walls : {std::array{Wall::no_slip, Wall::no_slip, Wall::no_slip, Wall::open},
                              std::array{Wall::no_slip, Wall::free_slip, Wall::no_slip, Wall::no_slip},
                              std::array{Wall::periodic, Wall::periodic, Wall::no_slip, Wall::open},
                              std::array{Wall::open, Wall::open, Wall::open, Wall::open}}) {
      Scene s = square(n, {{Side::bottom, 5.5, 1}});
      s.fill = {fill_box(0, 0, n, 0, 0.7 * n)};
      s.walls = walls;
      s.threads = 1;
      const SolveStats stats = project_noise(s);
      INFO(n << " cells, left " << wall_names[static_cast<int>(walls[0])] << ", top "
             << wall_names[static_cast<int>(walls[3])] << ": " << stats.final << " after "
             << stats.iterations);
      CHECK(stats.converged);
      CHECK(stats.final <= 1.01 * stats.tolerance);
      s.orifices.clear();
      CHECK(project_noise(s).converged);
    }
  }
}
