#pragma once
// `hourglass figures`: the thesis's figures, each run, judged and drawn. docs/figures.md.
#include <filesystem>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {

struct FiguresOptions {
  std::vector<std::filesystem::path> files{"configs/figures"};  ///< figure files, or folders of them
  std::string quality = "quick";
  std::filesystem::path out = "figures";
  int jobs = 0;  ///< as of a sweep
  bool force = false, dry_run = false;
  std::vector<Observer*> observers{};                ///< asked whether to stop
  std::filesystem::path program = "/proc/self/exe";  ///< as of a sweep
};

struct FiguresResult {
  int pass = 0, fail = 0, differs = 0;  ///< tests
  bool interrupted = false;             ///< the same call goes on
};

/// Each figure is a sweep in out/<quality>/<figure>; runs of equal scenes are made once, whichever figure asks for them. Writes
/// out/verdicts.csv, a row each test, and out/<quality>/pictures. Throws as sweep() does; if a figure file is wrong, before the first run.
FiguresResult make_figures(const FiguresOptions& options);

/// A page that shows the verdicts of out/verdicts.csv beside pictures and findings, of each figure those of the best quality
/// there is. Pictures go into a folder beside it that has its name. Throws std::invalid_argument where there are no verdicts,
/// std::runtime_error if it cannot be written.
void write_figures_page(const std::vector<std::filesystem::path>& files, const std::filesystem::path& out,
                        const std::filesystem::path& page);

/// Figure files, those of folders in the order of their names. Throws std::invalid_argument if there are none.
std::vector<std::filesystem::path> figure_files(const std::vector<std::filesystem::path>& files);

}  // namespace hourglass
