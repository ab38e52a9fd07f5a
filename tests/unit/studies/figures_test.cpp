#include "studies/figures.hpp"

#include <catch2/catch.hpp>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/scene_yaml.hpp"
#include "studies/figure.hpp"
#include "studies/verdicts.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const fs::path root = fs::path(__FILE__).parent_path().parent_path().parent_path().parent_path();

constexpr const char* head = "figure: '1'\ntitle: a title\nfinding: a finding\nscene: silo.yaml\n";
constexpr const char* tail =
    "tests: [{what: it, take: mean, at_least: 1}]\n"
    "pictures: [{kind: curves, name: rate, caption: c, along: width}]\n";

class FigureFiles {
 public:
  FigureFiles() { folder_.write("silo.yaml", to_yaml(sound_scene())); }
  fs::path write(const std::string& text, const std::string& name = "one.yaml") const {
    return folder_.write(name, text);
  }
  void refuses(const std::string& text, const std::string& why) const {
    INFO(text);
    CHECK_THROWS_WITH(read_figure(write(text), "quick"), Contains(why));
  }
  const TestFolder& folder() const { return folder_; }

 private:
  TestFolder folder_;
};

const std::string axes = "axes: {width: [10, 20, 30]}\nset: {orifices.0.width: width}\n";

/// A table of rates by width.
FigureTable table_of(const Figure& figure, const std::vector<double>& rates) {
  std::vector<std::string> warnings;
  std::vector<FigureRun> runs;
  for (const StudyRun& run : runs_of(figure.study, warnings)) {
    const double rate = rates[runs.size()];
    runs.push_back({run, true, {{"discharge_rate", rate}}, RunData("nowhere", run.scene)});
  }
  return {figure, std::move(runs)};
}

}  // namespace

TEST_CASE("every figure of the thesis can be read at every quality, with all of its runs") {
  const std::vector<fs::path> files = figure_files({root / "configs/figures"});
  CHECK(files.size() == 26);  // the rows of figures, from 4.2 to 6.16
  for (const fs::path& file : files)
    for (const std::string& quality : figure_qualities) {
      INFO(file.string() << ", " << quality);
      const Figure figure = read_figure(file, quality);
      std::vector<std::string> warnings;
      CHECK_FALSE(runs_of(figure.study, warnings).empty());
      CHECK_FALSE(figure.tests.empty());
      CHECK_FALSE(figure.pictures.empty());
    }
}

TEST_CASE("a figure's tests are formulas of what is taken of its runs") {
  const FigureFiles files;
  const Figure figure =
      read_figure(files.write(head + axes +
                              "tests:\n"
                              "  - {what: grows, along: width, take: largest_fall, at_most: 0}\n"
                              "  - what: ratio\n"
                              "    value: a / b\n"
                              "    pick: {a: {where: {width: 30}}, b: {where: {width: '!30'}, take: max}}\n"
                              "    between: [5, 6]\n"
                              "    differs: {at_most: 4, why: because}\n"
                              "pictures: [{kind: curves, name: rate, caption: c, along: width}]\n"),
                  "quick");
  REQUIRE(figure.tests.size() == 2);
  const FigureTable rising = table_of(figure, {1, 2, 11}), falling = table_of(figure, {3, 2, 1}),
                    between = table_of(figure, {1, 2, 9});
  CHECK(judge(figure.tests[0], rising).verdict == Verdict::pass);
  CHECK(judge(figure.tests[0], falling).verdict == Verdict::fail);
  CHECK(judge(figure.tests[1], rising).verdict == Verdict::pass);
  CHECK(judge(figure.tests[1], rising).measured == 5.5);
  CHECK(judge(figure.tests[1], falling).verdict == Verdict::differs);
  CHECK(judge(figure.tests[1], between).verdict ==
        Verdict::fail);  // neither the thesis nor the known difference
  CHECK(judge(figure.tests[1], table_of(figure, {1, 2, NAN})).verdict == Verdict::fail);
}

TEST_CASE("a figure's quality changes its runs, and another figure may have the same") {
  const FigureFiles files;
  files.write(head + axes + "quality: {full: {axes: {width: [20]}, set: {time.end: 7}}}\n" + tail);
  const fs::path second =
      files.write("figure: '2'\ntitle: t\nfinding: f\nruns: one.yaml\n" + std::string(tail), "two.yaml");
  for (const char* name : {"one.yaml", "two.yaml"}) {
    std::vector<std::string> warnings;
    const Figure quick = read_figure(files.folder() / name, "quick"),
                 full = read_figure(files.folder() / name, "full");
    CHECK(quick.folder == "one");
    CHECK(runs_of(quick.study, warnings).size() == 3);
    const auto runs = runs_of(full.study, warnings);
    REQUIRE(runs.size() == 1);
    CHECK(runs[0].scene.time.end == 7);
    CHECK(runs[0].scene.orifices[0].width == 20);
  }
}

TEST_CASE("what is wrong with a figure file is said with line, key and cure") {
  const FigureFiles files;
  const auto figure = [](const std::string& tests, const std::string& more = "") {
    return head + axes + more + "tests: [" + tests +
           "]\npictures: [{kind: curves, name: rate, caption: c, along: width}]\n";
  };
  files.refuses(head + axes, "tests: is missing or empty");
  files.refuses(figure("{what: it, take: men, at_least: 1}"), "Did you mean 'mean'?");
  files.refuses(figure("{what: it, take: mean}"), "expected at_least, at_most or between");
  files.refuses(figure("{what: it, of: rat, at_least: 1}"), "tests.0.of: found 'rat'");
  files.refuses(figure("{what: it, where: {gap: 1}, at_least: 1}"),
                "where.gap: is no axis (there are: width)");
  files.refuses(figure("{what: it, where: {width: 11}, at_least: 1}"),
                "'11' is no value of it (there are: 10, 20, 30)");
  files.refuses(figure("{what: it, value: a / c, pick: {a: {take: mean}}, at_least: 1}"),
                "'c' is no axis with numbers (there are: a)");
  files.refuses(figure("{what: it, take: mean, at_least: 1, differs: {at_least: 0, why: w}}"),
                "overlaps with what the thesis shows");
  files.refuses(figure("{what: it, take: mean, at_least: 1}", "quantities: {q: {kind: prob}}\n"),
                "Did you mean 'probe'?");
  files.refuses(figure("{what: it, take: mean, at_least: 1}", "quality: {ful: {}}\n"),
                "Did you mean 'full'?");
}

TEST_CASE("verdicts are kept by figure and quality") {
  const TestFolder folder;
  const fs::path path = folder / "verdicts.csv";
  Figure b, a;
  b.file = "b.yaml";
  a.file = "a.yaml";
  const FindingTest test{.what = "it, \"so\"", .value = "x", .picks = {}, .bounds = {1, 2}};
  keep_verdicts(path, b, "quick", {verdict_row(b, "quick", {&test, 1.5, Verdict::pass}, 3)});
  keep_verdicts(path, a, "full", {verdict_row(a, "full", {&test, 5, Verdict::fail}, 3)});
  keep_verdicts(path, b, "quick", {verdict_row(b, "quick", {&test, 1.75, Verdict::pass}, 3)});
  const std::vector<VerdictRow> rows = read_verdicts(path);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].figure == "a");
  CHECK(rows[0].verdict == "fail");
  CHECK(rows[1].test == "it, \"so\"");
  CHECK(rows[1].measured == "1.75");
  CHECK(rows[1].bound == "1 to 2");
}
