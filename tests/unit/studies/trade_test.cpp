#include "studies/trade.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/scene_yaml.hpp"
#include "studies/pareto.hpp"
#include "studies/trade_store.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("hourglass_trade_test_{}", ::getpid());
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
};

std::string content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::map<std::string, std::string>> table(const fs::path& path) {
  const auto rows = csv_rows(content_of(path));
  std::vector<std::map<std::string, std::string>> out;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    out.emplace_back();
    for (std::size_t c = 0; c < rows[0].size(); ++c) out.back()[rows[0][c]] = rows[r].at(c);
  }
  return out;
}

const Quantity& quantity(const std::string& key) {
  for (const Quantity& q : quantities)
    if (q.key == key) return q;
  throw std::invalid_argument(key);
}

/// A well-posed silo of 64 cells across, 8 to its orifice, whose discharge in the fake below tends to 100.
TradeOptions options_of(const fs::path& folder) {
  Scene scene = sound_scene();
  scene.cells_x = 64;
  scene.time.end = 10;
  const fs::path file = folder / "scene.yaml";
  write_atomically(file, to_yaml(scene));
  return {.scene = file, .sets = {}, .out = folder / "trade", .budget = {}};
}

/// First order in the cells and in the step; the time is that of cells and steps, less for loose pressure solves.
TradeOutcome fake(const TradeRun& run, const Scene& whole) {
  const Scene& s = run.scene;
  const double h = 64.0 / s.cells_x / (run.variant.halved ? 2 : 1), dt = s.time.dt_max / whole.time.dt_max;
  const double off = 0.02 * h + 0.004 * dt + 10 * s.accuracy.pressure_tolerance;
  TradeOutcome o;
  o.cells = s.patch().cells();
  o.steps = std::lround(s.time.end / s.time.dt_max);
  o.repeats = 1;
  const double ease = s.accuracy.pressure_tolerance > 5e-5 ? 0.5 : 1;
  o.cpu_seconds = o.wall_seconds = o.spent_seconds = 2e-6 * ease * double(o.cells) * double(o.steps);
  o.pace = 1;
  o.record = {
      {"discharge", {100 * (1 - off)}},       {"quasi_static", {0.2 + 0.5 * off}},
      {"pressure", {50 + off, 20 - off, 10}}, {"surface", {0.8 + off, 0.7, 0.6 - off}},
      {"velocity", {1 - off, 2 + off, 0}},    {"mass_defect", {1e-8 + 0.01 * s.accuracy.pressure_tolerance}}};
  return o;
}

}  // namespace

TEST_CASE("the Pareto front holds what nothing else beats in both") {
  const std::vector<CostAndError> points{{1, 0.5},  {2, 0.6}, {3, 0.1}, {3, 0.2},      {4, 0.1},
                                         {5, 0.05}, {0.5, 2}, {2, NAN}, {INFINITY, 0}, {1, 0.5}};
  CHECK(pareto_front(points) == std::vector<std::size_t>{6, 0, 2, 5});
  CHECK(pareto_front({}).empty());
}

TEST_CASE("the reference of a quantity: exact order and limit, and what is said where there are none") {
  const double p = 1.5;
  const std::vector<double> limit{3, -1, 2}, way{1, 0.5, -0.2};
  const auto at = [&](double h) {
    std::vector<double> v = limit;
    for (std::size_t k = 0; k < v.size(); ++k) v[k] += way[k] * std::pow(h, p);
    return v;
  };
  for (const char* key : {"velocity", "surface"}) {  // relative and absolute norms
    const Quantity& q = quantity(key);
    const ReferenceQuantity r = reference_of(q, at(0.4), at(0.2), at(0.1));
    CHECK(r.order == Approx(p));
    CHECK(r.doubt.empty());
    for (std::size_t k = 0; k < limit.size(); ++k) CHECK(r.values[k] == Approx(limit[k]));
    CHECK(r.error_bar == Approx(1.25 * distance(q, {{key, at(0.1)}}, {{key, limit}})));
  }
  const Quantity& q = quantity("discharge");
  const ReferenceQuantity back = reference_of(q, {10}, {12}, {11});
  CHECK(back.order == 0);
  CHECK(back.values == std::vector<double>{11});
  CHECK_FALSE(back.doubt.empty());
  CHECK(back.error_bar == Approx(3 * 2 / 11.0));
  const ReferenceQuantity slow = reference_of(q, {10}, {11}, {11.9});
  CHECK(slow.order == 0.5);
  CHECK_FALSE(slow.doubt.empty());
  CHECK(slow.error_bar > 3 * 0.9 / slow.values[0]);
  CHECK_THROWS_AS(reference_of(q, {1, 2}, {1}, {1}), std::invalid_argument);
}

TEST_CASE("errors are relative or absolute as their quantity says, and missing where a run has none") {
  CHECK(distance(quantity("discharge"), {{"discharge", {102}}}, {{"discharge", {100}}}) == Approx(0.02));
  CHECK(distance(quantity("velocity"), {{"velocity", {3, 0, 1}}}, {{"velocity", {0, 4, 1}}}) ==
        Approx(5 / std::sqrt(17)));
  CHECK(distance(quantity("surface"), {{"surface", {0.5, 0.1}}}, {{"surface", {0.4, 0.4}}}) == Approx(0.2));
  CHECK(std::isnan(distance(quantity("surface"), {}, {{"surface", {0.4}}})));
}

TEST_CASE("a scene that is its own mirror image is halved, others are not") {
  Scene scene = silo(64, 1);
  scene.output.series_every = 0.27;
  scene.inserts = {insert_of(Shape::diamond, 75, 60, 30, 30), insert_of(Shape::circle, 30, 90, 10, 10),
                   insert_of(Shape::circle, 120, 90, 10, 10)};
  const auto half = halved(scene);
  REQUIRE(half);
  CHECK(half->width == 75);
  CHECK(half->cells_x == 32);
  REQUIRE(half->inserts.size() == 2);
  CHECK(half->inserts[0].centre == std::array{0.0, 60.0});
  CHECK(half->inserts[1].centre == std::array{45.0, 90.0});
  CHECK(half->orifices[0].centre == 0);
  CHECK(half->orifices[0].width == 18.75);

  Scene other = scene;
  other.inserts.pop_back();
  CHECK_FALSE(halved(other));
  other = scene;
  other.orifices[0].centre = 70;
  CHECK_FALSE(halved(other));
  other = scene;
  other.gravity = {0.1, -1};
  CHECK_FALSE(halved(other));
  other = scene;
  other.fill[0].points[1][0] = 140;
  CHECK_FALSE(halved(other));
  CHECK_FALSE(halved(*half));
}

TEST_CASE("the record of a half is that of the whole") {
  Scene scene = silo(32, 6, 75, 37.5);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "tracer";
  scene.fill.push_back(fill_box(1, 0, 150, 0, 40));
  scene.output.series_every = 0.27;
  scene.output.fields_every = Recorder::sample_interval(scene);
  const TradeOutcome whole = run_of_trade({"whole", "lever", {}, scene, 0, false}, scene, {});
  const TradeOutcome half = run_of_trade(
      {"half", "lever", {.lever = {}, .sets = {}, .halved = true}, *halved(scene), 0, false}, scene, {});
  for (const Quantity& q : quantities) {
    INFO(q.key);
    REQUIRE(whole.record.contains(q.key));
    REQUIRE(half.record.contains(q.key));
    CHECK(whole.record.at(q.key).size() == half.record.at(q.key).size());
    if (q.key != std::string("mass_defect")) CHECK(distance(q, half.record, whole.record) < 5e-3);
  }
  CHECK(whole.record.at("tracer").size() == 40);
  CHECK(whole.record.at("tracer")[10] > 0.99);  // the lowest grains leave first
  CHECK(whole.record.at("surface")[32] == Approx(135 / 150.0).margin(0.1));
  CHECK(whole.record.at("discharge")[0] > 0);

  const TradeOutcome noisy = run_of_trade({"noisy", "ensemble", {}, scene, 1, false}, scene, {});
  const double moved = distance(quantity("velocity"), noisy.record, whole.record);
  CHECK(moved > 0);
  CHECK(moved < 0.1);

  const Folder folder;
  write_record(folder.path / "a.csv", whole.record);
  CHECK(read_record(folder.path / "a.csv") == whole.record);
}

TEST_CASE("a trade names its points and goes on where it was killed", "[picture][slow]") {
  const Folder folder;
  TradeOptions options = options_of(folder.path);
  options.runner = fake;
  REQUIRE(trade(options));
  const auto rows = table(options.out / "levers.csv");
  std::map<std::string, std::map<std::string, std::string>> named;
  for (const auto& row : rows)
    if (!row.at("name").empty()) named[row.at("name")] = row;
  // The reference is exact here: first order in cells and step at once.
  const double own = std::stod(rows[0].at("error_discharge"));
  CHECK(rows[0].at("run") == "balanced");
  CHECK(own == Approx(0.02 + 0.004 + 3e-5).epsilon(1e-4));
  REQUIRE(named.contains("fast"));
  REQUIRE(named.contains("balanced"));
  CHECK(std::stod(named["fast"].at("time_ratio")) <= std::stod(named["balanced"].at("time_ratio")) / 5);
  CHECK(std::abs(std::log(std::stod(named["balanced"].at("error_discharge")) / 0.02)) < std::log(1.5));
  // 0.01 at twice the cells; what is left by extrapolation in the cells alone is that of the step.
  REQUIRE(named.contains("accurate"));
  CHECK_THAT(named["accurate"].at("run"), Catch::Contains("accuracy.extrapolate="));
  CHECK(std::stod(named["accurate"].at("error_discharge")) <= 0.005);
  bool combined = false;
  for (const auto& row : rows) combined = combined || row.at("group") == "combination";
  CHECK(combined);
  for (const char* name : {"pareto_discharge.png", "pareto_velocity.png", "trade.md", "runs.csv"})
    CHECK(fs::exists(options.out / name));
  const std::string text = content_of(options.out / "trade.md");
  CHECK_THAT(text, Catch::Contains("16, 32 and 64") || Catch::Contains("32, 64 and 128"));

  CHECK_THAT(text, Catch::Contains("The reference itself is known to 1.5 % only"));

  TradeOptions again = options;
  again.out = folder.path / "killed";
  int calls = 0;
  for (const int most : {2, 7, 30, 1000}) {
    again.runner = [&](const TradeRun& run, const Scene& whole) {
      if (++calls > most) throw std::runtime_error("killed");
      return fake(run, whole);
    };
    if (most < 1000)
      CHECK_THROWS_WITH(trade(again), "killed");
    else
      REQUIRE(trade(again));
    calls = std::min(calls, most);
  }
  for (const char* name : {"runs.csv", "levers.csv", "trade.md"})
    CHECK(content_of(again.out / name) == content_of(options.out / name));

  again.runner = [](const TradeRun&, const Scene&) -> TradeOutcome {
    throw std::runtime_error("nothing is to be run");
  };
  CHECK(trade(again));
  {
    const TradeStore other(again.out, load_scene(again.out / "scene.yaml").scene, false);
    CHECK_THROWS_WITH(trade(again), Catch::Contains("another trade is at work"));
  }
  again.sets = {"time.end=20"};
  CHECK_THROWS_WITH(trade(again), Catch::Contains("another scene"));
}

TEST_CASE("a trade keeps to its budget and says what it left out", "[picture]") {
  const Folder folder;
  TradeOptions options = options_of(folder.path);
  options.runner = fake;
  options.budget = 1;
  REQUIRE(trade(options));
  double spent = 0;
  std::size_t runs = 0;
  for (const auto& row : table(options.out / "runs.csv")) {
    spent += std::stod(row.at("spent_seconds"));
    ++runs;
  }
  CHECK(spent < 60);
  CHECK(spent > 20);
  CHECK(runs > 10);
  CHECK_THAT(content_of(options.out / "trade.md"),
             Catch::Contains("## Left out") && Catch::Contains("of the budget"));
  options.budget = 0.01;
  options.force = true;
  CHECK_THROWS_AS(trade(options), std::exception);

  options.dry_run = true;
  options.out = folder.path / "dry";
  options.runner = [](const TradeRun&, const Scene&) -> TradeOutcome { throw std::runtime_error("run"); };
  CHECK(trade(options));
  CHECK_FALSE(fs::exists(options.out));
}

TEST_CASE("a trade of a small silo", "[slow][picture]") {
  const Folder folder;
  Scene scene = sound_scene();
  scene.materials[0] = Material{};  // ill-posed: with an ensemble
  scene.cells_x = 32;
  scene.orifices[0].width = 37.5;
  scene.time.end = 8;
  write_atomically(folder.path / "scene.yaml", to_yaml(scene));
  REQUIRE(
      trade({.scene = folder.path / "scene.yaml", .sets = {}, .out = folder.path / "trade", .budget = {}}));
  const auto rows = table(folder.path / "trade/levers.csv");
  CHECK(rows.size() > 40);
  std::map<std::string, double> error, change;
  for (const auto& row : rows) {
    CHECK(row.at("status") != "diverged");
    error[row.at("run")] = std::stod(row.at("error_discharge"));
    change[row.at("run")] = std::stod(row.at("change_discharge"));
  }
  CHECK(error.at("grid.cells_x=64") < error.at("balanced"));
  CHECK(error.at("balanced") < error.at("grid.cells_x=16"));
  CHECK(change.at("domain.symmetry=mirror") < 2e-3);
  CHECK(change.at("accuracy=accurate") < 5e-3);
  CHECK(error.at("balanced") < 0.2);
  int noise = 0;
  for (const auto& row : table(folder.path / "trade/runs.csv")) noise += row.at("group") == "ensemble";
  CHECK(noise == 5);
}
