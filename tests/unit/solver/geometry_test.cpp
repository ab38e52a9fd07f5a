// What solids, orifices within faces, an axis and a mirror plane make of the cells and faces of a scene.
#include "solver/geometry.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "solver/boundary_of.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// 16 x 12 cells of side 1, an orifice in the floor that ends on grid lines, the top open.
Scene scene() {
  Scene s;
  s.width = 16;
  s.height = 12;
  s.cells_x = 16;
  s.orifices = {{Side::bottom, 8, 4}};
  return s;
}

Insert box(double x0, double x1, double y0, double y1) {
  Insert insert;
  insert.shape = Shape::rectangle;
  insert.centre = {0.5 * (x0 + x1), 0.5 * (y0 + y1)};
  insert.width = x1 - x0;
  insert.height = y1 - y0;
  return insert;
}

std::unique_ptr<Geometry> geometry_of(const Scene& s) { return geometry_of(s, boundary_of(s)); }
std::unique_ptr<Geometry> with(std::vector<Insert> inserts) {
  Scene s = scene();
  s.inserts = std::move(inserts);
  return geometry_of(s);
}

double open_cells(const Geometry& g) {
  double sum = 0;
  for (int j = 0; j < g.volume.ny(); ++j)
    for (int i = 0; i < g.volume.nx(); ++i) sum += g.open_share(i, j);
  return sum;
}

}  // namespace

TEST_CASE("a scene without solids, on whole faces, has no geometry") {
  CHECK(geometry_of(scene()) == nullptr);
  CHECK(geometry_of(silo(64)) == nullptr);
  Scene s = scene();
  s.symmetry = Symmetry::mirror;
  s.walls[0] = Wall::free_slip;
  s.orifices[0].centre = 0;
  CHECK(geometry_of(s) == nullptr);
  s = scene();
  s.walls[0] = s.walls[1] = Wall::periodic;
  CHECK(geometry_of(s) == nullptr);
  s.orifices[0].centre = 8 + 1e-9;  // rounding of a scene file
  CHECK(geometry_of(s) == nullptr);
  s.orifices[0].centre = 8.25;
  CHECK(geometry_of(s) != nullptr);
  CHECK(with({box(3, 5, 6, 8)}) != nullptr);
}

TEST_CASE("a wall on grid lines is the wall of a domain: shear weight 2") {
  const auto g = with({box(3, 9, 5, 8)});
  for (int i : {4, 5, 6, 7, 8}) {  // over the top and under the bottom, away from the ends
    CHECK(g->corner_volume(i, 8) == 0.5);
    CHECK(g->wall.u(i, 8) == Approx(1.5));
    CHECK(g->corner_volume(i, 5) == 0.5);
    CHECK(g->wall.u(i, 4) == Approx(1.5));
    CHECK(g->wall.u(i, 9) == 0);
  }
  CHECK(g->wall.v(2, 6) == Approx(1.5));
  CHECK(g->wall.v(9, 7) == Approx(1.5));
  CHECK(g->wall.v(10, 7) == 0);
  for (int i = 3; i < 9; ++i) {
    CHECK(g->volume(i, 6) == 0);
    CHECK(g->aperture.v(i, 8) == 0);
    CHECK(g->volume(i, 8) == 1);
    CHECK(g->wall_area(i, 8) == 1);
    CHECK(g->wall_area(i, 9) == 0);
  }
  CHECK(open_cells(*g) == 16 * 12 - 18);
}

TEST_CASE("a wall within cells lets a plane shear flow along it stand") {
  for (double share : {0.9, 0.7, 0.5, 0.3, 0.1}) {
    const auto g = with({box(3, 9, 5, 9 - share)});
    INFO("open share of the cut cells " << share);
    CHECK(g->volume(6, 8) == Approx(share));
    CHECK(g->aperture.u(6, 8) == Approx(share));
    CHECK(g->aperture.v(6, 8) == 0);
    CHECK(g->wall_area(6, 8) == Approx(1));
    // u = distance to the wall, mean over the open part of a face; forces of shear above, below, of the wall.
    const auto force = [&](int j) {
      const auto u = [&](int k) { return k == 8 ? 0.5 * share : k - 8.5 + share; };
      const double up = g->corner_volume(6, j + 1) * (u(j) - u(j + 1));
      const double down = g->corner_volume(6, j) * (u(j) - (j > 8 ? u(j - 1) : 0));
      return up + down + g->wall.u(6, j) * u(j);
    };
    CHECK(force(8) == Approx(0).margin(1e-12));
    CHECK(force(9) == Approx(0).margin(1e-12));
    CHECK(force(10) == Approx(0).margin(1e-12));
  }
}

TEST_CASE("inclined walls let a plane shear flow along them stand") {
  // The operator with eta = 1 on u = t d, d the distance from the wall, mean over the open part of a face.
  int faces = 0, unbalanced = 0;
  double worst = 0;
  for (double degrees : {15.0, 30.0, 45.0, 60.0, 75.0, -20.0, 160.0}) {
    const double nx = -std::sin(degrees * M_PI / 180), ny = std::cos(degrees * M_PI / 180);
    const double cx = 8.03, cy = 6.1;
    Insert below;
    below.shape = Shape::polygon;
    for (const auto& [along, behind] : {std::array{-30., 0.}, {-30., 30.}, {30., 30.}, {30., 0.}})
      below.points.push_back({cx + along * ny - behind * nx, cy - along * nx - behind * ny});
    const auto g = with({below});
    const auto mean_distance = [&](double x, double y,
                                   double change) {  // of a unit segment that is cut or not
      const double d = (x - cx) * nx + (y - cy) * ny, high = d + 0.5 * std::abs(change);
      return d - 0.5 * std::abs(change) >= 0 ? d : 0.5 * std::max(high, 0.0);
    };
    const auto u = [&](int i, int j) {
      return g->aperture.u(i, j) > 0 ? ny * mean_distance(i, j + 0.5, ny) : 0;
    };
    const auto v = [&](int i, int j) {
      return g->aperture.v(i, j) > 0 ? -nx * mean_distance(i + 0.5, j, nx) : 0;
    };
    const auto look = [&](double speed, double force, double wall) {
      ++faces;
      const double rest = std::abs(force + wall * speed);
      if (rest > 1e-9) ++unbalanced;
      if (std::abs(speed) > 0.01) worst = std::max(worst, rest);
    };
    const CornerField& c = g->corner_volume;
    const CellField& V = g->volume;
    for (int j = 3; j < 9; ++j)
      for (int i = 3; i < 13; ++i) {
        if (g->aperture.u(i, j) > 0)
          look(u(i, j),
               2 * V(i, j) * (u(i, j) - u(i + 1, j)) + 2 * V(i - 1, j) * (u(i, j) - u(i - 1, j)) +
                   c(i, j + 1) * ((u(i, j) - u(i, j + 1)) - (v(i, j + 1) - v(i - 1, j + 1))) +
                   c(i, j) * ((u(i, j) - u(i, j - 1)) + (v(i, j) - v(i - 1, j))),
               g->wall.u(i, j));
        if (g->aperture.v(i, j) > 0)
          look(v(i, j),
               2 * V(i, j) * (v(i, j) - v(i, j + 1)) + 2 * V(i, j - 1) * (v(i, j) - v(i, j - 1)) +
                   c(i + 1, j) * ((v(i, j) - v(i + 1, j)) - (u(i + 1, j) - u(i + 1, j - 1))) +
                   c(i, j) * ((v(i, j) - v(i - 1, j)) + (u(i, j) - u(i, j - 1))),
               g->wall.v(i, j));
      }
  }
  INFO(faces << " faces, " << unbalanced << " where walls would have to push, force left at most " << worst);
  CHECK(faces > 300);
  CHECK(unbalanced < 0.02 * faces);
  CHECK(worst < 0.02);
}

TEST_CASE("parts that no face joins to an opening become solid; in a closed box all but the largest") {
  // a ring around 4 x 3 cells
  std::vector<Insert> ring{box(2, 8, 3, 4), box(2, 8, 7, 8), box(2, 3, 3, 8), box(7, 8, 3, 8)};
  CHECK(open_cells(*with(ring)) == 16 * 12 - 6 * 5);
  ring.back() = box(7, 8, 5, 8);  // a gate
  CHECK(open_cells(*with(ring)) == 16 * 12 - 6 * 5 + 12 + 1);

  Scene closed = scene();
  closed.orifices.clear();
  closed.walls[static_cast<int>(Side::top)] = Wall::no_slip;
  closed.inserts = {box(0, 16, 4, 5)};
  CHECK(open_cells(*geometry_of(closed)) == 16 * 7);
  closed.inserts = {box(0, 16, 7, 8)};
  CHECK(open_cells(*geometry_of(closed)) == 16 * 7);
  closed.orifices = {{Side::bottom, 8, 4}};
  closed.inserts = {box(0, 16, 4, 5)};
  CHECK(open_cells(*geometry_of(closed)) == 16 * 4);  // the part with the orifice

  // around the ends of a periodic domain
  closed.walls[0] = closed.walls[1] = Wall::periodic;
  closed.inserts = {box(4, 5, 0, 12), box(11, 12, 0, 12)};
  CHECK(open_cells(*geometry_of(closed)) == 6 * 12);
  closed.orifices = {{Side::bottom, 2, 2}};
  CHECK(open_cells(*geometry_of(closed)) == 8 * 12);
}

TEST_CASE("slivers are closed, and faces beside them") {
  const auto g = with({box(3, 9, 5, 7.995)});
  for (int i = 3; i < 9; ++i) {
    CHECK(g->volume(i, 7) == 0);
    CHECK(g->aperture.u(i, 7) == 0);
    CHECK(g->aperture.v(i, 8) == 0);
    CHECK(g->inverse_volume(i, 7) == 0);
  }
  CHECK(g->wall.u(6, 8) > 1);  // still a wall
}

TEST_CASE("cells and faces in a solid follow what is beside them") {
  const auto g = with({box(3, 9, 5, 8)});
  CHECK(g->ghosts.size() == 6 * 3 - 4);  // all but the inner 4 x 1
  CellField f(scene().patch());
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 16; ++i) f(i, j) = 10 * j;
  fill_solid(*g, f);
  CHECK(f(5, 7) == 80);  // from the row above
  CHECK(f(5, 5) == 40);
  CHECK(f(3, 6) == 60);  // from the column at the left
  CHECK(f(3, 7) == Approx((3 * 80 + 70 + 60) / 5.0));
  CHECK(f(5, 6) == 60);  // touches nothing open: as it was

  Velocity w(scene().patch());
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i <= 16; ++i) w.u(i, j) = j >= 8 ? j - 7.5 : 0;  // u = distance to the top side
  fill_solid(*g, w);
  CHECK(w.u(6, 7) == Approx(-0.5));  // through 0 at the wall
  CHECK(w.u(6, 6) == 0);
}

TEST_CASE("around an axis volumes add up to those of rings") {
  Scene s = scene();
  s.coordinates = Coordinates::axisymmetric;
  s.walls[0] = Wall::free_slip;
  s.orifices = {{Side::bottom, 0, 8}};
  const auto volume = [&] {
    const auto g = geometry_of(s);
    double sum = 0;
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 16; ++i) sum += g->volume(i, j);
    return sum * s.copies();
  };
  const double whole = M_PI * 16 * 16 * 12;
  CHECK(volume() == Approx(whole).epsilon(1e-13));
  const auto g = geometry_of(s);
  CHECK(g->axisymmetric);
  for (int j = 0; j < 12; ++j) {
    CHECK(g->aperture.u(0, j) == 0);
    CHECK(g->aperture.u(4, j) == Approx(4.0 / 16));
    CHECK(g->open_share(3, j) == Approx(1));
  }
  double orifice = 0;
  for (int i = 0; i < 16; ++i) orifice += g->aperture.v(i, 0);
  CHECK(orifice * s.copies() == Approx(M_PI * 4 * 4));

  s.inserts = {box(5, 8, 3, 7)};  // a ring on grid lines
  CHECK(volume() == Approx(whole - M_PI * (64 - 25) * 4));
  s.inserts = {box(-8, 5, 3.3, 7.1)};  // a disc
  CHECK(volume() == Approx(whole - M_PI * 25 * 3.8));
}

TEST_CASE("staircase: whole cells where solids cover more than half") {
  Scene s = scene();
  s.accuracy.solids = SolidModel::staircase;
  s.inserts = {box(3.2, 9.2, 5.8, 8.8)};
  auto g = geometry_of(s);
  CHECK(open_cells(*g) == 16 * 12 - 18);  // [3, 9] x [6, 9]
  for (int i = 3; i < 9; ++i)
    for (int j = 6; j < 9; ++j) CHECK(g->volume(i, j) == 0);
  Insert circle;
  circle.centre = {8, 6};
  circle.width = circle.height = 7;
  s.inserts = {circle};
  g = geometry_of(s);
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 16; ++i) CHECK((g->volume(i, j) == 0 || g->volume(i, j) == 1));
  CHECK(open_cells(*g) == Approx(192 - M_PI * 3.5 * 3.5).margin(7));
}

TEST_CASE("an orifice that ends within faces opens them in part") {
  Scene s = scene();
  s.orifices = {{Side::bottom, 8.25, 4}, {Side::right, 6, 1.5}};
  const Boundary boundary = boundary_of(s);
  const auto g = geometry_of(s);
  const double bottom[] = {0, 0.75, 1, 1, 1, 0.25, 0};
  for (int i = 5; i < 12; ++i) CHECK(g->aperture.v(i, 0) == Approx(bottom[i - 5]).margin(1e-12));
  CHECK(g->aperture.u(16, 5) == Approx(0.75));
  CHECK(g->aperture.u(16, 6) == Approx(0.75));
  CHECK(g->aperture.u(0, 5) == 0);
  CHECK(open_cells(*g) == 16 * 12);
  CHECK(shares_of(s.orifices[0], boundary, s.patch()).size() == 5);

  s.orifices = {{Side::bottom, 6.25, 3.5}, {Side::bottom, 9, 2}};  // they meet in a face: 4.5 to 8, 8 to 10
  for (const OpenFace& f : shares_of(s.orifices[1], boundary_of(s), s.patch())) CHECK(f.open == 1);
  s.orifices = {{Side::bottom, 6.15, 3.3}, {Side::bottom, 8.9, 2.2}};  // meet at 7.8
  const auto left = shares_of(s.orifices[0], boundary_of(s), s.patch());
  const auto right = shares_of(s.orifices[1], boundary_of(s), s.patch());
  CHECK(left.back().face == 7);
  CHECK(left.back().open == Approx(0.8));
  CHECK(right.front().face == 7);
  CHECK(right.front().open == Approx(0.2));
}

TEST_CASE("half of a mirrored scene has half of its geometry") {
  Insert circle, diamond, square;
  circle.centre = {8, 6.3};
  circle.width = circle.height = 5;
  diamond = circle;
  diamond.shape = Shape::diamond;
  square = circle;
  square.shape = Shape::square;
  for (const Insert& insert : {circle, diamond, square}) {
    Scene whole = scene(), half = whole;
    whole.inserts = half.inserts = {insert};
    half.symmetry = Symmetry::mirror;
    half.width = 8;
    half.cells_x = 8;
    half.orifices[0].centre = half.inserts[0].centre[0] = 0;
    const auto a = geometry_of(whole), b = geometry_of(half);
    INFO(shape_names[static_cast<int>(insert.shape)]);
    double worst = 0;
    const auto compare = [&](const auto& of_whole, const auto& of_half, const char* what) {
      for (int j = 0; j < of_half.ny(); ++j)
        for (int i = 0; i < of_half.nx(); ++i) {
          const double difference = std::abs(of_half(i, j) - of_whole(i + 8, j));
          if (difference > 1e-12)
            UNSCOPED_INFO(what << " " << i << ", " << j << ": " << of_half(i, j) << " instead of "
                               << of_whole(i + 8, j));
          worst = std::max(worst, difference);
        }
    };
    compare(a->volume, b->volume, "volume");
    compare(a->aperture.v, b->aperture.v, "aperture.v");
    compare(a->corner_volume, b->corner_volume, "corner_volume");
    compare(a->wall.v, b->wall.v, "wall.v");
    compare(a->wall_area, b->wall_area, "wall_area");
    CHECK(worst < 1e-12);
    for (int j = 0; j < 12; ++j)
      for (int i = 1; i <= 8; ++i) {
        CHECK(b->aperture.u(i, j) == Approx(a->aperture.u(i + 8, j)).margin(1e-12));
        INFO(i << ", " << j);
        CHECK(b->wall.u(i, j) == Approx(a->wall.u(i + 8, j)).margin(1e-12));
      }
  }
}

TEST_CASE("solids across the seam of a periodic scene are those of its middle, moved") {
  Insert circle, triangle;
  circle.centre = {8.2, 6.3};
  circle.width = circle.height = 5;
  triangle = circle;
  triangle.shape = Shape::triangle_up;
  for (const Insert& insert : {circle, triangle}) {
    Scene middle = scene(), seam = middle;
    middle.orifices.clear();
    middle.walls[0] = middle.walls[1] = Wall::periodic;
    middle.inserts = {insert};
    seam = middle;
    seam.inserts[0].centre[0] -= 8;
    seam.inserts.push_back(seam.inserts[0]);
    seam.inserts[1].centre[0] += 16;
    const auto a = geometry_of(middle), b = geometry_of(seam);
    double worst = 0;
    const auto compare = [&](const auto& of_middle, const auto& of_seam) {
      for (int j = 0; j < of_seam.ny(); ++j)
        for (int i = 0; i < 16; ++i) {
          const double difference = std::abs(of_seam(i, j) - of_middle((i + 8) % 16, j));
          if (difference > 1e-12) UNSCOPED_INFO(i << ", " << j << ": " << difference);
          worst = std::max(worst, difference);
        }
    };
    compare(a->volume, b->volume);
    compare(a->aperture.u, b->aperture.u);
    compare(a->aperture.v, b->aperture.v);
    compare(a->corner_volume, b->corner_volume);
    compare(a->wall.u, b->wall.u);
    compare(a->wall.v, b->wall.v);
    CHECK(worst < 1e-12);
    CHECK(a->ghosts.size() == b->ghosts.size());
    CHECK(a->ghost_u.size() == b->ghost_u.size());
    CHECK(a->ghost_v.size() == b->ghost_v.size());
  }
}
