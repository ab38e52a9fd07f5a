// What is said of scene files that cannot be read, or are wrong.
#include "tests/support/scene_file.hpp"

using namespace hourglass;

namespace {

void expect_set(const std::string& override, const std::vector<std::string>& parts) {
  const File file(sound_with(0, ""));
  const Loaded loaded = load_scene(file.path(), {override});
  INFO(messages(loaded));
  REQUIRE(loaded.diagnostics.size() == 1);
  CHECK_FALSE(loaded.ok());
  CHECK_THAT(loaded.diagnostics[0].text(), Catch::StartsWith("--set " + override));
  for (const std::string& part : parts) CHECK_THAT(loaded.diagnostics[0].text(), Catch::Contains(part));
}

void expect_unreadable(const std::string& text, const std::vector<std::string>& parts) {
  const File file(text);
  const Loaded loaded = load_scene(file.path());
  INFO(messages(loaded));
  REQUIRE(loaded.diagnostics.size() == 1);
  for (const std::string& part : parts) CHECK_THAT(loaded.diagnostics[0].text(), Catch::Contains(part));
}

}  // namespace

TEST_CASE("files that are no scenes") {
  const auto only = [](const fs::path& path) {
    const Loaded loaded = load_scene(path);
    REQUIRE(loaded.diagnostics.size() == 1);
    return loaded.diagnostics[0].text();
  };
  CHECK(only("no/such/silo.yaml") == "no/such/silo.yaml: no such file. Check the path.");
  CHECK_THAT(only(fs::temp_directory_path()), Catch::Contains("is a folder"));
  expect_unreadable("name: x\ndomain: {width: 5\n", {"bad.yaml:", "not valid YAML"});
  expect_unreadable("name: x\ndomain:\n\twidth: 5\n",
                    {"bad.yaml:3: ", "a tab indents this line. Use spaces."});
  expect_unreadable("name: x\ngrid: a: b\n", {"bad.yaml:2: not valid YAML"});
  expect_unreadable("", {"found nothing (expected a scene"});
  expect_unreadable("just text\n", {"found the text 'just text' (expected a scene"});
  expect_unreadable("- 1\n", {"found a list (expected a scene"});
  expect_unreadable("name: x\n---\nname: y\n", {"second document"});
  expect_unreadable(std::string("name: x\n\0\n", 10), {"bad.yaml:2: is not a text file"});
  expect_unreadable("a: &a [1, 1]\nb: &b [*a, *a]\n", {"bad.yaml:2: aliases (*name) are not used here"});
  expect_unreadable("name: !!str x\n", {"bad.yaml:1: tags"});
  expect_unreadable("name: x\n? [1, 2]\n: 3\n", {"bad.yaml:2: a key must be a plain word"});
  expect_unreadable("a: " + std::string(100000, '['), {"not valid YAML"});
  expect_unreadable(std::string((1 << 20) + 1, '#'), {"larger than 1 MiB"});
}

TEST_CASE("wrong types say what was found and what is expected") {
  expect(2, "domain: {width: wide, height: 150}",
         {"bad.yaml:2 domain.width: found the text 'wide' (expected a number)."});
  expect(2, "domain: {width: '150', height: 150}",
         {"domain.width: found the text '150'", "Remove the quotes."});
  expect(2, "domain: 150", {"bad.yaml:2 domain: found the number 150 (expected a map with width, height"});
  expect(2, "domain: {width: [1], height: 150}", {"domain.width: found a list (expected a number)"});
  expect(2, "domain: {width: , height: 150}", {"domain.width: found nothing (expected a number)"});
  expect(3, "grid: {cells_x: 128.5}", {"bad.yaml:3 grid.cells_x: 128.5 is not a whole number."});
  expect(3, "grid: {cells_x: 1e12}", {"grid.cells_x: 1e12 is out of range"});
  expect(5, "  sand: {mu_s: .nan}", {"bad.yaml:5 materials.sand.mu_s: .nan is not a finite number."});
  expect(5, "  sand: {mu_s: -.inf}", {"materials.sand.mu_s: -.inf is not a finite number."});
  expect(5, "  sand: {mu_s: 1e999}", {"materials.sand.mu_s: 1e999 is not a finite number."});
  expect(5, "  sand: 5", {"bad.yaml:5 materials.sand: found the number 5 (expected a map with mu_s"});
  expect(7, "  - sand",
         {"bad.yaml:7 fill.0: found the text 'sand' (expected a map with material, box, polygon)"});
  expect(7, "  - {material: sand, box: {x: [0], y: [0, 1]}}",
         {"fill.0.box.x: found a list of 1 (expected two numbers"});
  expect(7, "  - {material: sand, box: {x: [9, 0], y: [0, 1]}}", {"fill.0.box.x: [9, 0] is empty"});
  expect(7, "  - {material: sand, polygon: {points: [[0, 0], [1, a], [1, 1]]}}",
         {"fill.0.polygon.points.1.1: found the text 'a'"});
  expect(7, "  - {material: sand}", {"bad.yaml:7 fill.0: has no shape (exactly one of box, polygon)"});
  expect(7, "  - {material: snad, box: {x: [0, 150], y: [0, 1]}}",
         {"fill.0.material", "(allowed: air, sand)", "Did you mean 'sand'?"});
  expect(9, "  wall: bottom", {"bad.yaml:8 orifices: found a map (expected a list"});
  expect(11, "walls: {left: noslip}",
         {"bad.yaml:11 walls.left: found the text 'noslip' (allowed: no_slip, free_slip, open, periodic). "
          "Did you mean 'no_slip'?"});
  expect(11, "output: {fields: speed}", {"output.fields: found the text 'speed' (expected a list of texts"});
  expect(11, "gravity: -1", {"gravity: found the number -1 (expected two numbers"});
}

TEST_CASE("missing keys") {
  expect(2, "domain: {width: 150}",
         {"bad.yaml:2 domain.height: is missing (the height of the domain, above 0)."});
  expect(9, "  - {centre: 75}", {"bad.yaml:9 orifices.0.width: is missing"});
  expect(10, "", {"bad.yaml:1 time: nothing ends this run"});
  const File file("domain: {width: 150, height: 150}\ngrid: {cells_x: 128}\ntime: {end: 1}\n");
  const std::string all = messages(load_scene(file.path()));
  CHECK_THAT(all, Catch::Contains("materials: is missing (at least one"));
  CHECK_THAT(all, Catch::Contains("fill: is missing"));
}

TEST_CASE("unknown keys suggest the nearest, or where the key belongs, or list what is allowed") {
  expect(11, "stopp: {mass_below: 0.5}", {"bad.yaml:11 stopp: unknown key. Did you mean 'stop'?"});
  expect(2, "domain: {width: 150, height: 150, symetry: none}",
         {"bad.yaml:2 domain.symetry: unknown key. Did you mean 'symmetry'?"});
  expect(5, "  sand: {mu_s: 0.32, delta_mu: 0.28, I0: 0.4, I_0: 0.4}",
         {"bad.yaml:5 materials.sand.I0: unknown key. Did you mean 'I_0'?"});
  expect(11, "rheology: {law: mu_I}",
         {"bad.yaml:11 rheology: unknown key. Did you mean 'physics.rheology'?"});
  expect(11, "colour: red", {"bad.yaml:11 colour: unknown key (allowed here: name, units, domain"});
  expect(9, "  - {wall: bottom, centre: 75, width: 18.75, foo: 1}",
         {"bad.yaml:9 orifices.0.foo: unknown key (allowed here: wall, centre, width)."});
}

TEST_CASE("keys given twice") {
  expect(11, "name: again", {"bad.yaml:11 name: is given twice, first on line 1. Keep one."});
  expect(5, "  sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4, mu_s: 0.32}",
         {"bad.yaml:5 materials.sand.mu_s: is given twice"});
  expect(5, "  sand: {I_0: 0.3, mu_s: 0.32, delta_mu: 0.28}\n  sand: {I_0: 0.4, mu_s: 0.32, delta_mu: 0.28}",
         {"materials.sand"});
}

TEST_CASE("what check() finds comes with the place of the key") {
  expect(2, "domain: {width: 150, height: 0}",
         {"bad.yaml:2 domain.height: 0 is out of range (must be > 0)."});
  expect(2, "domain: {width: -150, height: 150}",
         {"bad.yaml:2 domain.width: -150 is out of range (must be > 0)."});
  expect(3, "grid: {cells_x: 150}",
         {"bad.yaml:3 grid.cells_x: 150 x 150 cells can be halved only to 75 x 75", "Use cells_x 144"});
  const File no_material("materials: {}");
  CHECK_THAT(messages(load_scene(no_material.path())),
             Catch::Contains("bad.yaml:1 materials: there is no material"));
  expect(5, "  sand: {mu_s: -0.1, delta_mu: 0.28, I_0: 0.4}",
         {"bad.yaml:5 materials.sand.mu_s: -0.1 is out of range (must be >= 0)."});
  expect(5, "  sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0}",
         {"bad.yaml:5 materials.sand.I_0: 0 is out of range (must be > 0). Glass beads have about 0.28."});
  expect(9, "  - {wall: bottom, centre: 145, width: 18.75}",
         {"bad.yaml:9 orifices.0.centre: the orifice reaches", "Use a centre from 9.375 to 140.625."});
  expect(9, "  - {wall: bottom, centre: 75, width: 1.5}",
         {"bad.yaml:9 orifices.0.width: the neck is 1.28 cells wide", "cells_x >= 800"});
  expect(10, "time: {end: 0}", {"bad.yaml:10 time: nothing ends this run"});
}

TEST_CASE("overrides") {
  const File file(sound_with(0, ""));
  const Loaded loaded = load_scene(
      file.path(), {"orifices.0.width=9.375", "stop.mass_below=0.5", "name=other", "fill.1.material=air",
                    "fill.1.box={x: [0, 75], y: [100, 135]}", "walls.left=free_slip"});
  INFO(messages(loaded));
  REQUIRE(loaded.ok());
  CHECK(loaded.scene.orifices[0].width == 9.375);
  CHECK(loaded.scene.stop.mass_below == 0.5);
  CHECK(loaded.scene.name == "other");
  REQUIRE(loaded.scene.fill.size() == 2);
  CHECK(loaded.scene.fill[1].material == -1);
  CHECK(loaded.scene.wall(Side::left) == Wall::free_slip);
  CHECK(load_scene(file.path(), {"stop={mass_below: 0.5}"}).scene.stop.mass_below == 0.5);

  expect_set("time.endd=3", {" time.endd: unknown key. Did you mean 'end'?"});
  expect_set("grid.cells_x=150", {" grid.cells_x: 150 x 150"});
  expect_set("grid.cells_x=many", {" grid.cells_x: found the text 'many' (expected a whole number)"});
  expect_set("physics.nonlocal.A=-1", {" physics.nonlocal.A: -1 is out of range"});
  expect_set("name.x=1", {" name.x: unknown key: name is the text 'test', which has no keys below it"});
  expect_set("fill.7.material=air", {" fill.7.material: unknown key: fill is a list of 1"});
  expect_set("orifices.first.width=9", {"unknown key: orifices is a list of 1; name an item by its number"});
  expect_set("grid..cells_x=64", {"is not a dotted path"});
  expect_set("grid.cells_x", {"expected path=value"});
  expect_set("grid={cells_x: [", {"not valid YAML"});
}

TEST_CASE("several errors at once are all reported, in the order of the file, those of overrides last") {
  const File file(
      "name: test\n"
      "domain: {width: -150, height: 150}\n"
      "grid: {cells_x: lots}\n"
      "materials:\n"
      "  sand: {mu_s: -0.1, I0: 0.6, I_0: 0}\n"
      "fill:\n"
      "  - {material: gravel, box: {x: [0, 150], y: [0, 135]}}\n"
      "time: {cfl: 2}\n"
      "inserts: 5\n");
  const Loaded loaded = load_scene(file.path(), {"threads=-1", "foo=1"});
  INFO(messages(loaded));
  const std::vector<std::string> expected{":2 domain.width",
                                          ":3 grid.cells_x",
                                          ":5 materials.sand.mu_s",
                                          ":5 materials.sand.I_0",
                                          ":5 materials.sand.I0",
                                          ":7 fill.0.material",
                                          ":8 time.cfl",
                                          ":8 time: nothing ends",
                                          ":9 inserts",
                                          "--set threads=-1 threads",
                                          "--set foo=1 foo"};
  for (const std::string& part : expected) CHECK_THAT(messages(loaded), Catch::Contains(part));
  CHECK(loaded.diagnostics.size() == expected.size());
  int last = 0;
  for (const Diagnostic& d : loaded.diagnostics) {
    const std::size_t colon = d.place.rfind(':');
    const int line = d.place.starts_with("--set") ? 1 << 20 : std::stoi(d.place.substr(colon + 1));
    CHECK(line >= last);
    last = line;
  }
}

TEST_CASE("warnings are marked and let the scene run") {
  const Loaded loaded = load_scene(root / "configs" / "silo.yaml");
  REQUIRE(loaded.diagnostics.size() == 1);
  CHECK(loaded.ok());
  CHECK_THAT(loaded.diagnostics[0].text(),
             Catch::Contains("silo.yaml:") && Catch::Contains(" materials.sand: warning: "));
}
