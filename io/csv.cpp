#include "io/csv.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <utility>

namespace hourglass {
namespace fs = std::filesystem;
namespace {

/// The file less what stands behind its last line break; then open for more.
AppendFile opened(const fs::path& path) {
  const std::string text = text_at(path);
  const std::size_t whole = text.rfind('\n') + 1;  // 0 without any
  if (whole < text.size()) fs::resize_file(path, whole);
  return AppendFile(path, AppendFile::Start::at_end);
}

}  // namespace

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out.append(c == '"' ? 2 : 1, c);
  return out + '"';
}

std::string csv_row(const std::vector<std::string>& cells) {
  std::string out;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) out += ',';
    out += csv_cell(cell);
  }
  return out + '\n';
}

std::vector<std::vector<std::string>> csv_rows(std::string_view text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row;
  std::string cell;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (quoted) {
      if (c != '"') {
        cell += c;
      } else if (k + 1 < text.size() && text[k + 1] == '"') {
        cell += text[++k];
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      row.push_back(std::exchange(cell, {}));
      if (c == '\n') rows.push_back(std::exchange(row, {}));
    } else if (c != '\r') {
      cell += c;
    }
  }
  if (quoted) throw std::invalid_argument("a quote is not closed");
  return rows;
}

std::map<std::string, std::vector<double>> csv_numbers(const std::filesystem::path& path) {
  const std::vector<std::vector<std::string>> rows = csv_rows(text_at(path));
  if (rows.size() < 2) throw std::invalid_argument(path.string() + ": has no rows yet");
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t c = 0; c < rows[0].size(); ++c) {
    std::vector<double>& column = columns[rows[0][c]];
    for (std::size_t k = 1; k < rows.size(); ++k) {
      char* end = nullptr;
      const char* begin = rows[k].at(c).c_str();
      const double value = std::strtod(begin, &end);
      column.push_back(end == begin ? std::numeric_limits<double>::quiet_NaN() : value);
    }
  }
  return columns;
}

Ledger::Ledger(const fs::path& path, const std::vector<std::string>& columns)
    : columns_(columns), file_(opened(path)) {
  std::vector<std::vector<std::string>> rows;
  try {
    rows = csv_rows(text_at(path));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{}: {}", path.string(), error.what()));
  }
  if (rows.empty()) {
    file_.append(csv_row(columns_));
    return;
  }
  if (rows.front() != columns_)
    throw std::invalid_argument(
        fmt::format("{}: holds a table with other columns ({}); remove it or choose another folder",
                    path.string(), fmt::join(rows.front(), ", ")));
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].size() != columns_.size())
      throw std::invalid_argument(fmt::format("{}: row {} has {} cells instead of {}", path.string(), k,
                                              rows[k].size(), columns_.size()));
    Row row;
    for (std::size_t c = 0; c < columns_.size(); ++c) row[columns_[c]] = rows[k][c];
    by_key_[rows[k].front()] = rows_.size();
    rows_.push_back(std::move(row));
  }
}

const Ledger::Row* Ledger::find(const std::string& key) const {
  const auto at = by_key_.find(key);
  return at == by_key_.end() ? nullptr : &rows_[at->second];
}

void Ledger::add(const Row& row) {
  std::vector<std::string> cells;
  std::size_t named = 0;
  for (const std::string& column : columns_) {
    const auto at = row.find(column);
    named += at != row.end();
    cells.push_back(at == row.end() ? "" : at->second);
  }
  if (named != row.size()) throw std::invalid_argument("a cell belongs to no column of the table");
  if (by_key_.count(cells.front())) throw std::invalid_argument(cells.front() + " is in the table already");
  file_.append(csv_row(cells));
  by_key_[cells.front()] = rows_.size();
  rows_.push_back(row);
}

}  // namespace hourglass
