#include "io/render.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "io/offscreen.hpp"
#include "tests/support/image.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("hourglass_render_test_{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

/// Grains at the lower `fill` of the domain, all of one value.
Picture filled(int nx, int ny, double fill, double value) {
  const Patch patch{nx, ny, 150.0 / nx, 0, 0};
  Picture picture;
  picture.values = CellField(patch, value);
  picture.grains = CellField(patch);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) picture.grains(i, j) = std::clamp(fill * ny - j, 0.0, 1.0);
  }
  // Moved in: GCC 12 sees phantoms in the assignment of short literals.
  picture.title = std::string("pressure");
  picture.unit = std::string("ρ g d");
  picture.length_unit = std::string("d");
  picture.time_unit = std::string("√(d/g)");
  return picture;
}

double lightness(const Colour& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

}  // namespace

TEST_CASE("numbers are short and readable", "[io]") {
  CHECK(number_text(0) == "0");
  CHECK(number_text(0.3) == "0.3");
  CHECK(number_text(3 * 0.1) == "0.3");
  CHECK(number_text(-2.5) == "−2.5");
  CHECK(number_text(164.3, 4) == "164.3");
  CHECK(number_text(12345, 2) == "12345");
  CHECK(number_text(1.6e6) == "1.6×10⁶");
  CHECK(number_text(1e6) == "10⁶");
  CHECK(number_text(9.99e5, 2) == "10⁶");
  CHECK(number_text(-1e-12) == "−10⁻¹²");
  CHECK(number_text(5e-4) == "5×10⁻⁴");
}

TEST_CASE("ticks stand at round values inside the range", "[io]") {
  const auto labels = [](const std::vector<Tick>& ticks) {
    std::string out;
    for (const Tick& t : ticks) out += t.label.empty() ? "" : t.label + " ";
    return out;
  };
  CHECK(labels(linear_ticks(0, 150, 8)) == "0 20 40 60 80 100 120 140 ");
  CHECK(labels(linear_ticks(-1, 1, 4)) == "−1 −0.5 0 0.5 1 ");
  CHECK(labels(linear_ticks(0, 1.6e6, 4)) == "0 5×10⁵ 10⁶ 1.5×10⁶ ");
  CHECK(labels(log_ticks(2e-3, 300)) == "10⁻² 10⁻¹ 10⁰ 10¹ 10² ");
  CHECK(labels(log_ticks(2, 20)) == "2 5 10 20 ");
  CHECK(log_ticks(1, 100).size() == 19);  // minor ones too
}

TEST_CASE("ranges fit the values", "[io]") {
  using Range = std::array<double, 2>;
  CHECK(nice_range(1, 100, false) == Range{0, 100});
  CHECK(nice_range(50, 100, false) == Range{50, 100});
  CHECK(nice_range(-1, 100, false) == Range{0, 100});
  CHECK(nice_range(-50, 100, false) == Range{-50, 100});
  CHECK(nice_range(3, 3, false) == Range{1.5, 4.5});
  CHECK(nice_range(HUGE_VAL, -HUGE_VAL, false) == Range{0, 1});
  CHECK(nice_range(1e-9, 10, true)[0] == Approx(1e-4));
  CHECK(nice_range(9, 10, true) == Range{1, 10});
  CHECK(nice_range(HUGE_VAL, -HUGE_VAL, true)[1] == 1);

  Picture picture = filled(20, 20, 0.5, 7);
  picture.values(0, 19) = 1e9;  // air does not count
  picture.values(3, 3) = NAN;
  CHECK(shown_extremes(picture) == Range{7, 7});
}

TEST_CASE("what lies inside solids does not count for the range; cells that they cut do", "[io]") {
  using Range = std::array<double, 2>;
  Picture picture = filled(20, 20, 0.5, 7);  // cells of side 7.5
  picture.solids = {{{15, 15}, {38, 15}, {38, 37.5}, {15, 37.5}}, {{150, 0}, {150, 15}, {135, 0}}};
  picture.values(2, 2) = picture.values(4, 4) = 1e6;
  picture.values(19, 0) = -1e6;
  CHECK(shown_extremes(picture) == Range{7, 7});
  picture.show_air = true;
  CHECK(shown_extremes(picture) == Range{7, 7});
  picture.values(5, 4) = 9;   // cut
  picture.values(18, 0) = 3;  // half of it open
  CHECK(shown_extremes(picture) == Range{3, 9});
}

TEST_CASE("a few extreme values do not set the range of a picture that may leave out tails", "[io]") {
  Picture picture = filled(50, 50, 1, 7);
  for (int k = 0; k < 50; ++k) picture.values(k, 7) = 5 + k / 49.0;
  picture.values(1, 1) = 1e6;
  picture.values(2, 1) = -1e6;
  CHECK(shown_extremes(picture)[1] == 1e6);
  picture.tails = 0.002;
  CHECK(shown_extremes(picture)[0] == Approx(5).margin(0.2));
  CHECK(shown_extremes(picture)[1] == 7);
  picture.tails = 0;
  picture.values(1, 1) = picture.values(2, 1) = NAN;
  CHECK(shown_extremes(picture)[1] == 7);
}

TEST_CASE("the mirror image doubles fields, openings and solids", "[io]") {
  Picture half;
  const Patch patch{4, 2, 2, 0, 0};
  half.values = half.grains = half.velocity_x = half.velocity_y = CellField(patch);
  for (int i = 0; i < 4; ++i) half.values(i, 1) = half.velocity_x(i, 1) = half.velocity_y(i, 1) = i + 1;
  half.openings = {
      {Side::bottom, 0, 2}, {Side::bottom, 4, 6}, {Side::right, 1, 2}, {Side::left, 0, 4}, {Side::top, 0, 8}};
  half.solids = {{{1, 1}, {3, 1}, {1, 2}}};
  const Picture whole = mirrored(half, false);
  CHECK(whole.values.patch() == Patch{8, 2, 2, -8, 0});
  CHECK(whole.values(3, 1) == 1);
  CHECK(whole.values(4, 1) == 1);
  CHECK(whole.values(0, 1) == 4);
  CHECK(whole.velocity_x(0, 1) == -4);
  CHECK(whole.velocity_y(0, 1) == 4);
  CHECK(mirrored(half, true).values(0, 1) == -4);
  CHECK(whole.solids == std::vector<Polygon>{half.solids[0], {{-1, 1}, {-3, 1}, {-1, 2}}});
  std::vector<std::array<double, 3>> openings;
  for (const Opening& o : whole.openings) openings.push_back({double(o.side), o.begin, o.end});
  CHECK(openings == std::vector<std::array<double, 3>>{
                        {2, -2, 2}, {2, 4, 6}, {2, -6, -4}, {1, 1, 2}, {0, 1, 2}, {3, -8, 8}});
}

TEST_CASE("a picture of a half is of the whole unless asked otherwise", "[io]") {
  RunInfo info;
  info.patch = {4, 2, 2, 0, 0};
  info.walls = {Wall::free_slip, Wall::no_slip, Wall::no_slip, Wall::open};
  info.slow_speed = 1e-3;
  info.solids = {{{1, 1}, {3, 1}, {1, 2}}};
  const bool axial = GENERATE(false, true);
  if (axial) {
    info.coordinates = Coordinates::axisymmetric;
  } else {
    info.symmetry = Symmetry::mirror;
  }
  Frame frame;
  const CellField ones(info.patch, 1);
  frame.fields = {{"grains", ones}, {"velocity_x", ones}, {"pressure", ones}};
  frame.velocity_x = frame.velocity_y = ones;

  const Picture whole = picture_of("pressure", frame, info);
  CHECK(whole.values.nx() == 8);
  CHECK(whole.axial == axial);
  CHECK(whole.tails > 0);
  CHECK(whole.values(0, 0) == 1);
  CHECK(picture_of("velocity_x", frame, info).values(0, 0) == -1);
  const Picture half = picture_of("pressure", frame, info, {{Overlay::quasi_static}, true});
  CHECK(half.values.nx() == 4);
  REQUIRE(half.openings.size() == 2);
  CHECK(half.openings[0].side == Side::left);  // no wall in the middle
  info.symmetry = Symmetry::none;
  info.coordinates = Coordinates::cartesian;
  CHECK(picture_of("pressure", frame, info).values.nx() == 4);

  info.slow_speed = 0;
  CHECK_THROWS_WITH(picture_of("pressure", frame, info, {{Overlay::quasi_static}, false}),
                    Catch::Contains("overlay quasi_static needs"));
}

TEST_CASE("colour maps grow lighter or darker steadily; NaN stands out", "[io]") {
  const ColourScale viridis({1, 100}, true, ColourMap::viridis), mixture({0, 1}, false, ColourMap::mixture);
  for (double s = 0; s < 1; s += 0.02) {
    CHECK(lightness(viridis.colour_at(s + 0.02)) > lightness(viridis.colour_at(s)));
    CHECK(lightness(mixture.colour_at(s + 0.02)) < lightness(mixture.colour_at(s)));
  }
  CHECK(viridis.position(10) == Approx(0.5));
  CHECK(viridis.colour_of(0) == viridis.colour_of(1));
  CHECK(viridis.colour_of(1e9) == viridis.colour_of(100));
  CHECK(viridis.colour_of(NAN) == Colour{255, 0, 255});
}

TEST_CASE("a picture shows grains in the colour of their value, and air blank", "[io][picture]") {
  const Folder folder;
  Picture picture = filled(40, 40, 0.5, 3);
  picture.range = {{0, 10}};
  render_png(picture, folder.path / "a.png");
  const Image image(folder.path / "a.png");
  CHECK(image.width() == 1400);
  CHECK(image.white_margin(10));
  const Colour expected = ColourScale({0, 10}, false, ColourMap::viridis).colour_of(3);
  const int grains = image.count(expected), blank = image.count({238, 238, 238});
  CHECK(grains > 400000);
  CHECK(std::abs(grains - blank) < 0.02 * grains);  // the surface is in the middle
}

TEST_CASE("solids are filled, over the colours and free of lines inside", "[io][picture]") {
  const Folder folder;
  Picture picture = filled(40, 40, 1, 3);
  picture.range = {{0, 10}};
  // A quarter of the domain, in two overlapping halves, and what reaches out of it.
  picture.solids = {{{0, 0}, {50, 0}, {50, 75}, {0, 75}},
                    {{40, 0}, {75, 0}, {75, 75}, {40, 75}},
                    {{-9, -9}, {-1, -9}, {-1, -1}}};
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 20; ++i) picture.grains(i, j) = 0;
  }
  render_png(picture, folder.path / "a.png");
  const Image image(folder.path / "a.png");
  const Colour grey{178, 178, 178};
  const int grains = image.count(ColourScale({0, 10}, false, ColourMap::viridis).colour_of(3));
  CHECK(std::abs(image.count(grey) - grains / 3) < 0.02 * grains);
  CHECK(image.count({0, 0, 0}) == 0);  // no free surface along a solid
}

TEST_CASE("overlays mark still grains and draw the flow", "[io][picture]") {
  const Folder folder;
  Picture picture = filled(40, 40, 1, 3);
  picture.range = {{0, 10}};
  picture.velocity_x = CellField(picture.values.patch());
  picture.velocity_y = CellField(picture.values.patch(), -1e-6);
  for (int j = 0; j < 40; ++j) {
    for (int i = 20; i < 40; ++i) picture.velocity_y(i, j) = -1;
  }
  picture.slow_speed = 1e-3;
  const Colour colour = ColourScale({0, 10}, false, ColourMap::viridis).colour_of(3);
  const auto count = [&](const std::vector<Overlay>& overlays) {
    picture.overlays = overlays;
    render_png(picture, folder.path / "a.png");
    const Image image(folder.path / "a.png");
    CHECK(image.white_margin(10));
    std::array<int, 2> plain{0, 0};  // pixels without ink in the left and in the right half
    for (int y = 200; y < 1000; ++y) {
      for (int x = 200; x < 1000; ++x) plain[x >= 600] += image.at(x, y) == colour;
    }
    return plain;
  };
  const auto still = count({Overlay::quasi_static}), flow = count({Overlay::streamlines}),
             both = count({Overlay::streamlines, Overlay::quasi_static});
  CHECK(still[0] < 0.95 * flow[0]);
  CHECK(flow[1] < 0.95 * 320000);
  CHECK(std::abs(both[0] - still[0]) < 0.02 * still[0]);
}

TEST_CASE("a picture can be made larger than it needs", "[io][picture]") {
  const Folder folder;
  Picture picture = filled(8, 8, 1, 1);
  const auto size = size_of(picture);
  picture.least_size = {size[0] + 7, size[1] + 9};
  CHECK(size_of(picture) == picture.least_size);
  render_png(picture, folder.path / "a.png");
  const Image image(folder.path / "a.png");
  CHECK(image.width() == size[0] + 7);
  CHECK(image.height() == size[1] + 9);
  CHECK(image.white_margin(10));
}

TEST_CASE("no domain, label or number is cut off", "[io][picture][slow]") {
  const Folder folder;
  struct Case {
    int nx, ny;
    double value;
    bool log;
  };
  const auto c = GENERATE(Case{160, 20, 1.643e6, false}, Case{20, 80, 1e-7, true}, Case{8, 200, 3, false},
                          Case{60, 40, -123456, false}, Case{1, 1, 1, false});
  Picture picture = filled(c.nx, c.ny, 0.7, c.value);
  picture.values(0, 0) *= 1e-3;
  picture.log_scale = c.log;
  picture.title = "a rather long title of a field";
  picture.unit = "ρ √(g d³)";
  picture.velocity_x = CellField(picture.values.patch(), 1e-6);
  picture.velocity_y = CellField(picture.values.patch(), -2e-6);
  picture.velocity_unit = "√(g d)";
  picture.time = 123456.789;
  picture.openings = {{Side::bottom, 60, 90}, {Side::top, 0, 150}, {Side::left, 0, 1e9}};
  picture.solids = {{{-50, 3}, {1000, 3}, {1000, 2000}}};
  picture.tails = 0.01;
  picture.slow_speed = 1.234e-3;
  if (GENERATE(false, true)) picture.overlays = {Overlay::quasi_static, Overlay::streamlines};
  INFO(c.nx << " x " << c.ny);
  render_png(picture, folder.path / "b.png");
  const Image image(folder.path / "b.png");
  CHECK(image.white_margin(10));
  CHECK(image.width() <= 1400);
  CHECK(image.height() <= 1700);
}

TEST_CASE("a picture of nothing but air, of zeros and of NaN is still drawn", "[io][picture]") {
  const Folder folder;
  Picture picture = filled(16, 16, 0, 0);
  picture.log_scale = true;
  picture.velocity_x = picture.velocity_y = CellField(picture.values.patch());
  render_png(picture, folder.path / "air.png");
  picture = filled(16, 16, 1, NAN);
  picture.velocity_x = picture.velocity_y = picture.values;
  picture.velocity_y(3, 3) = 0;
  render_png(picture, folder.path / "nan.png");
  CHECK(Image(folder.path / "nan.png").count({255, 0, 255}) > 400000);
}

TEST_CASE("a picture that cannot be written is an error with path and reason", "[io][picture]") {
  CHECK_THROWS_WITH(render_png(filled(8, 8, 1, 1), "/proc/nowhere/a.png"),
                    Catch::Contains("/proc/nowhere/a.png: No such file or directory"));
}

TEST_CASE("without OpenGL a picture is refused as NoGraphics", "[io][picture]") {
  const Folder folder;
  if (std::getenv("HOURGLASS_TEST_WITHOUT_GRAPHICS")) {
    CHECK_THROWS_AS(render_png(filled(8, 8, 1, 1), folder.path / "a.png"), NoGraphics);
    CHECK_FALSE(fs::exists(folder.path / "a.png"));
    return;
  }
  // In a process of its own: this one may have started OpenGL already.
  const std::string command = fmt::format(
      "HOURGLASS_TEST_WITHOUT_GRAPHICS=1 __EGL_VENDOR_LIBRARY_DIRS=/nowhere LIBGL_DRIVERS_PATH=/nowhere '{}' "
      "'without OpenGL a picture is refused as NoGraphics' > /dev/null",
      fs::read_symlink("/proc/self/exe").string());
  CHECK(std::system(command.c_str()) == 0);
}
