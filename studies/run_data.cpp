#include "studies/run_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "io/csv.hpp"
#include "studies/formula.hpp"

namespace hourglass {

RunData::RunData(std::filesystem::path folder, Scene scene)
    : folder_(std::move(folder)), scene_(std::move(scene)) {}

const RunData::Columns& RunData::series() const {
  if (series_) return *series_;
  series_ = csv_columns(folder_ / "series.csv");
  const std::vector<double>&t = (*series_)["t"], &outflow = (*series_)["outflow"];
  std::vector<double> drained(t.size());
  for (std::size_t k = 1; k < t.size(); ++k) drained[k] = drained[k - 1] + outflow[k] * (t[k] - t[k - 1]);
  const double first = series_->at("mass").front();
  for (double& share : drained) share /= first;
  (*series_)["drained"] = std::move(drained);
  return *series_;
}

std::vector<double> RunData::along_series(const std::string& formula) const {
  const Columns& columns = series();
  if (const auto at = columns.find(formula); at != columns.end()) return at->second;
  const std::set<std::string> names = names_in(formula);
  std::vector<double> values;
  for (std::size_t k = 0; k < columns.at("t").size(); ++k) {
    std::map<std::string, double> numbers;
    for (const std::string& name : names) {
      const auto at = columns.find(name);
      if (at == columns.end()) throw FormulaError("series.csv has no column " + name);
      numbers[name] = at->second[k];
    }
    try {
      values.push_back(value_of(formula, numbers));
    } catch (const FormulaError&) {  // not finite
      values.push_back(std::numeric_limits<double>::quiet_NaN());
    }
  }
  return values;
}

const FieldReader& RunData::reader() const {
  if (!reader_) reader_ = std::make_shared<FieldReader>(folder_);
  if (reader_->times().empty()) throw std::runtime_error(folder_.string() + ": has no frames");
  return *reader_;
}

Frame RunData::frame(std::optional<double> time, const std::vector<std::string>& fields) const {
  const std::vector<double>& times = reader().times();
  const auto nearer = [&](double a, double b) { return std::abs(a - *time) < std::abs(b - *time); };
  const auto at = time ? std::ranges::min_element(times, nearer) : times.end() - 1;
  std::vector<std::string> stored = fields;
  std::erase_if(stored, [](const std::string& name) { return name == "velocity_x" || name == "velocity_y"; });
  Frame frame = reader().read(static_cast<int>(at - times.begin()), stored);
  for (const std::string& name : fields)
    if (std::ranges::count(stored, name) == 0)
      frame.fields.emplace_back(name, name == "velocity_x" ? frame.velocity_x : frame.velocity_y);
  return frame;
}

}  // namespace hourglass
