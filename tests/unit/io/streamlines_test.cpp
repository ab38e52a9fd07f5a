#include "io/streamlines.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace hourglass;

namespace {

double length(const Polygon& line) {
  double sum = 0;
  for (std::size_t k = 1; k < line.size(); ++k)
    sum += std::hypot(line[k][0] - line[k - 1][0], line[k][1] - line[k - 1][1]);
  return sum;
}

}  // namespace

TEST_CASE("streamlines of a plain flow go straight through, evenly spaced", "[io]") {
  const StreamlineField field{40, 20,
                              [](const Point&) {
                                return Point{0, -2};
                              },
                              [](const Point&) { return true; }, 0};
  const auto lines = streamlines(field, 4);
  CHECK(lines.size() >= 9);
  CHECK(lines.size() <= 11);
  for (const Polygon& line : lines) {
    CHECK(length(line) > 19);
    CHECK(line.front()[0] == Approx(line.back()[0]));
    CHECK(line.front()[1] > line.back()[1]);  // along the flow
  }
}

TEST_CASE("streamlines follow circles, end at obstacles, and keep out of still parts", "[io]") {
  const auto turn = [](const Point& p) { return Point{20 - p[1], p[0] - 20}; };
  const auto radius = [](const Point& p) { return std::hypot(p[0] - 20, p[1] - 20); };
  const StreamlineField field{40, 40, turn, [&](const Point& p) { return p[0] > 20 && radius(p) < 18; }, 5};
  const auto lines = streamlines(field, 3);
  REQUIRE(lines.size() >= 4);
  double closest = 100;
  for (const Polygon& line : lines) {
    for (const Point& p : line) {
      CHECK(p[0] > 20);
      CHECK(radius(p) > 5);  // where speed is radius
      CHECK(radius(p) < 18);
      CHECK(radius(p) == Approx(radius(line.front())).epsilon(1e-3));
      for (const Polygon& other : lines) {
        if (&other == &line) continue;
        for (const Point& q : other) closest = std::min(closest, std::hypot(p[0] - q[0], p[1] - q[1]));
      }
    }
  }
  CHECK(closest > 1.4);
}

TEST_CASE("there are no streamlines where nothing flows", "[io]") {
  const StreamlineField still{20, 20,
                              [](const Point&) {
                                return Point{0, 0};
                              },
                              [](const Point&) { return true; }, 0};
  CHECK(streamlines(still, 2).empty());
  const StreamlineField nan{20, 20,
                            [](const Point&) {
                              return Point{NAN, 1};
                            },
                            [](const Point&) { return true; }, 0};
  CHECK(streamlines(nan, 2).empty());
}
