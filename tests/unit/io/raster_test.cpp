#include "io/raster.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace hourglass;

TEST_CASE("polygons cover their area, overlaps count once", "[io]") {
  Cover cover(20, 10);
  const auto total = [&] {
    double sum = 0;
    for (int b = 0; b < 10; ++b) {
      for (int a = 0; a < 20; ++a) sum += cover(a, b);
    }
    return sum;
  };
  cover.add({{2, 2}, {8, 2}, {8, 8}, {2, 8}});
  CHECK(total() == 36);
  CHECK(cover.all(2, 2));
  CHECK(cover.none(1, 2));
  cover.add({{8, 8}, {8, 2}, {2, 2}, {2, 8}});  // the other way round
  cover.add({{5, 2}, {5, 8}, {9, 8}, {9, 2}});
  CHECK(total() == 42);
  cover.add({{10, 1}, {18, 1}, {18, 9}, {14, 3}, {10, 9}});  // not convex
  CHECK(total() == Approx(42 + 64 - 24).epsilon(0.02));
  CHECK(cover.holds(11, 3));
  CHECK_FALSE(cover.holds(14, 5));
  cover.add({{-100, -100}, {-50, 300}, {-60, 20}});  // outside
  cover.add({{3, 3}, {4, 4}});                       // no area
  CHECK(total() == Approx(42 + 64 - 24).epsilon(0.02));
  cover.add({{-100, -100}, {300, -100}, {300, 300}, {-100, 300}});
  CHECK(total() == 200);
}

TEST_CASE("polygons that share an edge leave no gap", "[io]") {
  for (double slope = 0; slope < 9; slope += 0.37) {
    Cover cover(10, 10);
    cover.add({{0, 0}, {slope, 0}, {9 - slope, 10}, {0, 10}});
    cover.add({{10, 0}, {slope, 0}, {9 - slope, 10}, {10, 10}});
    for (int b = 0; b < 10; ++b) {
      for (int a = 0; a < 10; ++a) CHECK(cover.all(a, b));
    }
  }
}

TEST_CASE("strokes have their width, and corners are no darker", "[io]") {
  Strokes strokes(30, 30);
  strokes.add({{5, 5}, {25, 5}, {25, 25}}, 3);
  double across = 0, largest = 0;
  for (int b = 0; b < 30; ++b) {
    across += strokes(15, b);
    for (int a = 0; a < 30; ++a) largest = std::max(largest, strokes(a, b));
  }
  CHECK(across == Approx(3));
  CHECK(largest == 1);
  CHECK(strokes(5, 20) == 0);
  strokes.add({{5, 5}, {25, 5}, {5, 25}}, 2, true);
  CHECK(strokes(5, 20) > 0.4);  // closed
}
