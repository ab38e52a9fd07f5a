// Solids: their outlines, the convex pieces, the hopper, and what check() says about them.
#include "solver/solids.hpp"

#include <catch2/catch.hpp>
#include <functional>
#include <limits>

#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

Insert solid(Shape shape, double x, double y, double width, double height = 0) {
  return {.shape = shape, .centre = {x, y}, .width = width, .height = height, .points = {}};
}

Scene with(std::vector<Insert> inserts) {
  Scene s = sound_scene();
  s.inserts = std::move(inserts);
  return s;
}

void expect_clean(const Scene& s) {
  for (const Problem& p : check(s)) UNSCOPED_INFO(p.path << ": " << p.message);
  CHECK(check(s).empty());
}

/// The only problem of a scene.
void expect(const Scene& s, const std::string& path, const std::vector<std::string>& parts,
            bool fatal = true) {
  const std::vector<Problem> problems = check(s);
  for (const Problem& p : problems) UNSCOPED_INFO(p.path << ": " << p.message);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].fatal == fatal);
  CHECK(problems[0].path == path);
  for (const std::string& part : parts) CHECK_THAT(problems[0].message, Catch::Contains(part));
}

double area_of_all(const std::vector<Polygon>& pieces) {
  double sum = 0;
  for (const Polygon& piece : pieces) sum += area(piece);
  return sum;
}

bool is_convex(const Polygon& p) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (turn(p[k], p[(k + 1) % p.size()], p[(k + 2) % p.size()]) < 0) return false;
  return true;
}

/// A star of n corners, every other one further in.
Polygon star(double x, double y, double outer, double inner, int n) {
  Polygon p;
  for (int k = 0; k < n; ++k) {
    const double r = k % 2 ? inner : outer, angle = 2 * M_PI * k / n;
    p.push_back({x + r * std::cos(angle), y + r * std::sin(angle)});
  }
  return p;
}

}  // namespace

TEST_CASE("outlines have the areas and the boxes of their shapes") {
  struct Case {
    Insert insert;
    double area;
  };
  for (const auto& [insert, expected] :
       {Case{solid(Shape::square, 75, 60, 30), 900}, Case{solid(Shape::rectangle, 75, 60, 30, 20), 600},
        Case{solid(Shape::diamond, 75, 60, 30, 20), 300},
        Case{solid(Shape::triangle_up, 75, 60, 30, 20), 300},
        Case{solid(Shape::triangle_down, 75, 60, 30, 20), 300},
        Case{solid(Shape::circle, 75, 60, 30), 225 * M_PI}, Case{insert_of({{0, 0}, {3, 0}, {0, 4}}), 6}}) {
    const Polygon outline = outline_of(insert);
    INFO(shape_names[static_cast<int>(insert.shape)]);
    CHECK(area(outline) == Approx(expected).epsilon(1e-12));
    CHECK(area_of_all(convex_pieces(outline)) == Approx(expected).epsilon(1e-12));
    CHECK(convex_pieces(outline).size() == 1);
    CHECK(twice_signed_area(outline) > 0);
  }
  CHECK(outline_of(solid(Shape::triangle_up, 75, 60, 30, 20))[2] == std::array{75.0, 70.0});
  CHECK(outline_of(solid(Shape::triangle_down, 75, 60, 30, 20))[0] == std::array{75.0, 50.0});
}

TEST_CASE("polygons that are not convex are cut into convex pieces of the same area") {
  Polygon comb;  // a spine with ten teeth
  for (int k = 0; k < 10; ++k) {
    const double x = 10.0 * k;
    comb.insert(comb.end(), {{x, 20}, {x + 2, 0}, {x + 5, 0}, {x + 7, 20}});
  }
  comb.insert(comb.end(), {{100, 20}, {100, 30}, {0, 30}});
  const std::vector<Polygon> all{
      {{0, 0}, {9, 0}, {5, 1}, {5, 9}},                                        // one corner turns inwards
      {{0, 0}, {10, 0}, {10, 2}, {2, 2}, {2, 8}, {10, 8}, {10, 10}, {0, 10}},  // a C
      {{0, 0}, {5, 0}, {10, 0}, {10, 5}, {5, 5}, {5, 10}, {0, 10}, {0, 5}},  // an L with corners on its sides
      star(50, 50, 40, 10, 12),
      star(50, 50, 40, 39, 200),
      comb};
  for (Polygon p : all)
    for (const bool reversed : {false, true}) {
      if (reversed) std::reverse(p.begin(), p.end());
      const std::vector<Polygon> pieces = convex_pieces(p);
      INFO(p.size() << " corners, " << pieces.size() << " pieces");
      CHECK(pieces.size() > 1);
      CHECK(pieces.size() <= p.size() - 2);  // triangles, but for what could be merged
      CHECK(area_of_all(pieces) == Approx(area(p)).epsilon(1e-12));
      CHECK(std::all_of(pieces.begin(), pieces.end(), is_convex));
      for (std::size_t a = 0; a < pieces.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) CHECK(area(part_inside(pieces[a], pieces[b])) < 1e-9);
    }
}

TEST_CASE("walls of a hopper rise from the outlet to the sides, or to the top") {
  Scene s = sound_scene();
  s.hopper = Hopper{45, 30};
  using Points = std::vector<Polygon>;
  const auto near = [](const Points& found, const Points& expected) {
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      REQUIRE(found[k].size() == expected[k].size());
      for (std::size_t c = 0; c < found[k].size(); ++c)
        for (int axis = 0; axis < 2; ++axis)
          CHECK(found[k][c][axis] == Approx(expected[k][c][axis]).margin(1e-9));
    }
  };
  near(hopper_walls(s), {{{0, 60}, {0, 0}, {60, 0}}, {{90, 0}, {150, 0}, {150, 60}}});
  s.hopper->half_angle = std::atan(0.2) * 180 / M_PI;  // reaches the top 30 beside the outlet
  near(hopper_walls(s),
       {{{30, 150}, {0, 150}, {0, 0}, {60, 0}}, {{90, 0}, {150, 0}, {150, 150}, {120, 150}}});
  CHECK(outlines_of(s).size() == 2);
  CHECK(area_of_all(solids_of(s)) == Approx(2 * 150 * (60 + 30) / 2));
  s.hopper->half_angle = 45;
  s.symmetry = Symmetry::mirror;
  near(hopper_walls(s), {{{15, 0}, {150, 0}, {150, 135}}});
  s.symmetry = Symmetry::none;
  s.coordinates = Coordinates::axisymmetric;
  near(hopper_walls(s), {{{15, 0}, {150, 0}, {150, 135}}});
  s.hopper.reset();
  CHECK(hopper_walls(s).empty());
}

TEST_CASE("the outlet of a hopper is an orifice if there is none at the bottom") {
  Scene s = sound_scene();
  s.hopper = Hopper{30, 20};
  open_outlet(s);
  CHECK(s.orifices.size() == 1);  // its own stays
  expect_clean(s);
  s.orifices = {{Side::right, 140, 12}};
  CHECK(open_outlet(s));
  REQUIRE(s.orifices.size() == 2);
  CHECK(s.orifices[1] == Orifice{Side::bottom, 75, 20});
  s.symmetry = Symmetry::mirror;
  s.walls[0] = Wall::free_slip;
  s.orifices.clear();
  open_outlet(s);
  CHECK(s.orifices == std::vector{Orifice{Side::bottom, 0, 20}});
  expect_clean(s);
}

TEST_CASE("sound inserts: inside, cut by the sides, touching, overlapping") {
  for (int shape = 0; shape < 6; ++shape) {
    const bool one_size = shape == 0 || shape == 5;
    expect_clean(with({solid(static_cast<Shape>(shape), 75, 56.25, 37.5, one_size ? 0 : 37.5)}));
  }
  expect_clean(with({insert_of(star(75, 70, 30, 12, 10))}));
  expect_clean(
      with({solid(Shape::square, 0, 70, 20), solid(Shape::circle, 150, 60, 30)}));  // cut by the sides
  expect_clean(with({solid(Shape::circle, 40, 60, 20), solid(Shape::circle, 60, 60, 20)}));  // touch
  expect_clean(with({solid(Shape::circle, 40, 60, 20), solid(Shape::square, 50, 60, 20)}));  // overlap
  expect_clean(with({solid(Shape::square, 20, 60, 20), solid(Shape::square, 10 + 1. / 3, 60, 20 + 2. / 3)}));
  expect_clean(with(
      {solid(Shape::square, 55.625, 10, 20), solid(Shape::square, 94.375, 10, 20)}));  // beside the orifice
}

TEST_CASE("inserts: sizes, corners, place") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect(with({solid(Shape::square, 75, 60, 0)}), "inserts.0.width", {"0 is out of range (must be > 0)"});
  expect(with({solid(Shape::circle, 75, 60, -1)}), "inserts.0.diameter", {"must be > 0"});
  expect(with({solid(Shape::circle, 75, 60, nan)}), "inserts.0.diameter", {"must be > 0"});
  expect(with({solid(Shape::diamond, 75, 60, 20, 0)}), "inserts.0.height", {"must be > 0"});
  expect(with({solid(Shape::square, 75, 60, 20, 30)}), "inserts.0.height",
         {"30 is not the width, 20. Use shape rectangle."});
  expect(with({solid(Shape::square, nan, 60, 20)}), "inserts.0.centre", {"is not finite"});
  expect(with({insert_of({{60, 60}, {90, 60}})}), "inserts.0.points", {"has 2 corners (3 to 1000)"});
  expect(with({insert_of({{60, 60}, {90, 60}, {75, nan}})}), "inserts.0.points",
         {"corner that is not finite"});
  expect(with({insert_of({{60, 60}, {90, 90}, {90, 60}, {60, 90}})}), "inserts.0.points",
         {"crosses or touches itself at [75, 75]. Give the corners in order around it, each once."});
  expect(with({insert_of({{60, 60}, {90, 60}, {90, 90}, {60, 60}})}), "inserts.0.points", {"at [60, 60]"});
  expect(with({insert_of({{60, 60}, {90, 60}, {75, 60}})}), "inserts.0.points", {"touches itself"});
  expect(with({solid(Shape::square, 200, 60, 20)}), "inserts.0",
         {"lies outside the domain (x 0 to 150, y 0 to 150). Move it inside, or remove it."});
  expect(with({solid(Shape::square, 75, 60, 30), solid(Shape::circle, 75, 100, 1.5)}), "inserts.1",
         {"is 1.28 cells across (must be at least 2). Use cells_x >= 200, or make it larger."});
  expect(with({solid(Shape::rectangle, 75, 100, 1e-300, 20)}), "inserts.0",
         {"is 0 cells across (must be at least 2). Use a finer grid, or make it larger."});
  expect(with({insert_of({{40, 60}, {80, 100}, {81, 100}, {41, 60}})}), "inserts.0",
         {"is 0.603 cells across"});  // a slanted plate
}

TEST_CASE("gaps are closed or two cells wide") {
  const std::vector<std::string> cure{
      "(must be at least 2, or closed). Use cells_x >= 200, move it away, or let them touch."};
  expect(with({solid(Shape::square, 40, 60, 20), solid(Shape::square, 61.5, 60, 20)}), "inserts.1",
         {"the gap to inserts.0 is 1.28 cells wide", cure[0]});
  expect(with({solid(Shape::circle, 40, 60, 20), solid(Shape::circle, 61.5, 60, 20)}), "inserts.1",
         {"the gap to inserts.0 is 1.28 cells wide"});
  expect(with({solid(Shape::square, 11.5, 60, 20)}), "inserts.0",
         {"the gap to the left wall is 1.28 cells wide"});
  expect(with({solid(Shape::circle, 138.5, 60, 20)}), "inserts.0", {"the gap to the right wall is 1.28"});
  expect(with({solid(Shape::diamond, 120, 11.5, 20, 20)}), "inserts.0",
         {"the gap to the bottom wall is 1.28"});
  expect_clean(with({solid(Shape::circle, 75, 139, 20)}));  // the top is open: no wall
  expect_clean(with({solid(Shape::square, 40, 60, 20), solid(Shape::square, 62.5, 60, 20)}));
  // what fills a gap closes it
  expect_clean(with({solid(Shape::square, 40, 60, 20), solid(Shape::square, 61.5, 60, 20),
                     solid(Shape::rectangle, 50.75, 60, 10, 20)}));

  Scene s = with({solid(Shape::circle, 75, 30, 20)});
  s.hopper = Hopper{30, 18.75};
  s.inserts[0].centre[0] = 75 + 9.375 + 30 * std::tan(M_PI / 6) - (10 + 1.5) / std::cos(M_PI / 6);
  expect(s, "inserts.0", {"the gap to the hopper is 1.28 cells wide"});

  s = with({solid(Shape::square, 10.75, 60, 20)});
  s.symmetry = Symmetry::mirror;
  s.walls[0] = Wall::free_slip;
  s.orifices[0].centre = 0;
  expect(s, "inserts.0", {"the gap to its mirror image is 1.28 cells wide"});

  s = with({solid(Shape::square, 10, 60, 20), solid(Shape::square, 138.5, 60, 20)});
  s.walls[0] = s.walls[1] = Wall::periodic;
  expect(s, "inserts.1", {"the gap to inserts.0 is 1.28"});
}

TEST_CASE("openings are not covered, nor cut off from grains") {
  expect(with({solid(Shape::square, 60, 10, 20)}), "inserts.0",
         {"covers the opening of orifices.0 (bottom, 65.625 to 84.375). Move one of them; they may touch."});
  Scene s = with({solid(Shape::circle, 150, 60, 40)});
  s.orifices.push_back({Side::right, 75, 18.75});
  expect(s, "inserts.0", {"covers the opening of orifices.1 (right, 65.625 to 84.375)"});

  const std::vector<Insert> shelf{solid(Shape::rectangle, 75, 60, 150, 10)};
  expect(with(shelf), "inserts",
         {"56 % of the grains have no way out: solids are between them and every orifice."}, false);
  s = with(shelf);
  s.fill[0].points = {{0, 70}, {150, 70}, {150, 130}, {0, 130}};
  expect(s, "orifices.0",
         {"is cut off from all grains by solids", "at least 2 cells wide", "Move the solids apart."});
  s.feed = Feed{0, 30};  // brings grains below the shelf
  expect(s, "inserts", {"have no way out"}, false);
  s.feed.reset();
  s.walls[3] = Wall::no_slip;
  s.orifices = {{Side::top, 75, 18.75}};
  expect(s, "inserts", {"an area of 8262 ", "is cut off from every opening and treated as solid"}, false);
  s.fill[0].points = {{0, 0}, {150, 0}, {150, 50}, {0, 50}};
  s.orifices.clear();
  s.walls[3] = Wall::open;
  expect(s, "inserts", {"close the silo: grains have no way to an orifice or an open side"});
  s.fill[0].points = {{60, 57}, {90, 57}, {90, 63}, {60, 63}};
  expect(s, "fill", {"all of its grains lie inside of solids"});

  // a ring around grains of its own, and two diamonds that touch with their tips
  const Insert c = insert_of({{50, 50},
                              {100, 50},
                              {100, 100},
                              {50, 100},
                              {50, 60},
                              {60, 60},
                              {60, 90},
                              {90, 90},
                              {90, 60},
                              {70, 60},
                              {70, 55},
                              {50, 55}});
  expect_clean(with({c}));
  expect(with({c, solid(Shape::square, 57, 57, 16)}), "inserts",
         {"an area of ", " about [", "is cut off from every opening and treated as solid."}, false);
  s = with({solid(Shape::diamond, 37.5, 56.25, 75, 75), solid(Shape::diamond, 112.5, 56.25, 75, 75)});
  s.fill[0].points = {{0, 100}, {150, 100}, {150, 130}, {0, 130}};
  expect(s, "orifices.0", {"is cut off from all grains"});
  s.inserts[1] = solid(Shape::diamond, 114, 56.25, 72, 72);  // 3 to the left is 2.56 cells
  expect_clean(s);
}

TEST_CASE("hoppers: angle, outlet, bottom") {
  const auto scene = [](double half_angle, double outlet) {
    Scene s = sound_scene();
    s.hopper = Hopper{half_angle, outlet};
    return s;
  };
  expect_clean(scene(30, 18.75));
  expect_clean(scene(2, 30));  // up to the top
  for (const double angle : {0.0, 90.0, -30.0, std::numeric_limits<double>::quiet_NaN()})
    expect(scene(angle, 18.75), "hopper.half_angle", {"must be above 0, below 90", "against the vertical"});
  expect(scene(30, 150), "hopper.outlet", {"150 is out of range (must be above 0, below the width 150)"});
  expect(
      scene(30, 15), "orifices.0",
      {"reaches from 65.625 to 84.375, beyond the hopper's outlet (67.5 to 82.5)", "an orifice by itself"});
  Scene s = scene(30, 18.75);
  s.orifices.clear();
  s.walls[2] = Wall::open;
  expect(s, "walls.bottom", {"is open under a hopper (no_slip or free_slip)"});
  s = scene(30, 18.75);
  s.orifices.push_back({Side::right, 20, 18.75});
  expect(s, "hopper", {"covers the opening of orifices.1"});
}

TEST_CASE("half a domain: the left edge is a mirror plane or an axis") {
  const auto scene = [] {
    Scene s = sound_scene();
    s.symmetry = Symmetry::mirror;
    s.walls[0] = Wall::free_slip;
    s.orifices[0].centre = 0;
    return s;
  };
  expect_clean(scene());
  Scene s = scene();
  s.walls[0] = Wall::no_slip;
  expect(s, "walls.left", {"is no_slip, but the left edge is the mirror plane (only free_slip)"});
  s = scene();
  s.orifices.push_back({Side::left, 75, 18.75});
  expect(s, "orifices.1.wall", {"the left edge is the mirror plane and cannot have an orifice"});
  s = scene();
  s.orifices[0].centre = 5;
  expect(s, "orifices.0.centre",
         {"straddles the mirror plane from -4.375 to 14.375", "Use a centre of 0, or from 9.375 on"});
  s.orifices[0].centre = 9.375;
  expect_clean(s);
  s = scene();
  s.gravity = {0.1, -1};
  expect(s, "gravity", {"has an x-component, 0.1, but the left edge is the mirror plane (must be 0)"});
  s = scene();
  s.walls[1] = Wall::periodic;
  expect(s, "walls.right", {"periodic is not possible: the left edge is the mirror plane"});
  s = scene();
  s.symmetry = Symmetry::none;
  s.coordinates = Coordinates::axisymmetric;
  expect_clean(s);
  s.walls[0] = Wall::open;
  expect(s, "walls.left", {"is open, but the left edge is the axis"});
}

TEST_CASE("feed: a material, and a level in the domain") {
  Scene s = sound_scene();
  s.feed = Feed{0, 135};
  expect_clean(s);
  for (const double level : {0.0, 151.0, std::numeric_limits<double>::quiet_NaN()}) {
    s.feed->level = level;
    expect(s, "feed.level", {"must be above 0, at most the height 150"});
  }
  s.feed = Feed{-1, 135};
  expect(s, "feed.material", {"is not a material"});
}

TEST_CASE("thirty inserts of all shapes") {
  std::vector<Insert> all;
  for (int k = 0; k < 30; ++k) {
    const int column = k % 6, row = k / 6;
    const double x = 15 + 24 * column, y = 30 + 20 * row;
    all.push_back(k % 7 == 6 ? insert_of(star(x, y, 8, 4, 100))
                             : solid(static_cast<Shape>(k % 7), x, y, 12, k % 7 == 0 || k % 7 == 5 ? 0 : 12));
  }
  expect_clean(with(all));
}
