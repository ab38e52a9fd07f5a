// What a resumed run leaves in its folder is what one without a break leaves, wall times and provenance aside.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/checkpoint.hpp"
#include "io/csv.hpp"
#include "io/provenance.hpp"
#include "io/run_folder.hpp"
#include "io/scene_yaml.hpp"
#include "io/xdmf.hpp"
#include "io/yaml_tree.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/support/same_bits.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

const fs::path configs =
    fs::path(__FILE__).parent_path().parent_path().parent_path().parent_path() / "configs";

/// As `hourglass run --resume`, to this number of steps.
Summary go_on(Scene scene, const fs::path& out, long steps, int threads = 1) {
  scene.time.max_steps = steps;
  scene.threads = threads;
  const Resumption found = resume(out, scene);
  REQUIRE_FALSE(found.done);
  Simulation simulation(scene);
  Archive* from = found.from ? found.from->state.get() : nullptr;
  RunFolder folder(scene, to_yaml(scene), {.out = out, .force = true, .quiet = true, .from = from});
  Summary summary = simulation.run({&folder}, from);
  folder.finish(summary);
  return summary;
}

/// The table without its column of wall times.
std::vector<std::vector<std::string>> series_of(const fs::path& run) {
  auto rows = csv_rows(text_at(run / "series.csv"));
  const auto column = std::find(rows.at(0).begin(), rows.at(0).end(), "wall_seconds") - rows[0].begin();
  for (auto& row : rows) row.erase(row.begin() + column);
  return rows;
}

std::string flat(const YamlNode& node) {
  std::string text = node.text;
  for (const YamlNode& item : node.items) text += flat(item) + ",";
  for (const auto& [key, value] : node.keys) text += key + ":" + flat(value) + ",";
  return text;
}

std::string summary_of(const fs::path& run) {
  YamlNode summary = parse_yaml(text_at(run / "summary.json"));
  std::erase_if(summary.keys, [](const auto& member) {
    const std::string& key = member.first;
    return key == "wall_seconds" || key == "cell_steps_per_second" || key == "peak_memory_bytes" ||
           key == "stages" || key == "provenance" || key == "threads";
  });
  return flat(summary);
}

std::map<std::string, std::string> pictures_of(const fs::path& run) {
  std::map<std::string, std::string> pictures;
  if (fs::exists(run / "snapshots"))
    for (const auto& entry : fs::directory_iterator(run / "snapshots"))
      pictures[entry.path().filename()] = text_at(entry.path());
  return pictures;
}

void compare(const fs::path& run, const fs::path& expected) {
  CHECK(series_of(run) == series_of(expected));
  CHECK(summary_of(run) == summary_of(expected));
  CHECK(pictures_of(run) == pictures_of(expected));
  CHECK(text_at(run / "fields.xdmf") == text_at(expected / "fields.xdmf"));
  if (!fs::exists(expected / "fields.h5")) return;
  const FieldReader one(run), two(expected);
  REQUIRE(one.times() == two.times());
  REQUIRE(one.times().size() > 2);
  for (int k = 0; k < static_cast<int>(two.times().size()); ++k) {
    REQUIRE(one.names(k) == two.names(k));
    const Frame a = one.read(k, one.names(k)), b = two.read(k, two.names(k));
    CHECK(same_bits(a.velocity_x, b.velocity_x));
    CHECK(same_bits(a.velocity_y, b.velocity_y));
    for (std::size_t f = 0; f < b.fields.size(); ++f) {
      INFO(b.fields[f].first << " of frame " << k);
      CHECK(same_bits(a.fields[f].second, b.fields[f].second));
    }
  }
}

/// Without a break, and in three parts, the last with as many threads as are given.
void run_both(const Scene& scene, int threads) {
  const TestFolder folder;
  Scene whole = scene;
  whole.time.max_steps = 24;
  whole.threads = 1;
  Simulation simulation(whole);
  {
    RunFolder out(whole, to_yaml(whole), {.out = folder / "whole", .quiet = true});
    out.finish(simulation.run({&out}));
  }
  go_on(scene, folder / "parts", 7);
  go_on(scene, folder / "parts", 16);
  go_on(scene, folder / "parts", 24, threads);
  compare(folder / "parts", folder / "whole");
}

/// A scene of configs/ on the coarsest grid that it can be run on, told often. No value: nothing is solved in time.
std::optional<Scene> small(const fs::path& file) {
  for (const int cells : {4, 16, 32, 48, 64, 96, 128}) {
    Loaded loaded =
        load_scene(file, {fmt::format("grid.cells_x={}", cells), "accuracy.extrapolate=0", "threads=1"});
    if (!loaded.ok()) continue;
    Scene& scene = loaded.scene;
    if (scene.model != Model::mu_I) return std::nullopt;
    scene.output.series_every = 2 * scene.time.dt_max;
    scene.output.fields_every = 5 * scene.time.dt_max;
    scene.output.snapshots_every = 0;
    return scene;
  }
  FAIL(file.string() + " runs on no coarse grid");
  return std::nullopt;
}

Scene small_silo() {
  Scene scene = silo(16, 0, 75, 75);
  scene.output = {0.1, 0.25, 0, {"speed", "viscosity"}};
  return scene;
}

}  // namespace

TEST_CASE("a folder of a run that was resumed twice is that of a run without a break", "[io]") {
  for (const char* name : {"silo_everything.yaml", "steady_feed.yaml", "hopper.yaml", "round_silo.yaml"}) {
    INFO(name);
    run_both(*small(configs / name), 2);
  }
}

TEST_CASE("every scene of configs resumes to the last bit", "[io][slow]") {
  int scenes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(configs)) {
    const fs::path folder = entry.path().parent_path().filename();
    if (entry.path().extension() != ".yaml" || folder == "studies" || folder == "figures") continue;
    const auto scene = small(entry.path());
    if (!scene) continue;
    INFO(entry.path().filename().string());
    run_both(*scene, 2);
    ++scenes;
  }
  CHECK(scenes >= 20);
}

TEST_CASE("what is later than the checkpoint goes: rows, frames, pictures", "[io][slow]") {
  const TestFolder folder;
  Scene scene = small_silo();
  scene.output.snapshots_every = 0.5;
  scene.output.fields = {"speed"};
  go_on(scene, folder / "whole", 24);
  go_on(scene, folder / "run", 9);
  const std::string checkpoint = text_at(folder / "run/checkpoint.h5");
  go_on(scene, folder / "run", 20);
  const std::size_t rows = series_of(folder / "run").size(), pictures = pictures_of(folder / "run").size();
  write_atomically(folder / "run/checkpoint.h5", checkpoint);  // as if killed after more was told
  go_on(scene, folder / "run", 10);
  CHECK(series_of(folder / "run").size() < rows);
  CHECK(pictures_of(folder / "run").size() < pictures);
  go_on(scene, folder / "run", 24);
  compare(folder / "run", folder / "whole");
}

TEST_CASE("two checkpoints are kept, and a damaged one makes way for the other", "[io]") {
  const TestFolder folder;
  const fs::path run = folder / "run", newest = run / checkpoint_name,
                 previous = run / previous_checkpoint_name;
  const Scene scene = small_silo();
  go_on(scene, folder / "whole", 24);
  go_on(scene, run, 8);
  CHECK_FALSE(fs::exists(previous));
  const std::string first = text_at(newest);
  go_on(scene, run, 16);
  CHECK(text_at(previous) == first);
  const std::string second = text_at(newest);
  Scene longer = scene;
  longer.time.max_steps = 24;

  SECTION("cut off") { write_atomically(newest, second.substr(0, second.size() / 2)); }
  SECTION("a bit flipped") {
    std::string flipped = second;
    flipped[flipped.size() / 3] = static_cast<char>(flipped[flipped.size() / 3] ^ 4);
    write_atomically(newest, flipped);
  }
  SECTION("empty") { write_atomically(newest, ""); }
  SECTION("gone") { fs::remove(newest); }
  const Resumption found = resume(run, longer);
  REQUIRE(found.from);
  CHECK(found.from->step == 8);
  if (fs::exists(newest)) {
    REQUIRE(found.words.size() == 1);
    CHECK_THAT(found.words[0],
               Catch::Contains("checkpoint.h5: damaged; going on from checkpoint.previous.h5"));
  }
  go_on(scene, run, 24);
  compare(run, folder / "whole");

  for (const fs::path& path : {newest, previous}) write_atomically(path, "no checkpoint");
  CHECK_THROWS_WITH(
      resume(run, longer),
      Catch::Contains("checkpoint.h5 and checkpoint.previous.h5 damaged") && Catch::Contains("--force"));
}

TEST_CASE("a checkpoint of another version is refused, one of another build is told of", "[io]") {
  const TestFolder folder;
  Scene scene = small_silo();
  const fs::path run = folder / "run", path = run / checkpoint_name;
  go_on(scene, run, 4);
  const std::string written = text_at(path);
  const auto with = [&](const std::string& there, const std::string& instead) {
    std::string bytes = written.substr(0, written.size() - seal_length);
    bytes.replace(bytes.find(there), there.size(), instead);
    write_atomically(path, bytes);
    seal(path);
  };
  scene.time.max_steps = 8;
  std::string version = provenance().version;
  version.back() = version.back() == '9' ? '8' : '9';
  with(provenance().version, version);
  CHECK_THROWS_WITH(resume(run, scene), Catch::Contains("written by hourglass " + version) &&
                                            Catch::Contains("this is " + provenance().version) &&
                                            Catch::Contains("--force"));
  with("hourglass checkpoint 1", "hourglass checkpoint 0");
  CHECK_THROWS_WITH(resume(run, scene), Catch::Contains("(hourglass checkpoint 0)"));
  with(provenance().compiler, std::string(provenance().compiler.size(), 'x'));
  const Resumption found = resume(run, scene);
  REQUIRE(found.from);
  REQUIRE(found.words.size() == 1);
  CHECK_THAT(found.words[0], Catch::Contains("written by another build"));
}

TEST_CASE("another scene is refused by the key that differs; some keys may change", "[io]") {
  const TestFolder folder;
  const fs::path run = folder / "run";
  const Scene scene = small_silo();
  go_on(scene, run, 4);
  const auto refused = [&](auto&& change, const std::string& words) {
    Scene other = scene;
    other.time.max_steps = 8;
    change(other);
    CHECK_THROWS_WITH(resume(run, other), Catch::Contains(words));
    fs::rename(run / checkpoint_name, folder / "aside");  // without a checkpoint scene.yaml is asked
    CHECK_THROWS_WITH(resume(run, other), Catch::Contains(words));
    fs::rename(folder / "aside", run / checkpoint_name);
  };
  refused([](Scene& s) { s.orifices[0].width = 37.5; }, "orifices.0.width is 75 there, 37.5 here");
  refused([](Scene& s) { s.materials[0].mu_s = 0.5; }, "materials.sand.mu_s is 0.62 there, 0.5 here");
  refused([](Scene& s) { s.nonlocal = Nonlocal{}; }, "physics.nonlocal is missing there, a map here");
  refused([](Scene& s) { s.orifices.clear(); }, "orifices");
  refused([](Scene& s) { s.stop.mass_below = 0.5; }, "stop");
  Scene other = scene;
  other.time.end = 100;
  other.time.max_steps = 8;
  other.threads = 2;
  other.output.checkpoint_minutes = 1;
  CHECK(resume(run, other).from->step == 4);
}

TEST_CASE("what there is to resume: nothing, a run without a checkpoint, one at its end", "[io]") {
  const TestFolder folder;
  Scene scene = small_silo();
  scene.time.max_steps = 6;
  const Resumption nothing = resume(folder / "run", scene);
  CHECK((!nothing.done && !nothing.from && nothing.words.empty()));

  go_on(scene, folder / "run", 6);
  const Resumption ended = resume(folder / "run", scene);
  CHECK(ended.done);
  CHECK_THAT(ended.words.at(0), Catch::Contains("is at its end (finished)"));

  fs::remove(folder / "run/checkpoint.h5");
  fs::remove(folder / "run/summary.json");
  const Resumption killed = resume(folder / "run", scene);
  CHECK((!killed.done && !killed.from));
  CHECK_THAT(killed.words.at(0), Catch::Contains("no checkpoint yet"));
  go_on(scene, folder / "run", 6);
  go_on(scene, folder / "whole", 6);
  CHECK(series_of(folder / "run") == series_of(folder / "whole"));

  folder.write("series.csv", "mine");
  CHECK_THROWS_WITH(resume(folder / "", scene), Catch::Contains("not written by a run of hourglass"));
}

TEST_CASE("one run at a time in a folder", "[io]") {
  const TestFolder folder;
  Scene scene = small_silo();
  const RunFolder first(scene, to_yaml(scene), {.out = folder / "run", .quiet = true});
  for (const bool force : {false, true})
    CHECK_THROWS_WITH(
        RunFolder(scene, to_yaml(scene), {.out = folder / "run", .force = force, .quiet = true}),
        Catch::Contains("another run is at work in it"));
}
