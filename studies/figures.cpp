#include "studies/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/offscreen.hpp"
#include "io/progress.hpp"
#include "studies/figure_pictures.hpp"
#include "studies/sweep.hpp"
#include "studies/sweep_table.hpp"
#include "studies/verdicts.hpp"

namespace hourglass {
namespace {

namespace fs = std::filesystem;

class Figures {
 public:
  explicit Figures(const FiguresOptions& options) : o_(options) {
    std::vector<std::string> wrong;
    for (const fs::path& file : figure_files(o_.files)) try {
        figures_.push_back(read_figure(file, o_.quality));
        std::vector<std::string> doubtful;
        runs_.push_back(runs_of(figures_.back().study, doubtful));
      } catch (const std::invalid_argument& error) {
        wrong.push_back(error.what());
      }
    if (!wrong.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(wrong, "\n")));
  }

  FiguresResult to_end() {
    for (std::size_t f = 0; f < figures_.size() && !result_.interrupted; ++f) {
      const Figure& figure = figures_[f];
      fmt::print("Figure {}: {}\n", figure.number, figure.title);
      std::fflush(stdout);
      if (!run(figure)) break;
      if (!o_.dry_run) conclude(figure, runs_[f]);
    }
    if (!o_.dry_run)
      fmt::print("{} tests: {} pass, {} differ from the thesis for a known reason, {} fail; {}\n",
                 result_.pass + result_.fail + result_.differs, result_.pass, result_.differs, result_.fail,
                 (o_.out / "verdicts.csv").string());
    return result_;
  }

 private:
  fs::path folder(const Figure& figure) const { return o_.out / o_.quality / figure.folder; }

  bool run(const Figure& figure) {
    if (!run_.insert(figure.folder).second) return true;
    const SweepResult done = sweep(figure.study, {.study = figure.study.file,
                                                  .out = folder(figure),
                                                  .jobs = o_.jobs,
                                                  .force = o_.force,
                                                  .dry_run = o_.dry_run,
                                                  .warn = false,
                                                  .equal_runs_in = o_.out / o_.quality,
                                                  .observers = o_.observers,
                                                  .program = o_.program});
    result_.interrupted = done.interrupted;
    return !done.interrupted;
  }

  void conclude(const Figure& figure, const std::vector<StudyRun>& runs) {
    const FigureTable table(figure, ended(figure, runs));
    double seconds = 0;
    for (const FigureRun& one : table.runs())
      if (const auto at = one.merits.find("wall_seconds"); at != one.merits.end()) seconds += at->second;
    std::vector<VerdictRow> rows;
    for (const FindingTest& test : figure.tests) {
      const Finding finding = judge(test, table);
      (finding.verdict == Verdict::pass   ? result_.pass
       : finding.verdict == Verdict::fail ? result_.fail
                                          : result_.differs)++;
      rows.push_back(verdict_row(figure, o_.quality, finding, seconds));
      fmt::print("  {:<8} {}: {:.4g} ({}){}\n", rows.back().verdict, test.what, finding.measured,
                 test.bounds.text(), finding.verdict == Verdict::differs ? ". " + test.why : "");
      std::fflush(stdout);
    }
    keep_verdicts(o_.out / "verdicts.csv", figure, o_.quality, rows);
    try {
      for (const fs::path& path : draw_pictures(figure, table, o_.out / o_.quality / "pictures"))
        fmt::print("  {}\n", path.string());
    } catch (const NoGraphics& error) {
      tell(fmt::format("{}: no pictures: {}", figure.file.string(), error.what()));
    }
  }

  std::vector<FigureRun> ended(const Figure& figure, const std::vector<StudyRun>& runs) const {
    const std::vector<std::vector<std::string>> rows = csv_rows(text_at(folder(figure) / "results.csv"));
    std::vector<FigureRun> out;
    for (const StudyRun& one : runs) {
      FigureRun run{one, false, {}, RunData(folder(figure) / "runs" / one.name, one.scene)};
      for (std::size_t k = 1; k < rows.size(); ++k)
        for (std::size_t c = 0; rows[k][0] == one.name && c < rows[0].size(); ++c) {
          const std::string& cell = rows[k][c];
          if (rows[0][c] == "status") run.ended_well = cell == "finished" || cell == "stopped";
          if (const auto number = number_in(cell);
              number && std::ranges::count(figures_of_merit, rows[0][c]) > 0)
            run.merits[rows[0][c]] = *number;
        }
      out.push_back(std::move(run));
    }
    return out;
  }

  const FiguresOptions& o_;
  std::vector<Figure> figures_;
  std::vector<std::vector<StudyRun>> runs_;
  std::set<std::string> run_;  // folders that this call has brought to their end
  FiguresResult result_;
};

}  // namespace

std::vector<fs::path> figure_files(const std::vector<fs::path>& files) {
  std::vector<fs::path> out;
  for (const fs::path& file : files) {
    if (!fs::is_directory(file)) {
      out.push_back(file);
      continue;
    }
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(file))
      if (entry.path().extension() == ".yaml") inside.push_back(entry.path());
    std::ranges::sort(inside);
    if (inside.empty()) throw std::invalid_argument(file.string() + ": holds no figure (*.yaml)");
    out.insert(out.end(), inside.begin(), inside.end());
  }
  return out;
}

FiguresResult make_figures(const FiguresOptions& options) { return Figures(options).to_end(); }

}  // namespace hourglass
