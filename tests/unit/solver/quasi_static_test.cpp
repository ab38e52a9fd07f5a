// Shares of slow grains of fields that are exactly known.
#include "solver/quasi_static.hpp"

#include <catch2/catch.hpp>

#include "solver/boundary_of.hpp"
#include "solver/geometry.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Scene box(int cells) {
  Scene s;
  s.width = s.height = 16;
  s.cells_x = cells;
  return s;
}

}  // namespace

TEST_CASE("flat tops: level edges that look up, of all shapes but the circle") {
  Scene s = box(16);
  const auto tops = [&](const Insert& insert) {
    s.inserts = {insert};
    return flat_tops(s);
  };
  for (const Shape shape : {Shape::square, Shape::rectangle, Shape::triangle_down}) {
    const auto found = tops(insert_of(shape, 8, 6, 4, 4));
    REQUIRE(found.size() == 1);
    CHECK(found[0].x0 == 6);
    CHECK(found[0].x1 == 10);
    CHECK(found[0].y == 8);
  }
  for (const Shape shape : {Shape::diamond, Shape::triangle_up, Shape::circle})
    CHECK(tops(insert_of(shape, 8, 6, 4, 4)).empty());
  // A step with two levels, its corners either way round; the edge in its underside looks down.
  std::vector<std::array<double, 2>> step{{2, 2}, {8, 2}, {8, 4}, {5, 4}, {5, 7}, {2, 7}};
  for (int way = 0; way < 2; ++way, std::reverse(step.begin(), step.end())) {
    const auto found = tops(insert_of(step));
    REQUIRE(found.size() == 2);
    CHECK(found[0].y + found[1].y == 11);
    CHECK(found[0].x1 - found[0].x0 == 3);
  }
  s.gravity = {0.1, -1};
  CHECK(tops(insert_of(Shape::square, 8, 6, 4, 4)).empty());
}

TEST_CASE("slow grains: exact shares by speed, and above a flat top") {
  Scene s = box(16);
  s.inserts = {insert_of(Shape::square, 8, 6, 4, 4)};  // 6 to 10, 4 to 8: whole cells
  const auto geometry = geometry_of(s, boundary_of(s));
  // Filled to 12: 16 x 12 cells less 16 of the insert. Speeds by column: 0 in the left half, 5e-3 up to x = 12, then 1.
  CellField grains(s.patch()), speed(s.patch());
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 16; ++i) {
      grains(i, j) = 1;
      speed(i, j) = i < 8 ? 0 : i < 12 ? 5e-3 : 1;
    }
  const double all = 16 * 12 - 16;
  for (const int threads : {1, 2}) {
    const SlowShares slow =
        slow_shares(grains, speed, geometry.get(), flat_tops(s), {1e-2, 1e-3, 1e-4}, threads);
    CHECK(slow.all == std::vector<double>{(12 * 12 - 16) / all, (8 * 12 - 8) / all, (8 * 12 - 8) / all});
    // Above the top: 4 columns and 4 rows, of which the left half is at rest.
    CHECK(slow.above_flat_tops == std::vector<double>{16 / all, 8 / all, 8 / all});
  }
  CHECK(slow_shares(grains, speed, geometry.get(), {}, {1e-2}, 1).above_flat_tops.empty());
  CHECK(slow_shares(CellField(s.patch()), speed, nullptr, {}, {1}, 1).all == std::vector<double>{0});
}

TEST_CASE("slow grains: a flat top that cuts cells has its share of them, one above another counts once") {
  Scene s = box(8);  // cells of 2
  CellField grains(s.patch(), 1), speed(s.patch());
  const auto above = [&](const std::vector<FlatTop>& tops) {
    return slow_shares(grains, speed, nullptr, tops, {1}, 1).above_flat_tops[0];
  };
  CHECK(above({{3, 10, 9}}) == Approx(7.0 * 7 / 256).epsilon(1e-14));
  CHECK(above({{4, 12, 4}, {4, 12, 10}}) == Approx(8.0 * 12 / 256).epsilon(1e-14));
  CHECK(above({{0, 2, 8}, {6, 8, 8}}) == Approx(2 * 2.0 * 8 / 256).epsilon(1e-14));
}

TEST_CASE("slow grains: the row of a run at rest, with cut cells and without") {
  Scene s = box(16);
  s.fill = {fill_box(0, 0, 16, 0, 12)};
  s.time.end = 1e-9;
  s.output.fields_every = s.output.snapshots_every = 0;
  s.threads = 1;
  const Summary plain = Simulation(s).run();
  CHECK(plain.quasi_static_1e2 == 1);
  CHECK(plain.quasi_static_1e4 == 1);
  CHECK_FALSE(plain.quasi_static_above_flat_top);
  s.inserts = {insert_of(Shape::triangle_down, 8, 5, 5, 4)};  // 10 of area, up to y = 7
  const Summary cut = Simulation(s).run();
  CHECK(cut.quasi_static_fraction == 1);
  CHECK(*cut.quasi_static_above_flat_top == Approx(5.0 * 5 / (16 * 12 - 10)).epsilon(1e-12));
}
