#include "io/chart.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/image.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("hourglass_chart_test_{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

Image drawn(const Chart& chart) {
  const Folder folder;
  draw_chart(chart, folder.path / "a.png");
  return Image(folder.path / "a.png");
}
Image drawn(const HeatMap& map) {
  const Folder folder;
  draw_heat_map(map, folder.path / "a.png");
  return Image(folder.path / "a.png");
}

/// Middle of the pixels of a colour.
std::array<double, 2> centre_of(const Image& image, const Colour& colour) {
  double x = 0, y = 0;
  int n = 0;
  for (int b = 0; b < image.height(); ++b)
    for (int a = 0; a < image.width(); ++a)
      if (image.at(a, b) == colour) {
        x += a;
        y += b;
        ++n;
      }
  REQUIRE(n > 0);
  return {x / n, y / n};
}

}  // namespace

TEST_CASE("points of a chart stand where their axes say", "[io][picture]") {
  const bool log = GENERATE(false, true);
  Chart chart{.x = {"x", log}, .y = {"y", log}};
  // Three points in a row, evenly spaced on the axes: the middle one is halfway.
  const std::vector<double> even = log ? std::vector<double>{1, 100, 10000} : std::vector<double>{1, 3, 5};
  for (int k = 0; k < 3; ++k)
    chart.series.push_back(
        {.name = {}, .x = {even[k]}, .y = {even[k]}, .line = false, .mark = Mark::disc, .colour = k});
  const Image image = drawn(chart);
  const auto a = centre_of(image, palette[0]), b = centre_of(image, palette[1]),
             c = centre_of(image, palette[2]);
  for (int axis = 0; axis < 2; ++axis) {
    CHECK(c[axis] - a[axis] > 500);
    CHECK(b[axis] - a[axis] == Approx(c[axis] - b[axis]).margin(1));
  }
}

TEST_CASE("a chart leaves out what it cannot show and breaks lines there", "[io][picture]") {
  Chart chart{.x = {"x"}, .y = {"y", true, {{0.1, 10}}}};
  chart.series = {{.name = {}, .x = {0, 1, 2, 3, 4}, .y = {1, NAN, 1, -1, 1}, .mark = Mark::none}};
  CHECK(drawn(chart).count(palette[0]) == 0);  // three points without a neighbour
  chart.series[0].y = {1, 1, 1, -1, 1};
  CHECK(drawn(chart).count(palette[0]) > 500);
  chart.series[0].y = {1e-5, 1e-5, 1e-5, 1e5, 1e5};  // beyond the range: cut off at the plot
  const Image image = drawn(chart);
  CHECK(image.white_margin(10));
}

TEST_CASE("greyed points have no colour, and the labels of points and lines are drawn", "[io][picture]") {
  Chart chart{.x = {"x"}, .y = {"y"}};
  chart.series = {
      {.name = {}, .x = {1, 2, 3}, .y = {1, 2, 3}, .line = false, .mark = Mark::square, .greyed = true}};
  const auto ink = [](const Image& image) { return image.count({40, 40, 40}); };
  const Image bare = drawn(chart);
  CHECK(bare.count(palette[0]) == 0);
  CHECK(bare.count({178, 178, 178}) > 3 * 100);
  chart.series[0].labels = {"one", "two", "three"};
  const Image labelled = drawn(chart);
  CHECK(ink(labelled) > ink(bare) + 200);
  chart.lines = {{ReferenceLine::Way::horizontal, 2, "limit"}};
  CHECK(drawn(chart).width() > labelled.width());
}

TEST_CASE("no label, legend or title of a chart is cut off", "[io][picture][slow]") {
  const bool log = GENERATE(false, true);
  Chart chart{.title =
                  "a title that is a good deal wider than the plot under it, which has to make room for it "
                  "at the right",
              .x = {"a rather long title of the horizontal axis [√(d/g)]", log},
              .y = {"a rather long title of the upright axis [ρ √(g d³)]", log},
              .width = 500,
              .height = 400};
  for (int k = 0; k < 14; ++k)
    chart.series.push_back({.name = fmt::format("a series with the number {}", k),
                            .x = {1.0 + k, 1e6, 1e7},
                            .y = {1e-7, 1.0, 1e-3 * k},
                            .dashed = k % 2 == 0,
                            .mark = static_cast<Mark>(k % 6),
                            .colour = k,
                            .error = {1e-8, 0.5, 1},
                            .lower = {1e-8, 0.5, -1},
                            .upper = {1e-6, 2, 1},
                            .labels = {"left", "", "a label at the right end"}});
  for (const double at : {1e6, 1.001e6, 2e6, 1.0, 1e7})
    chart.lines.push_back({ReferenceLine::Way::vertical, at, "a vertical line"});
  for (const double at : {1.0, 1.01, 1e-7})
    chart.lines.push_back({ReferenceLine::Way::horizontal, at, "level"});
  CHECK(drawn(chart).white_margin(10));
  chart.series.clear();
  chart.lines.clear();
  CHECK(drawn(chart).white_margin(10));  // nothing but axes
}

TEST_CASE("a heat map shows each value in its share of the plane", "[io][picture]") {
  HeatMap map{.x = {"I_0", true}, .y = {"mu_s"}, .value = {"growth"}};
  map.at_x = {1, 10, 100, 1000};
  map.at_y = {0, 1};
  map.values = {0, 1, 2, 3, 3, 3, 3, NAN};
  const Image image = drawn(map);
  CHECK(image.white_margin(10));
  const ColourScale scale({0, 3}, false, ColourMap::viridis);
  const int cell = map.width * map.height / 8;
  for (const double v : {1.0, 2.0})
    CHECK(std::abs(image.count(scale.colour_of(v)) - cell) < 0.01 * cell + 500);
  CHECK(std::abs(image.count({238, 238, 238}) - cell) < 0.01 * cell);
  CHECK(image.count({255, 0, 255}) == 0);
  map.values.pop_back();
  CHECK_THROWS_AS(drawn(map), std::invalid_argument);
}

TEST_CASE("a contour of a heat map lies where the values cross", "[io][picture]") {
  HeatMap map{.x = {""}, .y = {""}, .value = {""}, .colours = ColourMap::signs};
  for (int k = 0; k <= 10; ++k) map.at_x.push_back(k);
  map.at_y = {0, 1, 2};
  for (int j = 0; j < 3; ++j)
    for (const double x : map.at_x) map.values.push_back(x - 2.25);
  const int before = drawn(map).count({255, 255, 255});
  map.contours = {0};
  const Image image = drawn(map);
  CHECK(image.count({255, 255, 255}) > before);
  // White at the rim of the line, between the outermost places: at 2.25 of -0.5 ... 10.5.
  int left = image.width(), right = 0;
  const Colour ink{40, 40, 40};
  for (int b = 500; b < 520; ++b)
    for (int a = 200; a < 800; ++a)
      if (image.at(a, b) == ink) {
        left = std::min(left, a);
        right = std::max(right, a);
      }
  REQUIRE(left <= right);
  CHECK(right - left <= 3);
  // The lowest sign's colour begins at the left border of the plot.
  int border = 0;
  while (image.at(border, 510) != ColourScale({-7.75, 7.75}, false, ColourMap::signs).colour_of(-2.25))
    ++border;
  CHECK(std::abs((left + right) / 2.0 - (border + map.width * 2.75 / 11)) < 3);
}
