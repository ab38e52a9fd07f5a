// What scene files say is what the scene gets, and what is written of it reads as the same.
#include "io/scene_yaml.hpp"

#include <fmt/format.h>

#include "solver/scene_keys.hpp"
#include "tests/support/scene_file.hpp"

using namespace hourglass;

namespace {

std::vector<fs::path> configs() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::recursive_directory_iterator(root / "configs"))
    if (const fs::path folder = entry.path().parent_path().filename();
        entry.path().extension() == ".yaml" && folder != "studies" && folder != "figures")
      all.push_back(entry.path());
  return all;
}

}  // namespace

TEST_CASE("every config is clean but for warnings, and its resolved scene reads back equal") {
  REQUIRE(configs().size() >= 7);
  for (const fs::path& config : configs()) {
    const Loaded loaded = load_scene(config);
    INFO(config << "\n" << messages(loaded));
    REQUIRE(loaded.ok());
    const File resolved(to_yaml(loaded.scene));
    const Loaded again = load_scene(resolved.path());
    INFO(messages(again));
    REQUIRE(again.ok());
    CHECK(again.scene == loaded.scene);
    CHECK(to_yaml(again.scene) == to_yaml(loaded.scene));
  }
}

TEST_CASE("awkward values survive the round trip") {
  Scene s = load_scene(root / "configs" / "silo.yaml").scene;
  s.name = "it's 1: #5";
  s.materials[0].mu_s = 0.1 + 0.2;
  s.stop = {};
  s.orifices.clear();
  s.output.fields.clear();
  s.fill.push_back({-1, {{0, 0}, {10, 0}, {1. / 3, 8}}});
  s.time.max_steps = 123456789;
  const File file(to_yaml(s));
  const Loaded again = load_scene(file.path());
  INFO(messages(again));
  CHECK(again.ok());
  CHECK(again.scene == s);
}

TEST_CASE("defaults follow the scales of the first material") {
  const File file(
      "units: SI\n"
      "domain: {width: 0.15, height: 0.15}\n"
      "grid: {cells_x: 128}\n"
      "gravity: [0, -10]\n"
      "materials: {sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4, diameter: 1e-3, density: 1500}}\n"
      "fill: [{material: sand, box: {x: [0, 0.15], y: [0, 0.1]}}]\n"
      "time: {end: 1, dt_max: 0.5}\n");
  const Loaded loaded = load_scene(file.path());
  INFO(messages(loaded));
  REQUIRE(loaded.diagnostics.empty());
  const double eta = 1500 * std::sqrt(10 * 1e-9);  // rho sqrt(g d^3)
  CHECK(loaded.scene.name == "bad");               // the file's
  CHECK(loaded.scene.rheology.eta_min == Approx(eta));
  CHECK(loaded.scene.rheology.eta_max == Approx(1.643e6 * eta));
  CHECK(loaded.scene.rheology.smoothing_length == Approx(5e-4));
  CHECK(loaded.scene.air.density == Approx(1.5));
  CHECK(loaded.scene.air.viscosity == Approx(0.0164 * eta));
  CHECK(loaded.scene.time.dt_max == 0.5);  // as given
  CHECK(loaded.scene.output.series_every == Approx(0.27e-2));
  CHECK(loaded.scene.output.fields_every == Approx(5.48e-2));
  CHECK(loaded.scene.output.snapshots_every == Approx(5.48e-2));
  CHECK(loaded.scene.walls == Scene{}.walls);
}

TEST_CASE("SI has no default for gravity and grains; zero gravity none for what scales with it") {
  const File file("units: SI\n" + sound_with(0, ""));
  const std::string all = messages(load_scene(file.path()));
  for (const char* key :
       {"gravity: is missing", "materials.sand.diameter: is missing", "materials.sand.density: is missing"})
    CHECK_THAT(all, Catch::Contains(key));
  expect(11, "gravity: [0, 0]", {"bad.yaml:11 gravity: is zero", "time.dt_max", "physics.rheology.eta_max"});
}

TEST_CASE("words of accuracy") {
  const File file(sound_with(0, ""));
  const auto with = [&](const std::string& word) {
    return load_scene(file.path(), {"accuracy=" + word}).scene.accuracy;
  };
  CHECK(with("fast") == Accuracy{.viscous_tolerance = 5e-3,
                                 .pressure_tolerance = 1e-5,
                                 .fluidity_tolerance = 3e-2,
                                 .cells_across_orifice = 6});
  CHECK(with("balanced") == Accuracy{});
  const Accuracy accurate{.viscous_tolerance = 1e-4,
                          .pressure_tolerance = 1e-8,
                          .fluidity_tolerance = 1e-3,
                          .cells_across_orifice = 32,
                          .extrapolate = 2};
  CHECK(with("accurate") == accurate);
  CHECK(with("{precision: full}") == Accuracy{.precision = Precision::full});
  expect(11, "accuracy: fst",
         {"bad.yaml:11 accuracy:", "'fst'", "fast, balanced, accurate", "Did you mean 'fast'?"});
}

TEST_CASE("a word of accuracy may be changed in part") {
  const File file(sound_with(11, "accuracy: fast"));
  const auto with = [&](const std::vector<std::string>& overrides) {
    const Loaded loaded = load_scene(file.path(), overrides);
    INFO(messages(loaded));
    CHECK(loaded.ok());
    return loaded.scene.accuracy;
  };
  const auto in_double = [](Accuracy accuracy) {
    accuracy.precision = Precision::full;
    return accuracy;
  };
  const Accuracy fast_in_double = in_double(accuracy_presets[0]);
  CHECK(with({"accuracy.precision=full"}) == fast_in_double);
  CHECK(with({"accuracy={precision: full, preset: fast}"}) == fast_in_double);
  CHECK(with({"accuracy=balanced", "accuracy.precision=full"}) == in_double(accuracy_presets[1]));
  CHECK(with({"accuracy.precision=full", "accuracy=accurate"}) == accuracy_presets[2]);
  CHECK(with({"accuracy.precision=full", "accuracy.preset=accurate"}) == in_double(accuracy_presets[2]));
  CHECK_THAT(messages(load_scene(file.path(), {"accuracy.precison=full"})),
             Catch::Contains("--set accuracy.precison=full accuracy.precison: unknown key. Did you mean"));
}

TEST_CASE("a preset of accuracy is one of its words") {
  expect(11, "accuracy: {preset: fst}", {"bad.yaml:11 accuracy.preset:", "'fst'", "Did you mean 'fast'?"});
  expect(11, "accuracy: {preset: [fast]}", {"bad.yaml:11 accuracy.preset:", "a list"});
}

TEST_CASE("without grid.cells_x accuracy decides, by the narrowest opening") {
  const auto cells = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    const File file(text);
    const Loaded loaded = load_scene(file.path(), overrides);
    INFO(messages(loaded));
    CHECK(loaded.ok());
    REQUIRE(loaded.notes.size() == 1);
    CHECK_THAT(loaded.notes[0],
               Catch::Contains(fmt::format("grid.cells_x: {} chosen", loaded.scene.cells_x)));
    const File resolved(to_yaml(loaded.scene));  // which names it
    const Loaded again = load_scene(resolved.path());
    CHECK(again.notes.empty());
    CHECK(again.scene == loaded.scene);
    return loaded.scene.cells_x;
  };
  const std::string silo = sound_with(3, "");
  CHECK(cells(silo, {"accuracy=fast"}) == 48);
  CHECK(cells(silo) == 128);
  CHECK(cells(silo, {"accuracy={preset: accurate, extrapolate: 0}"}) == 256);
  CHECK(cells(silo, {"accuracy={cells_across_orifice: 10}"}) == 80);
  CHECK(cells(silo, {"orifices.0.width=10"}) == 240);
  CHECK(cells(silo, {"orifices.0.width=1"}) == 1024);  // the most
  CHECK(cells(silo, {"domain.height=140"}) == 240);    // 128 would be 119.5 cells high
  CHECK(cells(sound_with(3, "") + "inserts: []\n", {"orifices=[]", "accuracy=fast"}) == 48);
  CHECK(cells(silo, {"orifices=[]"}) == 128);
  CHECK(cells(silo, {"orifices=[]", "accuracy={preset: accurate, extrapolate: 0}"}) == 256);
  CHECK(cells(sound_with(3, "hopper: {half_angle: 30, outlet: 30}"), {"orifices=[]"}) == 80);
  const File named(sound_with(0, ""));
  CHECK(load_scene(named.path(), {"accuracy=fast"}).notes.empty());
  CHECK(load_scene(named.path(), {"accuracy=fast"}).scene.cells_x == 128);
  expect(3, "grid: {cells_x: 0}", {"bad.yaml:3 grid.cells_x: 0 is out of range (must be >= 2)"});
  const File awkward(sound_with(3, ""));
  CHECK_THAT(messages(load_scene(awkward.path(), {"domain.height=149.999"})),
             Catch::Contains("grid.cells_x: is missing, and near what accuracy asks for"));
}

TEST_CASE("modules are on when they are named, with their defaults, and written when they are on") {
  const auto with = [](const std::vector<std::string>& overrides) {
    return round_trip("", overrides, Doubts::allowed);
  };
  const Scene plain = with({});
  CHECK_FALSE(plain.nonlocal);
  CHECK_FALSE(plain.dilatancy);
  CHECK_FALSE(plain.wall_friction);
  CHECK_THAT(to_yaml(plain), !Catch::Contains("nonlocal") && !Catch::Contains("dilatancy"));
  CHECK(with({"physics={nonlocal: }"}).nonlocal == Nonlocal{});
  CHECK(with({"physics.nonlocal={A: 2, closure: kamrin, walls: no_flux}"}).nonlocal ==
        Nonlocal{2, Closure::kamrin, FluidityWall::no_flux});
  CHECK(with({"physics.dilatancy.mode=relax"}).dilatancy->mode == DilatancyMode::relax);
  CHECK(with({"physics.wall_friction={mu_w: 0.4, gap: 8}"}).wall_friction->strength() == Approx(0.1));
  const Scene own = with({"physics.nonlocal.A=0.5", "materials.sand.A=0.25"});
  CHECK(own.materials[0].A == 0.25);
  expect(11, "physics: {wall_friction: {}}",
         {"bad.yaml:11 physics.wall_friction: its strength is to be given once"});
  expect(11, "physics: {wall_friction: {F: 1, gap: 2}}", {"physics.wall_friction: its strength"});
  expect(11, "physics: {dilatancy: {phi_min: 0.7}}", {"physics.dilatancy.phi_min: 0.7 is out of range"});
}

TEST_CASE("inserts: keys by shape, and the round trip") {
  const auto with = [](const std::string& text) { return round_trip(text).inserts; };
  const auto insert = [](Shape shape, double width, double height) {
    return Insert{.shape = shape, .centre = {75, 60}, .width = width, .height = height, .points = {}};
  };
  CHECK(with("inserts: []").empty());
  CHECK(with("inserts: [{shape: square, centre: [75, 60], width: 20}]") ==
        std::vector{insert(Shape::square, 20, 20)});
  CHECK(with("inserts: [{shape: square, centre: [75, 60], width: 20, height: 20}]") ==
        std::vector{insert(Shape::square, 20, 20)});
  CHECK(with("inserts: [{shape: circle, centre: [75, 60], diameter: 20}]") ==
        std::vector{insert(Shape::circle, 20, 20)});
  CHECK(with("inserts: [{shape: circle, centre: [75, 60], width: 20}]") ==
        std::vector{insert(Shape::circle, 20, 20)});
  for (const Shape shape : {Shape::rectangle, Shape::diamond, Shape::triangle_up, Shape::triangle_down})
    CHECK(with(std::string("inserts: [{shape: ") + shape_names[static_cast<int>(shape)] +
               ", centre: [75, 60], width: 30, height: 20}]") == std::vector{insert(shape, 30, 20)});
  const std::vector<Insert> both = with(
      "inserts: [{shape: polygon, points: [[60, 60], [90, 60], [75, 90.125]]}, {shape: circle, centre: [75, "
      "40], "
      "diameter: 20}]");
  REQUIRE(both.size() == 2);
  CHECK(both[0].points == std::vector<std::array<double, 2>>{{60, 60}, {90, 60}, {75, 90.125}});

  expect(11, "inserts: [{shape: circle, centre: [75, 60], diameter: 20, height: 20}]",
         {"bad.yaml:11 inserts.0.height: does not belong to a circle (which has shape, centre, diameter). "
          "Remove it."});
  expect(11, "inserts: [{shape: circle, centre: [75, 60], diameter: 20, width: 20}]",
         {"inserts.0.width: does not belong to a circle"});
  expect(11, "inserts: [{shape: diamond, centre: [75, 60], width: 20, height: 20, points: []}]",
         {"inserts.0.points: does not belong to a diamond"});
  expect(11, "inserts: [{shape: polygon, points: [[60, 60], [90, 60], [75, 90]], centre: [75, 60]}]",
         {"inserts.0.centre: does not belong to a polygon (which has shape, points)"});
  expect(11, "inserts: [{shape: square, centre: [75, 60], width: 20, height: 30}]",
         {"inserts.0.height: 30 is not the width, 20. Use shape rectangle."});
  expect(11, "inserts: [{shape: circle, centre: [75, 60]}]", {"inserts.0.diameter: is missing (above 0)"});
  expect(11, "inserts: [{shape: diamond, centre: [75, 60], width: 20}]", {"inserts.0.height: is missing"});
  expect(11, "inserts: [{shape: diamond, width: 20, height: 20}]", {"inserts.0.centre: is missing"});
  expect(11, "inserts: [{shape: polygon}]", {"inserts.0.points: is missing (its corners in order"});
  expect(11, "inserts: [{centre: [75, 60], width: 20}]",
         {"inserts.0.shape: is missing (a word, e.g. circle)"});
  expect(11, "inserts: [{shape: circl, centre: [75, 60], diameter: 20}]",
         {"inserts.0.shape: found the text 'circl' (allowed: square, rectangle", "Did you mean 'circle'?"});
  expect(11, "inserts: [{shape: circle, centre: [75, 60], diametre: 20, diameter: 20}]",
         {"inserts.0.diametre: unknown key. Did you mean 'diameter'?"});
  expect(11, "inserts: [{shape: circle, centre: [75, 60], diameter: .nan}]", {"is not a finite number"});
  expect(11, "inserts: [{shape: circle, centre: [275, 60], diameter: 20}]",
         {"bad.yaml:11 inserts.0: lies outside the domain"});
}

TEST_CASE("hopper, feed, symmetry, coordinates, air and solids models: read, written, read again") {
  const auto with = [](const std::vector<std::string>& overrides) { return round_trip("", overrides); };
  const Scene plain = with({});
  CHECK_FALSE(plain.hopper);
  CHECK_FALSE(plain.feed);
  CHECK_THAT(to_yaml(plain), !Catch::Contains("hopper") && !Catch::Contains("feed"));
  CHECK(with({"hopper={half_angle: 40, outlet: 20}"}).hopper == Hopper{40, 20});
  const Scene hopper = with({"hopper={half_angle: 40, outlet: 20}", "orifices=[]"});
  CHECK(hopper.orifices == std::vector{Orifice{Side::bottom, 75, 20}});  // which to_yaml shows
  CHECK(with({"feed={material: sand, level: 120}"}).feed == Feed{0, 120});
  CHECK(with({"air.model=none"}).air.model == AirModel::none);
  CHECK(with({"accuracy.solids=staircase"}).accuracy.solids == SolidModel::staircase);
  CHECK(plain.wall(Side::left) == Wall::no_slip);
  for (const char* half : {"domain.symmetry=mirror", "domain.coordinates=axisymmetric"}) {
    const Scene s = with({half, "orifices.0.centre=0"});
    CHECK(s.left_is_middle());
    CHECK(s.wall(Side::left) == Wall::free_slip);
  }
  CHECK(with({"domain.coordinates=axisymmetric", "hopper={half_angle: 40, outlet: 20}", "orifices=[]"})
            .orifices == std::vector{Orifice{Side::bottom, 0, 20}});

  expect(11, "hopper: {half_angle: 40}", {"bad.yaml:11 hopper.outlet: is missing"});
  expect(11, "hopper: {outlet: 20, half_angle: 90}", {"hopper.half_angle: 90 is out of range"});
  const File narrow("hopper: {half_angle: 40, outlet: 1.5}\n" +
                    sound_with(9, "  - {wall: right, centre: 130, width: 18.75}"));
  CHECK_THAT(messages(load_scene(narrow.path())),
             Catch::Contains("bad.yaml:1 hopper.outlet: the neck is 1.28 cells wide"));
  expect(11, "feed: {level: 100}", {"bad.yaml:11 feed.material: is missing (the name of a material)"});
  expect(11, "feed: {material: gravel, level: 100}", {"feed.material: found the text 'gravel'"});
  expect(11, "feed: {material: air, level: 100}", {"feed.material: is not a material"});
  expect(11, "feed: {material: sand, level: 200}", {"feed.level: 200 is out of range"});
  expect(11, "air: {model: thick}", {"air.model: found the text 'thick' (allowed: passive, none)"});
  expect(11, "accuracy: {solids: round}",
         {"accuracy.solids: found the text 'round'", "cut_cells, staircase"});
  expect(2, "domain: {width: 150, height: 150, symmetry: mirrored}",
         {"domain.symmetry: found the text 'mirrored'", "Did you mean 'mirror'?"});
  const File file(
      sound_with(2, "domain: {width: 150, height: 150, symmetry: mirror}\nwalls: {left: no_slip}"));
  CHECK_THAT(messages(load_scene(file.path())),
             Catch::Contains("bad.yaml:3 walls.left: is no_slip, but the left edge is the mirror plane"));
}

TEST_CASE("models in closed form: read with their defaults, written, read again; refusals with their place") {
  const auto with = [](const std::vector<std::string>& overrides) {
    std::vector<std::string> all{"time={}"};  // which they do not use
    all.insert(all.end(), overrides.begin(), overrides.end());
    return round_trip("", all, Doubts::allowed);
  };
  const Scene kinematic = with({"model=kinematic"});
  CHECK(kinematic.model == Model::kinematic);
  CHECK(kinematic.kinematic->B == 2.0);
  CHECK(*kinematic.kinematic->Q == Approx(std::pow(18.75, 1.5)).epsilon(1e-14));
  CHECK_THAT(to_yaml(kinematic), Catch::Contains("kinematic:\n  B: 2\n") && !Catch::Contains("radial:"));
  CHECK(with({"model=kinematic", "kinematic={B: 3, Q: 90, orifices: point}"}).kinematic ==
        Kinematic{3, 90, OrificeForm::point});
  CHECK(with({"model=stochastic", "stochastic={L_s: 5, Q: 90, spot: 4}"}).stochastic ==
        Stochastic{5, 90, OrificeForm::slot, 4});
  CHECK(with({"model=radial", "radial={phi: 30, phi_w: 10, half_angle: 20, Q: 9}"}).radial ==
        Radial{30, 10, 20, 9, WallAngle::friction});
  const Scene hopper =
      with({"model=radial", "radial={phi: 30}", "hopper={half_angle: 20, outlet: 20}", "orifices=[]"});
  CHECK(hopper.radial->half_angle == 20.0);
  CHECK(hopper.radial->phi_w == 15.0);
  CHECK(with({"model=mu_I", "time.end=1"}).model == Model::mu_I);

  expect(11, "model: kinetic",
         {"bad.yaml:11 model: found the text 'kinetic' (allowed: mu_I, kinematic, stochastic, radial)",
          "Did you mean 'kinematic'?"});
  const auto refused = [](const std::string& more, const std::string& words) {
    const File file(sound_with(11, "model: kinematic\n" + more));
    const Loaded loaded = load_scene(file.path());
    CHECK_FALSE(loaded.ok());
    CHECK_THAT(messages(loaded), Catch::Contains("bad.yaml:12 " + words));
  };
  refused("kinematic: {B: 0}", "kinematic.B: 0 is out of range (must be > 0). 2 d is usual.");
  refused("kinematic: {b: 2}", "kinematic.b: unknown key. Did you mean 'B'?");
  refused("kinematic: {orifices: line}", "kinematic.orifices: found the text 'line' (allowed: slot, point)");
  refused("inserts: [{shape: circle, centre: [75, 60], diameter: 20}]",
          "inserts: model kinematic cannot have solids");
  refused("physics: {nonlocal: {}}", "physics.nonlocal: model kinematic cannot have granular fluidity");
}
