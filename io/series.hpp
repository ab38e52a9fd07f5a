#pragma once
// series.csv: what the whole domain does, a row each `output.series_every`.
#include <filesystem>
#include <string>

#include "io/files.hpp"
#include "solver/simulation.hpp"

namespace hourglass {

/// Column names, without the end of line. outflow_<k> counts orifices from 0, as scene paths do; a material's
/// name that holds a comma, a quote or a line break is quoted (RFC 4180).
std::string series_header(const Scene& scene);
/// The row below it; numbers have the digits that read back to the same double.
std::string series_text(const SeriesRow& row);

/// Every row is on the disk when write() returns. Throws std::runtime_error if it does not fit there.
class SeriesFile {
 public:
  SeriesFile(const std::filesystem::path& path, const Scene& scene) : file_(path) {
    file_.append(series_header(scene) + '\n');
  }
  /// One that is there: goes on behind its last row.
  explicit SeriesFile(const std::filesystem::path& path) : file_(path, AppendFile::Start::at_end) {}
  void write(const SeriesRow& row) { file_.append(series_text(row) + '\n'); }

 private:
  AppendFile file_;
};

}  // namespace hourglass
