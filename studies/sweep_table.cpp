#include "studies/sweep_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/yaml_tree.hpp"

namespace hourglass {

SweepTable::SweepTable(const std::filesystem::path& path, const std::vector<StudyAxis>& axes,
                       const std::vector<StudyRun>& runs)
    : path_(path), runs_(runs), columns_{"run"} {
  for (const StudyAxis& axis : axes) columns_.push_back(axis.name);
  columns_.push_back("status");
  columns_.insert(columns_.end(), figures_of_merit.begin(), figures_of_merit.end());
  columns_.push_back("reason");

  const std::vector<std::vector<std::string>> rows = csv_rows(text_at(path));
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(fmt::format(
        "{}: {}. Choose another folder with --out, or replace it with --force.", path.string(), what));
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 0 && rows[k] != columns_) refuse("holds the table of another study");
    if (k == 0) continue;
    const auto at = std::ranges::find(runs, rows[k][0], &StudyRun::name);
    if (at == runs.end() || rows[k].size() != columns_.size() ||
        !std::equal(at->values.begin(), at->values.end(), rows[k].begin() + 1))
      refuse(fmt::format("row {} is of no run of this study", rows[k][0]));
    rows_[static_cast<std::size_t>(at - runs.begin())] = rows[k];
  }
}

int SweepTable::failed() const {
  const auto column = std::ranges::find(columns_, "status") - columns_.begin();
  return static_cast<int>(std::ranges::count_if(rows_, [&](const auto& row) {
    const std::string& status = row.second[static_cast<std::size_t>(column)];
    return status != "finished" && status != "stopped";
  }));
}

void SweepTable::add(std::size_t run, const Cells& cells) {
  std::vector<std::string>& row = rows_[run];
  row = {runs_[run].name};
  row.insert(row.end(), runs_[run].values.begin(), runs_[run].values.end());
  for (std::size_t c = row.size(); c < columns_.size(); ++c) {
    const auto at = cells.find(columns_[c]);
    row.push_back(at == cells.end() ? "" : at->second);
  }
  std::string text = csv_row(columns_);
  for (const auto& [number, one] : rows_) text += csv_row(one);
  write_atomically(path_, text);
}

std::optional<SweepTable::Cells> summary_of(const std::filesystem::path& run_folder) {
  const std::string text = text_at(run_folder / "summary.json");
  if (text.empty()) return std::nullopt;
  const YamlNode summary = parse_yaml(text);  // JSON is YAML
  SweepTable::Cells cells;
  for (const auto& [key, value] : summary.keys)
    if (value.kind == YamlNode::Kind::scalar &&
        (key == "status" || key == "reason" || std::ranges::count(figures_of_merit, key) > 0))
      cells[key] = value.text;
  return cells;
}

}  // namespace hourglass
