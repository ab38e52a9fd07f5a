#pragma once
// What is stored of one run, read when it is asked for.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/csv.hpp"
#include "io/frame.hpp"
#include "io/xdmf.hpp"
#include "solver/scene.hpp"

namespace hourglass {

class RunData {
 public:
  using Columns = CsvColumns;

  RunData(std::filesystem::path folder, Scene scene);

  const std::filesystem::path& folder() const { return folder_; }
  const Scene& scene() const { return scene_; }
  /// series.csv by column, and `drained`: the share of the first mass that has left through orifices by then.
  const Columns& series() const;
  /// A formula of the columns, row by row; NaN where it has no value (0/0). Throws FormulaError if it is none.
  std::vector<double> along_series(const std::string& formula) const;
  /// The frame nearest to a time, by default the last, with these fields; velocity_x and velocity_y are there always. Throws
  /// std::runtime_error if there are no frames.
  Frame frame(std::optional<double> time, const std::vector<std::string>& fields) const;
  const RunInfo& info() const { return reader().info(); }

 private:
  const FieldReader& reader() const;

  std::filesystem::path folder_;
  Scene scene_;
  mutable std::optional<Columns> series_;
  mutable std::shared_ptr<FieldReader> reader_;
};

}  // namespace hourglass
