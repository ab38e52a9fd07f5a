// A run broken off and resumed is, to the last bit, the run without a break: what is told, the figures of merit, and all
// that the state holds.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "solver/simulation.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/memory_archive.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;

namespace {

/// Keeps what it is told, breaks off where it is asked to, and spoils the fields on the way.
class Witness : public Observer {
 public:
  explicit Witness(Simulation& simulation, long break_at = -1, std::vector<long> spoil = {})
      : simulation_(simulation), break_at_(break_at), spoil_(std::move(spoil)) {}

  void on_series(const SeriesRow& row) override { rows.push_back(row); }
  void on_fields(const Simulation& simulation) override { frames.push_back(simulation.derived("viscosity")); }
  void on_warning(const std::string& text) override { warnings.push_back(text); }
  void on_step(const StepReport& report, double) override {
    step_ = report.step;
    for (long& step : spoil_)
      if (report.step == step) {
        simulation_.fields().v(10, 10) = std::numeric_limits<double>::quiet_NaN();
        step = -1;
      }
  }
  std::string interrupt() override { return step_ == break_at_ ? "broken off" : ""; }
  void on_checkpoint(const Simulation&, const Walk& walk) override {
    state = {};
    walk(state);
    told = {std::ssize(rows), std::ssize(frames), std::ssize(warnings)};
  }
  /// As a run folder does: what was told since the checkpoint is told again.
  void take_over(const Witness& before) {
    rows.assign(before.rows.begin(), before.rows.begin() + before.told[0]);
    frames.assign(before.frames.begin(), before.frames.begin() + before.told[1]);
    warnings.assign(before.warnings.begin(), before.warnings.begin() + before.told[2]);
  }

  std::vector<SeriesRow> rows;
  std::vector<CellField> frames;
  std::vector<std::string> warnings;
  MemoryArchive state;  ///< of the last checkpoint
  std::array<std::ptrdiff_t, 3> told{};

 private:
  Simulation& simulation_;
  long break_at_, step_ = -1;
  std::vector<long> spoil_;
};

std::vector<double> numbers_of(const SeriesRow& r) {
  std::vector<double> all{r.step.t,
                          double(r.step.step),
                          r.step.dt,
                          double(r.step.limit),
                          r.mass,
                          r.outflow,
                          r.fed.value_or(-1),
                          r.quasi_static_fraction,
                          r.ill_posed_fraction,
                          r.max_speed,
                          r.step.max_divergence,
                          r.step.max_speed,
                          double(r.step.capped_cells),
                          double(r.step.pressure.iterations),
                          double(r.step.viscous.iterations),
                          double(r.step.fluidity.iterations)};
  for (const auto* more : {&r.orifice_outflow, &r.material_mass, &r.material_outflow})
    all.insert(all.end(), more->begin(), more->end());
  return all;
}

std::vector<double> numbers_of(const Summary& s) {
  return {double(s.status),
          s.discharge_rate,
          s.discharge_constant,
          s.discharge_window[0],
          s.discharge_window[1],
          s.quasi_static_fraction,
          s.mass_error,
          s.worst_max_divergence,
          double(s.back_offs),
          double(s.missed_tolerances),
          double(s.steps),
          double(s.mass_over_time.size()),
          double(s.warnings.size())};
}

/// The run without a break, and the same broken off after each of the steps `breaks`, where it goes on in a new simulation.
void compare(const Scene& scene, const std::vector<long>& breaks, const std::vector<long>& spoil = {},
             const std::vector<int>& threads = {}) {
  Simulation whole(scene);
  Witness expected(whole, -1, spoil);
  const Summary expected_summary = whole.run({&expected});
  REQUIRE(expected_summary.steps > breaks.back());
  INFO(expected_summary.reason);

  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<Witness> witness;
  Summary summary;
  for (std::size_t part = 0; part <= breaks.size(); ++part) {
    Scene same = scene;
    if (!threads.empty()) same.threads = threads[part % threads.size()];
    auto next = std::make_unique<Simulation>(same);
    const long first = part == 0 ? 0 : breaks[part - 1];
    std::vector<long> to_spoil;
    for (const long step : spoil)
      if (step > first) to_spoil.push_back(step);
    auto seen = std::make_unique<Witness>(*next, part < breaks.size() ? breaks[part] : -1, to_spoil);
    if (part > 0) {
      seen->take_over(*witness);
      witness->state.restore = true;
    }
    summary = next->run({seen.get()}, part > 0 ? &witness->state : nullptr);
    if (part < breaks.size()) {
      REQUIRE(summary.status == Status::interrupted);
      REQUIRE(summary.reason == "broken off");
    }
    simulation = std::move(next);
    witness = std::move(seen);
  }

  CHECK(witness->state.differences(expected.state) == std::vector<std::string>{});
  CHECK(numbers_of(summary) == numbers_of(expected_summary));
  CHECK(summary.reason == expected_summary.reason);
  CHECK(summary.warnings == expected_summary.warnings);
  CHECK(witness->warnings == expected.warnings);
  REQUIRE(witness->rows.size() == expected.rows.size());
  for (std::size_t k = 0; k < expected.rows.size(); ++k) {
    INFO("row " << k);
    CHECK(numbers_of(witness->rows[k]) == numbers_of(expected.rows[k]));
  }
  REQUIRE(witness->frames.size() == expected.frames.size());
  REQUIRE(expected.frames.size() > 1);
  for (std::size_t k = 0; k < expected.frames.size(); ++k)
    CHECK(same_bits(witness->frames[k], expected.frames[k]));
}

Scene short_silo() {
  Scene s = silo(32);
  s.fill = {fill_box(0, 0, 150, 0, 100)};
  s.time.max_steps = 60;
  s.output.series_every = 0.3;
  s.output.fields_every = 1;
  return s;
}

struct Variant {
  const char* name;
  std::function<void(Scene&)> change;
};

Material second(double mu_s) {
  Material m = well_posed_grains();
  m.name = "other";
  m.mu_s = mu_s;
  return m;
}

const std::vector<Variant> variants{
    {"plain", [](Scene&) {}},
    {"steps that grow", [](Scene& s) { s.time.dt_max = 10; }},
    {"air none", [](Scene& s) { s.air.model = AirModel::none; }},
    {"air none, few grains, rows left out",
     [](Scene& s) {
       s.air.model = AirModel::none;
       s.fill = {fill_box(0, 0, 150, 0, 40)};
       s.orifices = {{Side::bottom, 75, 75}};
       s.time.max_steps = 120;
     }},
    {"two materials, one heavier",
     [](Scene& s) {
       s.materials.push_back(second(0.4));
       s.materials[1].density = 1.5;
       s.fill.push_back(fill_box(1, 0, 60, 30, 100));
     }},
    {"nonlocal", [](Scene& s) { s.nonlocal = Nonlocal{}; }},
    {"nonlocal by kamrin",
     [](Scene& s) {
       s.nonlocal = Nonlocal{.closure = Closure::kamrin};
       s.materials[0] = well_posed_grains();
     }},
    {"dilatancy source", [](Scene& s) { s.dilatancy = Dilatancy{}; }},
    {"dilatancy relax", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::relax}; }},
    {"dilatancy weight", [](Scene& s) { s.dilatancy = Dilatancy{.mode = DilatancyMode::weight}; }},
    {"wall friction", [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167}; }},
    {"wall friction as a limiter",
     [](Scene& s) { s.wall_friction = WallFriction{.F = 0.0167, .mode = FrictionMode::limiter}; }},
    {"every module",
     [](Scene& s) {
       s.nonlocal = Nonlocal{};
       s.dilatancy = Dilatancy{};
       s.wall_friction = WallFriction{.F = 0.0167};
       s.materials.push_back(second(0.4));
       s.fill.push_back(fill_box(1, 0, 150, 50, 100));
     }},
    {"feed",
     [](Scene& s) {
       s.feed = Feed{0, 100};
       s.stop.steady_discharge = 1e-3;
     }},
    {"solids",
     [](Scene& s) {
       s.inserts = {insert_of(Shape::circle, 75, 50, 30, 30)};
       s.hopper = Hopper{.half_angle = 45, .outlet = 28.125};
       s.orifices = {{Side::bottom, 75, 28.125}};
     }},
    {"solids without air",
     [](Scene& s) {
       s.inserts = {insert_of(Shape::circle, 75, 50, 30, 30)};
       s.air.model = AirModel::none;
     }},
    {"mirror",
     [](Scene& s) {
       s.symmetry = Symmetry::mirror;
       s.walls[0] = Wall::free_slip;
       s.orifices = {{Side::bottom, 0, 18.75}};
     }},
    {"axisymmetric",
     [](Scene& s) {
       s.coordinates = Coordinates::axisymmetric;
       s.walls[0] = Wall::free_slip;
       s.orifices = {{Side::bottom, 0, 37.5}};
     }},
    {"periodic slope",
     [](Scene& s) {
       s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::open};
       s.gravity = {0.5, -0.8};
       s.orifices.clear();
     }},
    {"splitting repeated",
     [](Scene& s) {
       s.accuracy.splitting.outer = 2;
       s.accuracy.splitting.picard = 2;
     }},
    {"full precision", [](Scene& s) { s.accuracy.precision = Precision::full; }},
    {"regularised law, smooth cap",
     [](Scene& s) {
       s.rheology.law = Law::mu_I_regularised;
       s.rheology.cap = Cap::smooth;
       s.materials[0] = well_posed_grains();
     }},
    {"no state to go back to", [](Scene& s) { s.accuracy.backup_every = 0; }},
};

}  // namespace

TEST_CASE("a run broken off and resumed equals one without a break to the last bit") {
  for (const Variant& variant : variants) {
    Scene scene = short_silo();
    variant.change(scene);
    INFO(variant.name);
    compare(scene, {1, 23});
  }
}

TEST_CASE("a run that goes back and on with smaller steps resumes to the last bit on every rung") {
  Scene scene = short_silo();
  scene.time.max_steps = 150;
  compare(scene, {25, 41, 60, 61, 100}, {20, 40, 55, 58});
  scene.output.series_every = scene.output.fields_every = 3;  // to a state kept before the break
  compare(scene, {25, 60}, {27, 61});
}

TEST_CASE("on other numbers of threads a resumed run has the same bits") {
  Scene scene = short_silo();
  scene.nonlocal = Nonlocal{};
  scene.dilatancy = Dilatancy{};
  compare(scene, {10, 30}, {}, {1, 2, 3});
}

TEST_CASE("a run resumed at its own end is at its end; with a later one it goes on") {
  Scene scene = short_silo();
  scene.stop.mass_below = 0.99;
  scene.time.max_steps = 0;
  scene.time.end = 40;
  Simulation whole(scene);
  Witness first(whole);
  REQUIRE(whole.run({&first}).status == Status::stopped);
  const long steps = whole.steps();
  first.state.restore = true;
  Simulation again(scene);
  Witness second(again);
  const Summary summary = again.run({&second}, &first.state);
  CHECK(summary.status == Status::stopped);
  CHECK(again.steps() == steps);

  scene.stop.mass_below.reset();
  scene.time.end = 2;
  scene.output.fields_every = 0.7;
  Simulation part(scene);
  Witness before(part);
  REQUIRE(part.run({&before}).status == Status::finished);
  REQUIRE(before.rows.size() ==
          static_cast<std::size_t>(before.told[0]) + 1);  // the end is told after the checkpoint
  REQUIRE(before.frames.size() == static_cast<std::size_t>(before.told[1]) + 1);
  before.state.restore = true;
  Simulation killed(scene);  // in between
  Witness end(killed);
  CHECK(killed.run({&end}, &before.state).status == Status::finished);
  REQUIRE(end.rows.size() == 1);
  REQUIRE(end.frames.size() == 1);
  CHECK(numbers_of(end.rows[0]) == numbers_of(before.rows.back()));
  CHECK(same_bits(end.frames[0], before.frames.back()));

  scene.time.end = 3;
  Simulation longer(scene);
  Witness after(longer);
  CHECK(longer.run({&after}, &before.state).status == Status::finished);
  CHECK(longer.t() == 3);
  CHECK(longer.steps() > part.steps());
}
