// Parts of pages: escaping, encoding, charts as vectors.
#include "io/html.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <regex>

using namespace hourglass;
using Catch::Contains;

namespace {

long count(const std::string& text, const std::string& what) {
  long n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// The points of the first line of a chart.
std::vector<std::array<double, 2>> points_of(const std::string& figure) {
  std::smatch d;
  REQUIRE(std::regex_search(figure, d, std::regex("<path class=\"line c0\" d=\"(M[^\"]*L[^\"]*)\"")));
  const std::string path = d[1];
  const std::regex pair("[ML]([0-9.]+) ([0-9.]+)");
  std::vector<std::array<double, 2>> points;
  for (std::sregex_iterator at(path.begin(), path.end(), pair), end; at != end; ++at)
    points.push_back({std::stod((*at)[1]), std::stod((*at)[2])});
  return points;
}

}  // namespace

TEST_CASE("html: text and bytes") {
  CHECK(html_text("<a href=\"x\">&'") == "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  // RFC 4648, section 10
  for (const auto& [bytes, text] : {std::pair{"", ""},
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}})
    CHECK(base64(bytes) == text);
  CHECK(base64("\xff\xfe\xfd") == "//79");
}

TEST_CASE("html: a page lets nothing in") {
  const std::string page = html_page("a <b>", "<p>body</p>");
  CHECK_THAT(page, Contains("<title>a &lt;b&gt;</title>"));
  CHECK_THAT(page, Contains("default-src 'none'; img-src data:"));
  CHECK(count(page, "http:") + count(page, "https:") == 0);
}

TEST_CASE("html: a chart holds its curve, in place, with gaps where there is no value") {
  Chart chart{
      .title = "a & b", .x = {.title = "x [d]", .range = {{0, 10}}}, .y = {.title = "y", .range = {{0, 1}}}};
  chart.series.push_back({.name = "</script>", .x = {0, 5, 6, 7, 10}, .y = {0, 0.5, NAN, 1, 1}});
  const std::string figure = svg_figure(chart);
  CHECK_THAT(figure, Contains("<figcaption>a &amp; b</figcaption>"));
  CHECK(count(figure, "</script>") == 1);  // its own end
  CHECK_THAT(figure, Contains("&lt;/script&gt;"));
  const auto points = points_of(figure);
  REQUIRE(points.size() == 4);
  const double left = points[0][0], right = points[3][0], bottom = points[0][1], top = points[3][1];
  CHECK(points[1][0] == Approx(0.5 * (left + right)).margin(0.06));
  CHECK(points[1][1] == Approx(0.5 * (bottom + top)).margin(0.06));
  CHECK(points[2][0] == Approx(left + 0.7 * (right - left)).margin(0.06));
  CHECK(count(figure, "M") >= 2);
}

TEST_CASE("html: a long curve is thinned out, but keeps its ends and its extremes") {
  constexpr int n = 20000;
  Chart chart{.x = {.title = "t"}, .y = {.title = "v"}};
  chart.series.push_back({});
  for (int k = 0; k < n; ++k) {
    chart.series[0].x.push_back(k);
    chart.series[0].y.push_back(k == 12345 ? 50 : k == 777 ? -50 : k % 75 == 0 ? NAN : std::sin(k));
  }
  const std::string figure = svg_figure(chart);
  CHECK(points_of(figure).size() < 1000);
  CHECK_THAT(figure, Contains(",12345,50]"));
  CHECK_THAT(figure, Contains(",777,-50]"));
  CHECK_THAT(figure, Contains(",19999,"));
}

TEST_CASE("html: pictures of several fields, one of them seen") {
  const std::string viewer =
      html_viewer({{"speed", {"t = 0", "t = 1"}, {"one", "two"}}, {"pressure", {"t = 1"}, {"three"}}});
  CHECK(count(viewer, "<img ") == 3);
  CHECK(count(viewer, "hidden data-caption") == 1);
  CHECK_THAT(viewer, Contains("alt=\"speed, t = 1\" src=\"data:image/png;base64,dHdv\""));
  CHECK_THAT(viewer, Contains("max=\"1\" value=\"1\""));
  CHECK(html_viewer({}).empty());
}
