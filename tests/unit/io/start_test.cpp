#include "io/start.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "io/scene_yaml.hpp"
#include "io/xdmf.hpp"
#include "solver/diagnostics.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

/// A folder with the frames of a run, at these times and where it ends.
class StoredRun {
 public:
  StoredRun(Scene scene, double frames_every, std::vector<std::string> fields)
      : folder_(fs::temp_directory_path() / "hourglass_start_test") {
    fs::create_directories(folder_);
    scene.output.fields_every = frames_every;
    struct Store : Observer {
      Store(const fs::path& folder, const Scene& s, std::vector<std::string> f)
          : writer(folder, info_of(s)), names(std::move(f)) {}
      void on_fields(const Simulation& s) override { writer.write(frame_of(s, names)); }
      FieldWriter writer;
      std::vector<std::string> names;
    } store(folder_, scene, std::move(fields));
    simulation = std::make_unique<Simulation>(scene);
    summary = simulation->run({&store});
  }
  ~StoredRun() { fs::remove_all(folder_); }
  std::string path() const { return folder_.string(); }

  std::unique_ptr<Simulation> simulation;  // at the end
  Summary summary;

 private:
  fs::path folder_;
};

/// The upper half is another sand.
Scene two_sands(int cells, double end) {
  Scene s = silo(cells, end);
  s.materials.push_back(s.materials[0]);
  s.materials[1].name = "upper";
  s.fill.push_back(fill_box(1, 0, 150, 67, 135));
  return s;
}

double furthest(const CellField& a, const CellField& b) {
  double d = 0;
  for (int j = 0; j < a.ny(); ++j)
    for (int i = 0; i < a.nx(); ++i) d = std::max(d, std::abs(a(i, j) - b(i, j)));
  return d;
}

/// What is wrong with starting this scene from that run.
std::string refusal(Scene scene, const std::string& run) {
  scene.start = Start{run};
  try {
    start_time(scene);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE(
    "start: a run begins as another ended, on the same grid to what is stored, on others with the same "
    "masses") {
  const StoredRun run(two_sands(32, 8), 4, {"grains", "pressure", "tracer"});
  for (const int cells : {16, 32, 48, 64}) {
    INFO(cells << " cells across");
    Scene scene = two_sands(cells, 1);
    scene.fill.clear();
    scene.start = Start{run.path()};
    scene.output.series_every = 1;
    for (const Problem& p : check(scene)) CHECK_FALSE(p.fatal);
    CHECK(start_time(scene) == 8);
    Simulation simulation(scene);
    begin(simulation);
    CHECK(simulation.t() == 0);
    const FieldReader reader(run.path());
    const Frame frame = reader.read(static_cast<int>(reader.times().size()) - 1, {"grains", "tracer"});
    const std::vector<double> masses = simulation.material_mass();
    double grains = 0, upper = 0;
    const CellField &c = frame.field("grains"), &share = frame.field("tracer");
    const double area = c.patch().h * c.patch().h;
    for (int j = 0; j < c.ny(); ++j)
      for (int i = 0; i < c.nx(); ++i) grains += c(i, j) * area, upper += c(i, j) * share(i, j) * area;
    CHECK(masses[0] + masses[1] == Approx(grains).epsilon(1e-12));
    CHECK(masses[1] == Approx(upper).epsilon(1e-12));
    if (cells == 32) {
      const Fields &now = simulation.fields(), &then = run.simulation->fields();
      CHECK(furthest(now.grains, then.grains) < 1e-7);  // single precision
      CHECK(furthest(now.tracers[0], then.tracers[0]) < 2e-7);
      CHECK(furthest(now.p, then.p) < 1e-7 * 150);
    }
  }
}

TEST_CASE("start: more than two materials are stored each by itself") {
  Scene scene = two_sands(32, 4);
  scene.materials.push_back(scene.materials[1]);
  scene.materials[2].name = "top";
  scene.fill.push_back(fill_box(2, 30, 90, 90, 135));
  const StoredRun run(scene, 4, {"grains", "pressure", "tracer_1", "tracer_2"});
  scene.start = Start{run.path()};
  Simulation simulation(scene);
  begin(simulation);
  for (const std::size_t k : {0, 1})
    CHECK(furthest(simulation.fields().tracers[k], run.simulation->fields().tracers[k]) < 2e-7);
  const std::vector<double> before = run.simulation->material_mass(), after = simulation.material_mass();
  for (std::size_t k = 0; k < 3; ++k) CHECK(after[k] == Approx(before[k]).epsilon(1e-7));
}

TEST_CASE("start: dilated grains keep their mass, but where half-empty cells have no packing") {
  Scene scene = silo(32, 4);
  scene.dilatancy = Dilatancy{};
  const StoredRun run(scene, 4, {"grains", "pressure", "packing"});
  scene.start = Start{run.path()};
  for (const int cells : {16, 32, 64}) {
    scene.cells_x = cells;
    Simulation simulation(scene);
    begin(simulation);
    INFO(cells << " cells across");
    CHECK(simulation.grain_mass() == Approx(run.simulation->grain_mass()).epsilon(5e-4));
  }
}

TEST_CASE("start: the frame nearest to the time is taken") {
  const StoredRun run(silo(16, 5), 2, {"grains", "pressure"});
  Scene scene = silo(16, 1);
  // A frame is stored after the first step that passes its time.
  const std::pair<double, double> asked_and_taken[] = {{0, 0}, {1.1, 2}, {3.9, 4}, {99, 5}};
  for (const auto& [asked, taken] : asked_and_taken) {
    scene.start = Start{run.path(), asked};
    CHECK(start_time(scene) == Approx(taken).margin(scene.time.dt_max));
  }
}

TEST_CASE("start: the discharge goes on without a start-up") {
  const double then = 22, end = 44;
  const StoredRun run(silo(64, end), then, {"grains", "pressure"});
  const double unbroken = loss_rate(run.summary.mass_over_time, then, end);
  Scene scene = silo(64, end - then);
  scene.start = Start{run.path(), then};
  scene.start->time = start_time(scene);
  Simulation simulation(scene);
  begin(simulation);
  const Summary summary = simulation.run();
  CHECK(summary.discharge_window[0] == 0);
  CHECK(summary.discharge_rate == Approx(unbroken).epsilon(0.02));
  CHECK(loss_rate(summary.mass_over_time, 0, 3) ==
        Approx(unbroken).epsilon(0.05));  // from the first moment on
  CHECK(summary.mass_error < 1e-6);
}

TEST_CASE("start: what does not fit is refused in a sentence") {
  const StoredRun run(silo(16, 1), 1, {"grains"});
  const Scene scene = silo(16, 1);
  CHECK_THAT(
      refusal(scene, run.path()),
      Catch::Contains("does not hold the field pressure; run it with grains, pressure among output.fields"));
  CHECK_THAT(refusal(scene, run.path() + "/none"), Catch::Contains("none/fields.h5"));
  CHECK_THAT(refusal(scene, ""), Catch::Contains("needs run"));
  Scene other = scene;
  other.height = 140.625;
  CHECK_THAT(refusal(other, run.path()), Catch::Contains("150 x 150, not of 150 x 140.625"));
  CHECK_THAT(refusal(two_sands(16, 1), run.path()),
             Catch::Contains("the materials sand; the scene has sand, upper"));
  other = scene;
  other.symmetry = Symmetry::mirror;
  CHECK_THAT(refusal(other, run.path()), Catch::Contains("symmetry"));
}

TEST_CASE("start: in a scene file, which needs no fill and is resolved with the time of the frame") {
  const StoredRun run(silo(16, 1), 0.5, {"grains", "pressure"});
  const fs::path file = fs::path(run.path()) / "again.yaml";
  const auto load = [&](const std::string& start) {
    std::ofstream(file)
        << "domain: {width: 150, height: 150}\ngrid: {cells_x: 32}\nmaterials:\n  sand: {mu_s: 0.32, "
           "delta_mu: 0.28, I_0: 0.4}\norifices:\n  - {centre: 75, width: 37.5}\ntime: {end: 1}\n"
        << start << '\n';
    return load_scene(file);
  };
  const Loaded loaded = load("start: {run: '" + run.path() + "'}");
  for (const Diagnostic& d : loaded.diagnostics) CHECK(d.text().empty());
  REQUIRE(loaded.ok());
  CHECK(loaded.scene.start == Start{run.path(), 1.0});
  std::ofstream(file) << to_yaml(loaded.scene);
  CHECK(load_scene(file).scene == loaded.scene);
  const Loaded wrong = load("start: {run: nowhere}");
  REQUIRE(wrong.diagnostics.size() == 1);
  CHECK_THAT(wrong.diagnostics[0].text(), Catch::Contains("again.yaml:8 start: nowhere/fields.h5"));
}
