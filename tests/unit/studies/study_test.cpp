#include "studies/study.hpp"

#include <catch2/catch.hpp>

#include "io/scene_yaml.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
using Catch::Contains;

namespace {

class StudyFiles {
 public:
  StudyFiles() { folder_.write("silo.yaml", to_yaml(sound_scene())); }
  std::filesystem::path write(const std::string& text) const {
    return folder_.write("study.yaml", "scene: silo.yaml\n" + text);
  }
  std::vector<StudyRun> runs(const std::string& text) const {
    std::vector<std::string> warnings;
    return runs_of(read_study(write(text)), warnings);
  }
  void refuses(const std::string& text, const std::string& why) const {
    INFO(text);
    CHECK_THROWS_WITH(runs(text), Contains(why));
  }

 private:
  TestFolder folder_;
};

}  // namespace

TEST_CASE("a study: axes, ranges and pairs become runs, the last axis changes first") {
  const StudyFiles files;
  const auto runs = files.runs(
      "axes:\n"
      "  orifices.0.width: {from: 40, to: 60, count: 3}\n"
      "  mu: [0.3, 0.4]\n"
      "  end: {from: 1, to: 100, count: 2, scale: log}\n"
      "  delta: [0.2, 0.1]\n"
      "paired: [[mu, delta]]\n"
      "set:\n"
      "  materials.beads.mu_s: mu\n"
      "  materials.beads.delta_mu: delta / 2\n"
      "  time.end: end\n"
      "  accuracy.preset: 'fast'\n");
  REQUIRE(runs.size() == 12);
  CHECK(runs[0].name == "0001");
  CHECK(runs[11].name == "0012");
  CHECK(runs[0].values == std::vector<std::string>{"40", "0.3", "1", "0.2"});
  CHECK(runs[1].values == std::vector<std::string>{"40", "0.3", "100", "0.2"});
  CHECK(runs[2].values == std::vector<std::string>{"40", "0.4", "1", "0.1"});
  CHECK(runs[4].values == std::vector<std::string>{"50", "0.3", "1", "0.2"});
  CHECK(runs[11].values == std::vector<std::string>{"60", "0.4", "100", "0.1"});
  const Scene& scene = runs[6].scene;  // 50, 0.4, 1, 0.1
  CHECK(scene.orifices[0].width == 50);
  CHECK(scene.materials[0].mu_s == 0.4);
  CHECK(scene.materials[0].delta_mu == 0.05);
  CHECK(scene.time.end == 1);
  CHECK(scene.output.fields_every == 0);
  CHECK(scene.output.snapshots_every == 0);
}

TEST_CASE("a study: log ranges have equal ratios, words pass straight through") {
  const StudyFiles files;
  const auto runs = files.runs(
      "axes:\n"
      "  end: {from: 1, to: 16, count: 5, scale: log}\n"
      "  level: [fast, accurate]\n"
      "set: {time.end: end, accuracy: level}\n"
      "keep: fields\n");
  REQUIRE(runs.size() == 10);
  for (int k = 0; k < 5; ++k) CHECK(runs[2 * k].scene.time.end == Approx(1 << k).epsilon(1e-15));
  CHECK_FALSE(runs[0].scene.accuracy == runs[1].scene.accuracy);
  CHECK(runs[0].scene.output.fields_every > 0);
}

TEST_CASE("a study: what is wrong has its file, line, key and cure") {
  const StudyFiles files;
  const std::string good = "axes: {time.end: [1, 2]}\n";
  CHECK(files.runs(good).size() == 2);
  files.refuses("axes:\n  gap: [1]\n", "study.yaml:3 axes.gap: changes nothing: no formula of set names it");
  files.refuses(good + "axis: 1\n",
                "study.yaml:3 axis: unknown key (allowed: name, scene, axes, cases, paired, set, keep). Did "
                "you mean 'axes'?");
  files.refuses("axes: {time.end: []}\n",
                "study.yaml:2 axes.time.end: found a list of 0 (expected a list of 1 to 1000 values");
  files.refuses("axes: {time.end: [1, 1]}\n", "axes.time.end: has 1 twice");
  files.refuses("axes: {sqrt: [1]}\n", "axes.sqrt: is no name for an axis");
  files.refuses("axes: {steps: [1]}\n", "axes.steps: is a column that results.csv has already");
  files.refuses("axes: {time.end: {from: 1, to: 2, count: 1}}\n",
                "axes.time.end.count: 1 is out of range (a whole number from 2 to 1000)");
  files.refuses("axes: {time.end: {from: 0, to: 2, count: 3, scale: log}}\n",
                "a log range needs from and to above 0");
  files.refuses("axes: {time.end: {from: 1, to: 2, count: 3, scale: lin}}\n",
                "found the text 'lin' (allowed: linear, log)");
  files.refuses("axes: {a: [1, 2], b: [1]}\npaired: [[a, b]]\nset: {time.end: a + b}\n",
                "study.yaml:3 paired.0: a has 2 values and b has 1");
  files.refuses(good + "paired: [[time.end, time.edn]]\n",
                "'time.edn' is no axis (there are: time.end). Did you mean 'time.end'?");
  files.refuses(good + "set:\n  time.cfl: 0.1 *\n",
                "study.yaml:4 set.time.cfl: formula '0.1 *', column 6: a number or name is missing");
  files.refuses(good + "set: {time.cfl: [1]}\n",
                "set.time.cfl: found a list (expected a formula of the axes, or a value in quotes)");
  files.refuses(good + "set: {accuracy: fast}\n",
                "'fast' is no axis with numbers (there are: time.end). A text goes in quotes.");
  files.refuses("axes: {a: [1, x]}\nset: {time.end: 2 * a}\n", "'a' is no axis with numbers");
  files.refuses("axes: {a: [0, 1]}\nset: {time.end: 1 / a}\n",
                "time.end: formula '1 / a': gives no finite number");
  files.refuses("axes: {time.end: [1, -1]}\n", "study.yaml:2 time.end: -1");
  files.refuses("axes: {time.end: [1, -1]}\n", "(run 0002: time.end=-1)");
  files.refuses("axes: {time.endd: [1, 2]}\n",
                "study.yaml:2 time.endd: unknown key. Did you mean 'end'? (all runs)");
  files.refuses(
      "axes: {a: {from: 1, to: 2, count: 1000}, b: {from: 1, to: 2, count: 11}}\nset: {time.end: a + b}\n",
      "are 11000 runs (at most 10000)");
}

TEST_CASE("a study: named cases each set what they say") {
  const StudyFiles files;
  const auto runs = files.runs(
      "axes: {time.end: [1, 2]}\n"
      "cases:\n"
      "  insert:\n"
      "    none: {}\n"
      "    square: {inserts: [{shape: square, centre: [75, 60], width: 30}], time.cfl: 0.25}\n");
  REQUIRE(runs.size() == 4);
  CHECK(runs[3].values == std::vector<std::string>{"2", "square"});
  CHECK(runs[2].scene.inserts.empty());
  REQUIRE(runs[3].scene.inserts.size() == 1);
  CHECK(runs[3].scene.inserts[0].width == 30);
  CHECK(runs[3].scene.time.cfl == 0.25);
  CHECK(runs[3].scene.time.end == 2);
  CHECK(files.runs("cases: {a: {x: {time.end: 3}}}\n")[0].scene.time.end == 3);
  files.refuses("axes: {a: [1]}\ncases: {a: {x: {}}}\nset: {time.end: a}\n", "cases.a: is an axis already");
  files.refuses("cases: {a: {x: 3}}\n",
                "cases.a.x: found the number 3 (expected a map of scene paths to values");
  files.refuses("cases: {a: {x: {time.edn: 3}}}\n", "study.yaml:2 time.edn: unknown key");
}

TEST_CASE("the studies in configs are sound") {
  const std::filesystem::path configs =
      std::filesystem::path(__FILE__).parent_path().parent_path().parent_path().parent_path() / "configs";
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(configs / "studies")) {
    INFO(entry.path());
    std::vector<std::string> warnings;
    CHECK_NOTHROW(runs_of(read_study(entry.path()), warnings));
    ++studies;
  }
  CHECK(studies >= 2);
}
