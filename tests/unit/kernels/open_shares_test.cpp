// Open shares of cells and faces: exact for straight sides, whatever overlaps, and consistent with each other.
#include "kernels/open_shares.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace hourglass;

namespace {

const Patch patch{10, 8, 0.5, -1, 2};  // x in [-1, 4], y in [2, 6]

Polygon box(double x0, double x1, double y0, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }
Polygon circle(double x, double y, double radius, int corners) {
  Polygon p;
  const double step = 2 * M_PI / corners, r = radius * std::sqrt(step / std::sin(step));
  for (int k = 0; k < corners; ++k)
    p.push_back({x + r * std::cos((k + 0.5) * step), y + r * std::sin((k + 0.5) * step)});
  return p;
}

double closed_area(const std::vector<Polygon>& solids, const Patch& on = patch) {
  const CellField open = open_volume(solids, on);
  double closed = 0;
  for (int j = 0; j < on.ny; ++j)
    for (int i = 0; i < on.nx; ++i) closed += 1 - open(i, j);
  return closed * on.h * on.h;
}

}  // namespace

TEST_CASE("nothing solid leaves everything open") {
  const CellField volume = open_volume({}, patch);
  const Velocity faces = open_faces({}, patch);
  for (int j = 0; j <= patch.ny; ++j)
    for (int i = 0; i <= patch.nx; ++i) {
      if (i < patch.nx && j < patch.ny) CHECK(volume(i, j) == 1);
      if (j < patch.ny) CHECK(faces.u(i, j) == 1);
      if (i < patch.nx) CHECK(faces.v(i, j) == 1);
    }
}

TEST_CASE("a box off the grid closes its share of every cell and face") {
  const double x0 = 0.13, x1 = 2.37, y0 = 3.21, y1 = 4.9;
  const std::vector<Polygon> solid{box(x0, x1, y0, y1)};
  const CellField volume = open_volume(solid, patch);
  const Velocity faces = open_faces(solid, patch);
  const auto covered = [&](double low, double high, double from) {
    return std::max(0.0, std::min(high, from + patch.h) - std::max(low, from)) / patch.h;
  };
  for (int j = 0; j <= patch.ny; ++j)
    for (int i = 0; i <= patch.nx; ++i) {
      const double x = patch.x_corner(i), y = patch.y_corner(j);
      const double in_x = covered(x0, x1, x), in_y = covered(y0, y1, y);
      INFO(i << ", " << j);
      if (i < patch.nx && j < patch.ny) CHECK(volume(i, j) == Approx(1 - in_x * in_y).margin(1e-13));
      if (j < patch.ny) CHECK(faces.u(i, j) == Approx(x > x0 && x < x1 ? 1 - in_y : 1).margin(1e-13));
      if (i < patch.nx) CHECK(faces.v(i, j) == Approx(y > y0 && y < y1 ? 1 - in_x : 1).margin(1e-13));
    }
}

TEST_CASE("areas are exact: diamond, triangle, circle, what sticks out, and unions of what overlaps") {
  const Polygon diamond{{1.5, 2.6}, {2.8, 4}, {1.5, 5.4}, {0.2, 4}};
  const Polygon triangle{{0.2, 2.3}, {3.1, 2.9}, {1.4, 5.7}};
  CHECK(closed_area({diamond}) == Approx(area(diamond)).epsilon(1e-13));
  CHECK(closed_area({triangle}) == Approx(area(triangle)).epsilon(1e-13));
  for (int cells : {1, 4, 16}) {
    const Patch fine{10 * cells, 8 * cells, 0.5 / cells, -1, 2};
    CHECK(closed_area({circle(1.5, 4, 1.23, 720)}, fine) == Approx(M_PI * 1.23 * 1.23).epsilon(1e-5));
  }
  CHECK(closed_area({box(-3, 0.3, 1, 2.7)}) == Approx(1.3 * 0.7));
  CHECK(closed_area({box(-3, -1.5, 1, 2.7)}) == 0);

  CHECK(closed_area({diamond, diamond}) == Approx(area(diamond)).epsilon(1e-13));
  const Polygon a = box(0.1, 1.7, 2.3, 4.1), b = box(1.2, 2.9, 3.3, 5.2), c = box(1.5, 2.2, 2.9, 3.9);
  const double both = 1.6 * 1.8 + 1.7 * 1.9 - 0.5 * 0.8;
  CHECK(closed_area({a, b}) == Approx(both).epsilon(1e-13));
  // c less what a and b have of it: 0.7 x 1.0 - 0.2 x 1.0 - 0.7 x 0.6 + 0.2 x 0.6
  CHECK(closed_area({a, b, c}) == Approx(both + 0.2).epsilon(1e-13));
  CHECK(closed_area({c, b, a}) == Approx(both + 0.2).epsilon(1e-13));
  const Polygon left{{0, 2.5}, {2, 2.5}, {2, 5}}, right{{2, 2.5}, {3, 2.5}, {2, 5}};  // they share a side
  CHECK(closed_area({left, right}) == Approx(2.5 + 1.25).epsilon(1e-13));
}

TEST_CASE("faces under several polygons are closed once") {
  const Velocity faces = open_faces({box(0.1, 1.7, 2.1, 2.35), box(0.9, 3, 2.2, 2.45)}, patch);
  CHECK(faces.u(4, 0) == Approx(1 - 0.35 / 0.5));  // x = 1
  CHECK(faces.u(3, 0) == Approx(0.5));             // x = 0.5: the first alone
  CHECK(faces.u(6, 0) == Approx(0.5));             // x = 2: the other
  CHECK(faces.u(9, 0) == 1);
}

TEST_CASE("a face along the side of a solid is closed, one that ends at it is not") {
  const std::vector<Polygon> solid{box(0, 1, 3, 4.25)};
  const CellField volume = open_volume(solid, patch);
  const Velocity faces = open_faces(solid, patch);
  for (int i : {2, 3, 4}) {  // x = 0, 0.5, 1: both sides and the middle
    CHECK(faces.u(i, 1) == 1);
    CHECK(faces.u(i, 2) == 0);
    CHECK(faces.u(i, 4) == 0.5);
  }
  CHECK(faces.u(1, 2) == 1);
  CHECK(faces.u(5, 2) == 1);
  for (int i : {1, 2, 3, 4}) {
    CHECK(faces.v(i, 2) == (i == 2 || i == 3 ? 0 : 1));  // y = 3
    CHECK(faces.v(i, 5) == 1);                           // above the top
    CHECK(volume(i, 4) == (i == 2 || i == 3 ? 0.5 : 1));
  }
}

TEST_CASE("corners within 1e-9 of a cell of a grid line lie on it") {
  const double h = patch.h;
  const auto same = [&](const std::vector<Polygon>& a, const std::vector<Polygon>& b) {
    const CellField va = open_volume(a, patch), vb = open_volume(b, patch);
    const Velocity fa = open_faces(a, patch), fb = open_faces(b, patch);
    bool equal = true;
    for (int j = 0; j <= patch.ny; ++j)
      for (int i = 0; i <= patch.nx; ++i)
        equal = equal && (i == patch.nx || j == patch.ny || va(i, j) == vb(i, j)) &&
                (j == patch.ny || fa.u(i, j) == fb.u(i, j)) && (i == patch.nx || fa.v(i, j) == fb.v(i, j));
    return equal;
  };
  const std::vector<Polygon> exact{box(0, 1, 3, 4)};
  for (double off : {1e-10, -1e-10, 9e-10, -9e-10})
    CHECK(same(snapped({box(off * h, 1 + off * h, 3 - off * h, 4 + off * h)}, patch), exact));
  for (double off : {1e-8, -1e-8})
    CHECK_FALSE(same(snapped({box(off * h, 1 + off * h, 3 - off * h, 4 + off * h)}, patch), exact));
}

TEST_CASE("volume, faces and wall of a cut cell belong together") {
  // The normals of all sides of a cell's open part add up to 0, so those of its open faces give length and normal of the
  // wall; and 2 V = Σ x . n over faces and wall gives its distance from the middle of the cell.
  for (double degrees : {0.0, 7.0, 30.0, 45.0, 71.0, 90.0, 133.0, 250.0}) {
    const double nx = std::cos(degrees * M_PI / 180), ny = std::sin(degrees * M_PI / 180);  // into the open
    const double cx = 1.52, cy = 4.07, far = 20;
    const auto at = [&](double along, double behind) {
      return std::array{cx - along * ny - behind * nx, cy + along * nx - behind * ny};
    };
    const Polygon half_plane{at(far, 0), at(far, far), at(-far, far), at(-far, 0)};
    const CellField volume = open_volume({half_plane}, patch);
    const Velocity faces = open_faces({half_plane}, patch);
    int cut = 0;
    for (int j = 0; j < patch.ny; ++j)
      for (int i = 0; i < patch.nx; ++i) {
        const double e = faces.u(i + 1, j), w = faces.u(i, j), n = faces.v(i, j + 1), s = faces.v(i, j);
        const double distance =
            ((patch.x_centre(i) - cx) * nx + (patch.y_centre(j) - cy) * ny) / patch.h;  // of the middle
        const double reach = 0.5 * (std::abs(nx) + std::abs(ny));
        if (std::abs(distance) > reach) {
          CHECK(volume(i, j) == (distance > 0 ? 1 : 0));
          continue;
        }
        INFO(degrees << " degrees, cell " << i << ", " << j);
        const double length = std::hypot(e - w, n - s);
        CHECK(e - w == Approx(length * nx).margin(1e-12));
        CHECK(n - s == Approx(length * ny).margin(1e-12));
        CHECK(volume(i, j) == Approx(0.25 * (e + w + n + s) + 0.5 * length * distance).margin(1e-12));
        ++cut;
      }
    CHECK(cut >= 8);
  }
}

TEST_CASE("a mirrored solid leaves mirrored shares") {
  const double middle = patch.x0 + 0.5 * patch.nx * patch.h;
  for (const Polygon& p : {box(0.13, 2.37, 3.21, 4.9), Polygon{{0.2, 2.3}, {3.1, 2.9}, {1.4, 5.7}},
                           circle(1.13, 4.2, 1.4, 720)}) {
    Polygon image(p.rbegin(), p.rend());
    for (auto& corner : image) corner[0] = 2 * middle - corner[0];
    const CellField volume = open_volume({p}, patch), of_image = open_volume({image}, patch);
    const Velocity faces = open_faces({p}, patch), faces_of_image = open_faces({image}, patch);
    double worst = 0;
    for (int j = 0; j <= patch.ny; ++j)
      for (int i = 0; i <= patch.nx; ++i) {
        const int k = patch.nx - 1 - i;
        if (j < patch.ny) worst = std::max(worst, std::abs(faces.u(i, j) - faces_of_image.u(k + 1, j)));
        if (i == patch.nx) continue;
        worst = std::max(worst, std::abs(faces.v(i, j) - faces_of_image.v(k, j)));
        if (j < patch.ny) worst = std::max(worst, std::abs(volume(i, j) - of_image(k, j)));
      }
    CHECK(worst < 1e-13);
  }
}
