#pragma once
// What `hourglass measure` finds, before it is written: a report shows the same.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/chart.hpp"
#include "studies/measure.hpp"

namespace hourglass {

struct Measured {
  struct Figure {
    std::string quantity;
    double value = 0;
    std::string unit{};  ///< as readers want it; empty: none
    std::optional<double> standard_error{};
    double from = 0, to = 0;  ///< the window of time [T]
  };
  std::vector<Figure> figures;
  std::vector<std::string> notes;                           ///< what is told besides
  std::vector<std::pair<std::string, std::string>> tables;  ///< files in the folder, and their text
  std::vector<std::pair<std::string, Chart>> charts;        ///< files in plots/

  /// Tables and charts; figures, notes and the names of the tables are printed. Throws std::runtime_error.
  void write(const std::filesystem::path& folder) const;
};

/// What measure_run() and measure_study() write; they throw the same.
Measured measured_run(const std::filesystem::path& run, const MeasureOptions& options = {});
Measured measured_study(const std::filesystem::path& folder);

}  // namespace hourglass
