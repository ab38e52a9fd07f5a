#pragma once
// verdicts.csv: a row each test of each figure at each quality.
#include <filesystem>
#include <string>
#include <vector>

#include "studies/figure.hpp"

namespace hourglass {

struct VerdictRow {
  std::string figure;  ///< its file's name without .yaml
  std::string quality, test, measured, bound, verdict, seconds, why;
};

VerdictRow verdict_row(const Figure& figure, const std::string& quality, const Finding& finding,
                       double seconds);

/// All of a table; none if there is no file. Throws std::invalid_argument if it is another table.
std::vector<VerdictRow> read_verdicts(const std::filesystem::path& path);

/// Replaces the rows of one figure at one quality; the table stands in the order of the figures' names.
void keep_verdicts(const std::filesystem::path& path, const Figure& figure, const std::string& quality,
                   const std::vector<VerdictRow>& rows);

}  // namespace hourglass
