// Figures, profiles and probes of fields that are exactly known.
#include "studies/measure.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/scene_yaml.hpp"
#include "io/xdmf.hpp"
#include "solver/boundary_of.hpp"
#include "solver/geometry.hpp"
#include "studies/field_point.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

Scene box() {
  Scene s = sound_scene();
  s.width = s.height = 16;
  s.cells_x = 16;
  s.fill = {fill_box(0, 0, 16, 0, 12)};
  s.orifices = {{Side::bottom, 8, 4}};
  return s;
}

/// Columns of a table by name, as text.
std::map<std::string, std::vector<std::string>> columns(const fs::path& path) {
  std::map<std::string, std::vector<std::string>> out;
  const auto rows = csv_rows(text_at(path));
  for (std::size_t c = 0; c < rows.at(0).size(); ++c)
    for (std::size_t k = 1; k < rows.size(); ++k) out[rows[0][c]].push_back(rows[k].at(c));
  return out;
}

/// Pressure 2 + x + 3 y + t, u = x/8, v = y/4, filled up to 12; frames at t = 0, 1 ... 4.
class LinearRun {
 public:
  explicit LinearRun(const Scene& scene) : scene_(scene) {
    fs::create_directories(run());
    write_atomically(run() / "scene.yaml", to_yaml(scene_));
    std::string series = "t,mass,outflow\n";
    FieldWriter writer(run(), info_of(scene_));
    for (int k = 0; k < 5; ++k) {
      series += fmt::format("{},{},2\n", k, 192 - 2 * k);
      const Patch p = scene_.patch();
      CellField pressure(p), grains(p), u(p), v(p);
      for (int j = 0; j < p.ny; ++j)
        for (int i = 0; i < p.nx; ++i) {
          pressure(i, j) = 2 + p.x_centre(i) + 3 * p.y_centre(j) + k;
          grains(i, j) = p.y_centre(j) < 12 ? 1 : 0;
          u(i, j) = p.x_centre(i) / 8;
          v(i, j) = p.y_centre(j) / 4;
        }
      writer.write({static_cast<double>(k), {{"pressure", pressure}, {"grains", grains}}, u, v});
    }
    write_atomically(run() / "series.csv", series);
  }
  fs::path run() const { return folder_ / "run"; }

 private:
  TestFolder folder_;
  Scene scene_;
};

}  // namespace

TEST_CASE("a place: linear fields are exact between the centres of cells") {
  const Scene s = box();
  const Patch p = s.patch();
  CellField linear(p), grains(p, 1);
  for (int j = 0; j < p.ny; ++j)
    for (int i = 0; i < p.nx; ++i) linear(i, j) = 2 + p.x_centre(i) + 3 * p.y_centre(j);
  const auto at = [&](double x, double y) {
    return FieldPoint(s, nullptr, x, y).value("pressure", linear, grains);
  };
  for (const auto& [x, y] : {std::pair{8.0, 8.0}, {0.5, 0.5}, {3.3, 15.5}, {15.5, 1.2}, {7.25, 9.875}})
    CHECK(at(x, y) == Approx(2 + x + 3 * y).epsilon(1e-14));
  CHECK(at(0, 8) == Approx(2 + 0.5 + 24).epsilon(1e-14));  // half a cell at a wall: the nearest centres
  CHECK(at(16, 16) == Approx(2 + 15.5 + 3 * 15.5).epsilon(1e-14));
  CHECK_THROWS_WITH(at(-0.1, 3), Contains("outside of the silo, which is x from 0 to 16, y from 0 to 16"));
  CHECK_THROWS_WITH(at(3, 16.1), Contains("outside of the silo"));

  grains(3, 3) = 0.4;  // air: no value there, and none of it in the neighbourhood
  CHECK(std::isnan(at(3.5, 3.5)));
  CHECK(at(4.3, 3.5) == linear(4, 3));
  CHECK(FieldPoint(s, nullptr, 3.5, 3.5).value("grains", grains, grains) == 0.4);
}

TEST_CASE("a place: images, periodic sides and solids") {
  Scene s = box();
  const Patch p = s.patch();
  CellField f(p), grains(p, 1);
  for (int j = 0; j < p.ny; ++j)
    for (int i = 0; i < p.nx; ++i) f(i, j) = p.x_centre(i);
  s.symmetry = Symmetry::mirror;
  const auto at = [&](const std::string& field, double x, const Geometry* geometry = nullptr) {
    return FieldPoint(s, geometry, x, 8).value(field, f, grains);
  };
  CHECK(at("velocity_x", -3.25) == Approx(-3.25).epsilon(1e-14));
  CHECK(at("velocity_x", -0.2) == Approx(-0.2).epsilon(1e-14));
  CHECK(at("velocity_x", 0) == Approx(0).margin(1e-14));
  CHECK(at("speed", -3.25) == Approx(3.25).epsilon(1e-14));
  CHECK(at("speed", 0.1) == Approx(0.5).epsilon(1e-14));

  s.symmetry = Symmetry::none;
  s.walls[0] = s.walls[1] = Wall::periodic;
  CHECK(at("speed", 0) == Approx(8).epsilon(1e-14));  // between 0.5 and 15.5

  s.walls[0] = s.walls[1] = Wall::no_slip;
  s.inserts = {insert_of(Shape::square, 8, 8, 4, 4)};  // whole cells 6 ... 9
  const auto geometry = geometry_of(s, boundary_of(s));
  CHECK(std::isnan(at("speed", 8, geometry.get())));
  CHECK(std::isnan(at("grains", 6.1, geometry.get())));
  CHECK(at("speed", 5.25, geometry.get()) == Approx(5.25).epsilon(1e-14));
  CHECK(at("speed", 5.9, geometry.get()) == Approx(5.5).epsilon(1e-14));  // nothing of the solid
}

TEST_CASE("measure: profiles along lines, at times and as the mean over the window", "[slow]") {
  const LinearRun linear(box());
  const fs::path run = linear.run();
  measure_run(run, {.lines = {"x=8.25", "1,2,4,6"}, .fields = {"pressure", "velocity_y"}, .times = {1.2, 4}});
  auto table = columns(run / "profiles.csv");
  CHECK(table.size() == 7);
  REQUIRE(table["line"].size() == 2 * 17 + 2 * 6);  // 16 cells; a length of 5
  for (std::size_t k = 0; k < table["line"].size(); ++k) {
    const auto number = [&](const char* column) { return std::stod(table[column][k]); };
    if (number("line") == 1) CHECK(number("x") == 8.25);
    const double x = number("x"), y = number("y");
    CHECK(number("s") == Approx(number("line") == 1 ? y : std::hypot(x - 1, y - 2)).margin(1e-12));
    if (y > 12) CHECK(table["pressure"][k].empty());  // air
    if (y < 0.5 || y > 11.5) continue;
    CHECK(number("pressure") == Approx(2 + x + 3 * y + number("t")).epsilon(1e-6));  // stored as float
    CHECK(number("velocity_y") == Approx(y / 4).epsilon(1e-6));
  }
  CHECK(table["t"].front() == "1");
  CHECK(table["t"].back() == "4");
  for (const char* name : {"profile_1_pressure.png", "profile_2_velocity_y.png"})
    CHECK(fs::file_size(run / "plots" / name) > 1000);

  // The window of the discharge is the second half of so short a run: t = 2, 3, 4.
  measure_run(run, {.lines = {"y=6"}});
  table = columns(run / "profiles.csv");
  CHECK(table.count("grains") + table.count("pressure") + table.count("velocity_x") == 3);
  REQUIRE(table["t"].size() == 17);
  CHECK(table["t"][8] == "mean");
  CHECK(std::stod(table["pressure"][8]) == Approx(2 + 8 + 18 + 3).epsilon(1e-6));
  CHECK_FALSE(fs::exists(run / "plots/profile_2_velocity_y.png"));  // of the call before
}

TEST_CASE("measure: probes over time") {
  const LinearRun linear(box());
  measure_run(linear.run(), {.probes = {"3,4", "8,14"}, .fields = {"pressure"}});
  auto table = columns(linear.run() / "probes.csv");
  REQUIRE(table["probe"].size() == 10);
  for (int k = 0; k < 5; ++k) {
    CHECK(std::stod(table["pressure"][k]) == Approx(17 + k).epsilon(1e-6));
    CHECK(table["pressure"][5 + k].empty());
    CHECK(table["t"][5 + k] == std::to_string(k));
  }
  CHECK(fs::file_size(linear.run() / "plots/probes_pressure.png") > 1000);
}

TEST_CASE("measure: the share of slow grains by threshold, over time and its mean") {
  Scene s = box();
  s.inserts = {insert_of(Shape::rectangle, 8, 5, 4, 2)};  // whole cells; its top at 6
  const LinearRun linear(s);
  measure_run(linear.run(), {.speeds = {1, 0.05}});
  // Speed is hypot(x/8, y/4): count the cells.
  double all = 0, slow = 0, above = 0;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 16; ++i) {
      if (i >= 6 && i < 10 && (j == 4 || j == 5)) continue;
      const bool is_slow = std::hypot((i + 0.5) / 8, (j + 0.5) / 4) < 1;
      all += 1;
      slow += is_slow;
      above += is_slow && i >= 6 && i < 10 && j >= 6;
    }
  auto table = columns(linear.run() / "quasi_static.csv");
  CHECK(table.size() == 5);
  REQUIRE(table["t"].size() == 5);
  CHECK(std::stod(table["quasi_static_1"][3]) == Approx(slow / all).epsilon(1e-12));
  CHECK(std::stod(table["quasi_static_1_above_flat_top"][3]) == Approx(above / all).margin(1e-12));
  CHECK(table["quasi_static_0.05"][3] == "0");
  const auto rows = csv_rows(text_at(linear.run() / "measure.csv"));
  const auto row = std::ranges::find(rows, "quasi_static_1", [](const auto& cells) { return cells[0]; });
  REQUIRE(row != rows.end());
  CHECK(std::stod((*row)[1]) == Approx(slow / all).epsilon(1e-12));
  CHECK((*row)[3] == "2");
  CHECK((*row)[4] == "4");
  measure_run(linear.run());
  CHECK(columns(linear.run() / "quasi_static.csv").count("quasi_static_1e-3_above_flat_top") == 1);
}

TEST_CASE("measure: options that are wrong leave nothing behind") {
  const LinearRun linear(box());
  const auto refused = [&](const MeasureOptions& options, const std::string& why) {
    CHECK_THROWS_AS(measure_run(linear.run(), options), std::invalid_argument);
    CHECK_THROWS_WITH(measure_run(linear.run(), options), Contains(why));
    CHECK_FALSE(fs::exists(linear.run() / "plots"));
  };
  refused({.lines = {"1,2,3"}}, "--line 1,2,3: must be two places x0,y0,x1,y1, or x=X or y=Y");
  refused({.lines = {"1,2,1,2"}}, "--line 1,2,1,2: must be");
  refused({.lines = {"x=17"}}, "--line x=17: (17, 0) lies outside of the silo");
  refused({.lines = {"1,2,3,nan"}}, "must be two places");
  refused({.probes = {"1;2"}}, "--probe 1;2: must be a place x,y");
  refused({.probes = {"1,20"}}, "--probe 1,20: (1, 20) lies outside");
  refused({.lines = {"x=1"}, .fields = {"speed"}}, "--field speed: not stored; stored are velocity_x");
  refused({.fields = {"colour"}}, "unknown field 'colour'");
  refused({.lines = {"x=1"}, .times = {7}}, "time 7 is outside the run");
  fs::remove(linear.run() / "fields.h5");
  refused({.probes = {"1,1"}}, "output.fields_every above 0");
}
