#include "io/run_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "io/json.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "io/render.hpp"
#include "io/series.hpp"
#include "io/xdmf.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("hourglass_run_folder_test_{}", ::getpid());
  Folder() { fs::remove_all(path); }
  ~Folder() { fs::remove_all(path); }
};

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::istringstream text(text_of(path));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

RenderOptions options(const std::string& field, const std::vector<double>& times = {}) {
  RenderOptions out;
  out.fields = {field};
  out.times = times;
  return out;
}

/// A small silo of two materials for a dozen steps.
Scene small_silo() {
  Scene scene;
  scene.name = "small";
  scene.width = scene.height = 30;
  scene.cells_x = 16;
  scene.materials = {Material{}, Material{}};
  scene.materials[1].name = "dyed, fine";
  scene.fill = {{0, {{0, 0}, {30, 0}, {30, 15}, {0, 15}}}, {1, {{0, 15}, {30, 15}, {30, 26}, {0, 26}}}};
  scene.orifices = {{Side::bottom, 7.5, 3.75}, {Side::bottom, 22.5, 3.75}};
  scene.time.end = 0.5;
  scene.output = {0.1, 0.25, 0.25, {"speed", "tracer"}};
  scene.threads = 1;
  return scene;
}

Summary run(const Scene& scene, const RunOptions& options) {
  Simulation simulation(scene);
  RunFolder folder(scene, "name: small\n", options, {"a warning about the scene"});
  Summary summary = simulation.run({&folder});
  folder.finish(summary);
  return summary;
}

}  // namespace

TEST_CASE("the name of a scene never leads out of runs", "[io]") {
  CHECK(default_run_folder("silo") == "runs/silo");
  CHECK(default_run_folder("two holes") == "runs/two holes");
  for (const std::string name : {"..", "../x", "/etc/x", "a/../../x", ".", "", "..\\x", "a\nb"}) {
    const fs::path path = default_run_folder(name);
    INFO(name);
    CHECK(path.parent_path() == "runs");
    CHECK(path.filename().string().find_first_of("/\\\n") == std::string::npos);
    CHECK(path.lexically_normal() == path);
    CHECK(path.filename().string()[0] != '.');
  }
}

TEST_CASE("a run leaves scene, series, fields, snapshots, summary and log", "[io][slow]") {
  const Folder folder;
  const Summary summary = run(small_silo(), {folder.path, false, true});
  CHECK(text_of(folder.path / "scene.yaml") == "name: small\n");

  const auto series = lines_of(folder.path / "series.csv");
  CHECK(series.at(0) ==
        "t,step,dt,mass,outflow,outflow_0,outflow_1,sand_mass,sand_outflow,\"dyed, fine_mass\",\"dyed, "
        "fine_outflow\",quasi_static_fraction,max_speed,iterations_pressure,iterations_viscous,"
        "iterations_fluidity,max_divergence,capped_cells,wall_seconds,dt_limit,ill_posed_fraction,"
        "quasi_static_1e-2,quasi_static_1e-4");
  CHECK(series.size() >= 6);
  CHECK(series.at(1).rfind("0,0,0,780,", 0) == 0);  // 30 x 26
  CHECK(std::count(series.at(2).begin(), series.at(2).end(), ',') == 22);

  const FieldReader reader(folder.path);
  CHECK(reader.info().name == "small");
  CHECK(reader.info().materials == std::vector<std::string>{"sand", "dyed, fine"});
  CHECK(reader.times().size() == 3);
  CHECK(reader.names(0) == std::vector<std::string>{"grains", "speed", "tracer"});
  CHECK(reader.read(0, {"tracer"}).field("tracer")(0, 10) == 1);

  for (const char* field : {"speed", "tracer"}) {
    for (int k = 0; k < 3; ++k) CHECK(fs::file_size(snapshot_path(folder.path, field, k)) > 1000);
  }
  CHECK_FALSE(fs::exists(snapshot_path(folder.path, "grains", 0)));  // stored, but not asked for

  const YAML::Node json = YAML::LoadFile(folder.path / "summary.json");  // YAML holds JSON
  for (const char* key : {"status",
                          "reason",
                          "discharge_rate",
                          "discharge_constant",
                          "discharge_window",
                          "quasi_static_fraction",
                          "quasi_static_1e-2",
                          "quasi_static_1e-4",
                          "mass_error",
                          "worst_max_divergence",
                          "missed_tolerances",
                          "steps",
                          "cells",
                          "wall_seconds",
                          "cell_steps_per_second",
                          "peak_memory_bytes",
                          "threads",
                          "stages",
                          "warnings",
                          "provenance"}) {
    INFO(key);
    CHECK(json[key].IsDefined());
  }
  CHECK(json["status"].as<std::string>() == "finished");
  CHECK(json["steps"].as<long>() == summary.steps);
  CHECK(json["mass_error"].as<double>() == summary.mass_error);
  CHECK(json["peak_memory_bytes"].as<long>() > 1000000);
  CHECK(json["provenance"]["revision"].IsDefined());
  CHECK_FALSE(fs::exists(folder.path / "summary.json.new"));

  const std::string log = text_of(folder.path / "run.log");
  for (const char* part : {"hourglass", "revision", "a warning about the scene", "dt_max", "finished"}) {
    CHECK(log.find(part) != std::string::npos);
  }

  SECTION("which 'render' draws again from the stored fields") {
    CHECK(render_run(folder.path, options("speed", {0.2})) == 0);
    CHECK(files_in(folder.path / "pictures") == std::vector<std::string>{"speed_0001.png"});
    CHECK_THROWS_WITH(render_run(folder.path, options("sped")), Catch::Contains("unknown field 'sped'"));
    CHECK_THROWS_WITH(render_run(folder.path, options("viscosity")), Catch::Contains("not stored"));
    CHECK_THROWS_WITH(render_run(folder.path, options("speed", {7})), Catch::Contains("outside the run"));
  }
  SECTION("which 'render' makes a video of") {
    RenderOptions video = options("speed");
    video.animate = true;
    video.overlays = {Overlay::streamlines, Overlay::quasi_static};
    CHECK(render_run(folder.path, video) == 0);
    CHECK(files_in(folder.path / "frames") ==
          std::vector<std::string>{"speed_0000.png", "speed_0001.png", "speed_0002.png"});
    CHECK(text_of(folder.path / "speed.ogv").substr(0, 4) == "OggS");
    CHECK_FALSE(fs::exists(folder.path / "speed.ogv.new"));
    const auto size = [&](int frame) {  // from the header of the PNG file
      return text_of(video_frame_path(folder.path, "speed", frame)).substr(16, 8);
    };
    CHECK(size(1) == size(0));
    CHECK(size(2) == size(0));
    for (const int last_byte : {3, 7}) CHECK(size(0)[last_byte] % 2 == 0);
  }
  SECTION("and is not overwritten unless forced") {
    const std::string before = text_of(folder.path / "series.csv");
    CHECK_THROWS_AS(run(small_silo(), {folder.path, false, true}), std::invalid_argument);
    CHECK(text_of(folder.path / "series.csv") == before);

    std::ofstream(folder.path / "notes.txt") << "mine";
    std::ofstream(folder.path / "snapshots" / "mine_0001.png") << "mine";
    std::ofstream(folder.path / "snapshots" / "speed_0099.png") << "of the last run";
    Scene shorter = small_silo();
    shorter.time.end = 0.1;
    shorter.output.snapshots_every = 0;
    run(shorter, {folder.path, true, true});
    CHECK(text_of(folder.path / "notes.txt") == "mine");
    CHECK(fs::exists(folder.path / "snapshots" / "mine_0001.png"));
    CHECK_FALSE(fs::exists(folder.path / "snapshots" / "speed_0099.png"));
    CHECK(lines_of(folder.path / "series.csv").size() < 6);
  }
}

TEST_CASE("'render' leaves the snapshots of other times alone", "[io][slow]") {
  const Folder folder;
  Scene scene = small_silo();
  scene.output.snapshots_every = 0.1;
  scene.output.fields = {"speed"};
  run(scene, {folder.path, false, true});
  CHECK(files_in(folder.path / "snapshots").size() == 6);
  const std::string before =
      text_of(snapshot_path(folder.path, "speed", 1));  // of t = 0.1; frame 1 is of 0.25
  CHECK(render_run(folder.path, options("speed", {0, 0.25})) == 0);
  CHECK(text_of(snapshot_path(folder.path, "speed", 1)) == before);
  CHECK(files_in(folder.path / "snapshots").size() == 6);
  CHECK(files_in(folder.path / "pictures") == std::vector<std::string>{"speed_0000.png", "speed_0001.png"});

  scene.output.snapshots_every = 0;
  std::ofstream(folder.path / "speed.ogv") << "a video";
  run(scene, {folder.path, true, true});  // clears them away
  CHECK(files_in(folder.path / "snapshots").empty());
  CHECK(files_in(folder.path / "pictures").empty());
  CHECK_FALSE(fs::exists(folder.path / "speed.ogv"));
}

TEST_CASE("files that no run wrote are never replaced", "[io]") {
  const Folder folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "scene.yaml") << "my own scene";
  for (const bool force : {false, true}) {
    CHECK_THROWS_WITH(RunFolder(small_silo(), "", {folder.path, force, true}),
                      Catch::Contains("not written by a run of hourglass"));
  }
  CHECK(text_of(folder.path / "scene.yaml") == "my own scene");
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
  CHECK_THROWS_WITH(RunFolder(small_silo(), "", {folder.path / "scene.yaml", true, true}),
                    Catch::Contains("is a file"));
  CHECK_THROWS_AS(RunFolder(small_silo(), "", {"/proc/nowhere/x", false, true}), std::runtime_error);
}

TEST_CASE("links in a run folder lead no write out of it", "[io]") {
  const Folder folder;
  fs::create_directories(folder.path / "elsewhere");
  for (const char* name : {"snapshots", "series.csv", "fields.h5.new", "checkpoint.h5"}) {
    fs::create_symlink(folder.path / "elsewhere" / name, folder.path / name);
    CHECK_THROWS_WITH(RunFolder(small_silo(), "", {folder.path, true, true}),
                      Catch::Contains(std::string(name) + " is a link"));
    fs::remove(folder.path / name);
  }
  CHECK(fs::is_empty(folder.path / "elsewhere"));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("a run that could not begin does not stand in the way of the next", "[io]") {
  const Folder folder;
  fs::create_directories(folder.path);
  for (const char* name : {"run.log", "summary.json.new"}) std::ofstream(folder.path / name);
  Scene scene = small_silo();
  scene.time.max_steps = 1;
  CHECK(run(scene, {folder.path, false, true}).steps == 1);
  CHECK_FALSE(fs::exists(folder.path / "summary.json.new"));
}

TEST_CASE("JSON escapes text and keeps every digit", "[io]") {
  CHECK(json_string("a \"b\" \\ \n ü") == "\"a \\\"b\\\" \\\\ \\u000a ü\"");
  CHECK(json_number(NAN) == "null");
  CHECK(json_number(-HUGE_VAL) == "null");
  for (const double x : {0.1, 1.0 / 3, 1e-300, -12345678.9, 5.0}) CHECK(std::stod(json_number(x)) == x);
  CHECK(json_object({{"a", "1"}, {"b", json_array({"2", "null"})}}) ==
        "{\n  \"a\": 1,\n  \"b\": [2, null]\n}");
  CHECK(json_object({}) == "{}");
  CHECK(YAML::Load(to_json(provenance(3)))["threads"].as<int>() == 3);
}

TEST_CASE("version text names what was built", "[io]") {
  const std::string text = version_text();
  for (const char* part : {"hourglass ", "git revision", "compiler", "flags", "SIMD width", "threads"}) {
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_CASE("progress off a terminal is a line at every 5 %; quiet says nothing", "[io]") {
  const bool quiet = GENERATE(false, true);
  std::FILE* file = std::tmpfile();
  {
    Progress progress(quiet, file);
    for (int k = 1; k <= 1000; ++k) {
      if (progress.due(k / 1000.0)) progress.show(k / 1000.0, fmt::format("t {}", k));
    }
    progress.say("done");
  }
  std::rewind(file);
  std::vector<std::string> lines;
  char buffer[200];
  while (std::fgets(buffer, sizeof buffer, file)) lines.emplace_back(buffer);
  std::fclose(file);
  if (quiet) {
    CHECK(lines.empty());
    return;
  }
  REQUIRE(lines.size() == 22);  // 0, 5, ... 100 and the last word
  CHECK(lines[1].rfind("  5 %  t 50  ", 0) == 0);
  CHECK(lines[1].find("left") != std::string::npos);
  CHECK(lines[20] == "100 %  t 1000\n");
  CHECK(lines[21] == "done\n");
}

TEST_CASE("durations read as people say them", "[io]") {
  CHECK(duration_text(4.24) == "4.2 s");
  CHECK(duration_text(42.4) == "42 s");
  CHECK(duration_text(200) == "3 min 20 s");
  CHECK(duration_text(5 * 3600 + 7 * 60) == "5 h 07 min");
  CHECK(duration_text(2 * 86400 + 4 * 3600) == "2 d 4 h");
  CHECK(duration_text(INFINITY) == "?");
}
