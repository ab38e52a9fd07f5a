#pragma once
// Comma-separated tables: cells by RFC 4180, one row a line.
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/files.hpp"

namespace hourglass {

/// A cell as it stands in the file: in quotes where it holds a comma, a quote or a line break.
std::string csv_cell(std::string_view text);
/// A row as it stands in the file, with its line break.
std::string csv_row(const std::vector<std::string>& cells);

/// The rows of a table, cells without their quotes; a last row without its line break is no row. Throws
/// std::invalid_argument where a quote is not closed.
std::vector<std::vector<std::string>> csv_rows(std::string_view text);

/// The numbers of a table by column; what is none is NaN. Throws std::invalid_argument if it has no rows.
std::map<std::string, std::vector<double>> csv_numbers(const std::filesystem::path& path);

/// A table on disk that grows by whole rows and goes on where an earlier process left it: a row is found by the text in
/// its first column. What a killed process left of a row is dropped.
class Ledger {
 public:
  using Row = std::map<std::string, std::string>;

  /// Opens the table or begins it. Throws std::invalid_argument if the file holds other columns, std::runtime_error if it
  /// cannot be read or written.
  Ledger(const std::filesystem::path& path, const std::vector<std::string>& columns);

  /// nullptr if there is none.
  const Row* find(const std::string& key) const;
  /// Cells by column, those not named are empty. On disk when add() returns. Throws std::invalid_argument for an unknown
  /// column or a key that is there already, std::runtime_error if it cannot be written.
  void add(const Row& row);
  /// In the order in which they were added.
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& columns() const { return columns_; }

 private:
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
  std::map<std::string, std::size_t> by_key_;
  AppendFile file_;
};

}  // namespace hourglass
