#pragma once
// A figure of the thesis as a file: a study, what its table must show as numbers with bounds, and pictures.
// docs/figures.md lists the keys.
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/render.hpp"
#include "studies/quantities.hpp"
#include "studies/study.hpp"
#include "studies/takes.hpp"

namespace hourglass {

/// Which runs: by axis, the values that count; none named, all.
struct Choice {
  struct Of {
    std::size_t axis = 0;
    std::vector<std::string> values;
    bool others = false;  ///< all but these
  };
  std::vector<Of> of;
};

/// A number taken of some of the runs.
struct Pick {
  std::string of;  ///< a figure of merit or one of the figure's quantities
  Choice where;
  std::optional<std::size_t> along;  ///< axis of x; by default the number of the run
  std::string take = "only";
};

struct Bounds {
  double least = -HUGE_VAL, most = HUGE_VAL;
  bool hold(double x) const { return x >= least && x <= most; }  ///< false for NaN
  std::string text() const;                                      ///< ">= 0.02"
};

struct FindingTest {
  std::string what;   ///< a sentence: what the thesis shows, in this number
  std::string value;  ///< a formula of the picks
  std::map<std::string, Pick> picks;
  Bounds bounds;
  /// Where hourglass is known to contradict the thesis: what it shows instead, and why. Never overlaps with `bounds`.
  std::optional<Bounds> differs{};
  std::string why{};
  std::string only{};  ///< a quality: at the other it is not asked; empty: at both
};

enum class PictureKind { panels, curves, series, profiles, beverloo, radial };
inline constexpr std::array picture_kinds{"panels", "curves", "series", "profiles", "beverloo", "radial"};

/// What is drawn of the runs. A kind uses some of the members.
struct FigurePicture {
  PictureKind kind = PictureKind::panels;
  std::string name;  ///< of the file, without .png
  std::string caption;
  Choice where;
  // panels: a field of some runs at some times, side by side
  std::string field;
  std::vector<double> times;
  std::vector<Overlay> overlays;
  int columns = 3;
  std::optional<std::array<double, 2>> range{};
  // curves: y along an axis, a line for each combination of the others
  std::string y, x, y_title, x_title;
  std::optional<std::size_t> along{};
  bool over_first = false, log_x = false, log_y = false;
  std::optional<Pick> line{};  ///< a level beside each line, of the run with equal other axes
  std::string line_title;
  double line_times = 1;  ///< so many times its number
  // series: formulas of the columns of series.csv by their names in the legend, over x: t or drained
  std::vector<std::pair<std::string, std::string>> formulas;
  // profiles: at these heights, with the kinematic fit
  std::vector<double> heights;
  // radial: y is `error`, of the shooting over this range of q on the axis, or `q`, over the angle
  std::array<double, 2> q_range{};
};

struct Figure {
  std::filesystem::path file;
  std::string number;  ///< "4.16"
  std::string title;
  std::string finding;  ///< a sentence
  std::string note;
  std::string folder;  ///< of its runs, within that of the quality
  Study study;
  std::map<std::string, Quantity> quantities;
  std::vector<FindingTest> tests;
  std::vector<FigurePicture> pictures;
};

inline const std::vector<std::string> figure_qualities{"quick", "full"};

/// Throws std::invalid_argument, a line for each thing that is wrong: file, line, key, what is allowed, the cure.
Figure read_figure(const std::filesystem::path& file, const std::string& quality);

/// A figure's runs that have ended well, and the rest.
struct FigureRun {
  StudyRun run;
  bool ended_well = false;
  std::map<std::string, double> merits;  ///< of results.csv
  RunData data;
};

class FigureTable {
 public:
  FigureTable(const Figure& figure, std::vector<FigureRun> runs) : figure_(figure), runs_(std::move(runs)) {}

  const std::vector<FigureRun>& runs() const { return runs_; }
  std::vector<const FigureRun*> chosen(const Choice& choice) const;
  /// A figure of merit or quantity of a run; NaN where it failed. Kept once it is known.
  double number(const FigureRun& run, const std::string& of) const;
  /// Of a run on an axis: its value, or of words their number from 1.
  double place(const FigureRun& run, std::size_t axis) const;
  double number(const Pick& pick) const;

 private:
  const Figure& figure_;
  std::vector<FigureRun> runs_;
  mutable std::map<std::pair<std::string, std::string>, double> known_;  // by run and quantity
};

enum class Verdict { pass, fail, differs };
inline constexpr std::array verdict_names{"pass", "fail", "differs"};

struct Finding {
  const FindingTest* test = nullptr;
  double measured = 0;  ///< NaN where a run that it needs failed
  Verdict verdict = Verdict::fail;
};

Finding judge(const FindingTest& test, const FigureTable& table);

}  // namespace hourglass
