#pragma once
// `hourglass measure`: figures of merit and plots of what is stored already. docs/studies.md says what each is.
#include <filesystem>
#include <string>
#include <vector>

namespace hourglass {

/// What is measured of the stored fields of a run.
struct MeasureOptions {
  std::vector<std::string> lines{};   ///< "x0,y0,x1,y1", "x=75" or "y=40" across the domain
  std::vector<std::string> probes{};  ///< "x,y"
  std::vector<std::string> fields{};  ///< along lines and at probes; none: all that are stored
  std::vector<double>
      times{};  ///< lines: the frame nearest to each; none: the mean over the discharge window
  std::vector<double> speeds{};  ///< thresholds of slow grains [sqrt(g d)]; none: quasi_static_thresholds
};

/// Of a run: measure.csv, quasi_static.csv, step_change.csv and residence_time.csv if it has tracers, profiles.csv and
/// probes.csv if asked for, and plots/. Prints the figures. Throws std::invalid_argument, having written nothing, if the
/// folder holds no run or an option is wrong, std::runtime_error if it cannot be read or written.
void measure_run(const std::filesystem::path& run, const MeasureOptions& options = {});

/// Of a sweep, so far: curves.csv, fit.csv if an axis changes the width of orifices, and plots/. Throws as above.
void measure_study(const std::filesystem::path& folder);

/// Either, by what the folder holds. The options are for a run.
void measure(const std::filesystem::path& folder, const MeasureOptions& options = {});

}  // namespace hourglass
