#include "studies/verdicts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "io/csv.hpp"
#include "io/files.hpp"

namespace hourglass {
namespace {

const std::vector<std::string> columns{"figure", "quality", "test",    "measured",
                                       "bound",  "verdict", "seconds", "why"};

}  // namespace

VerdictRow verdict_row(const Figure& figure, const std::string& quality, const Finding& finding,
                       double seconds) {
  const FindingTest& test = *finding.test;
  return {figure.file.stem().string(),
          quality,
          test.what,
          fmt::format("{:.4g}", finding.measured),
          test.bounds.text(),
          verdict_names[static_cast<int>(finding.verdict)],
          fmt::format("{:.1f}", seconds),
          finding.verdict == Verdict::differs ? test.why : ""};
}

std::vector<VerdictRow> read_verdicts(const std::filesystem::path& path) {
  std::vector<VerdictRow> out;
  const std::vector<std::vector<std::string>> rows = csv_rows(text_at(path));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].size() != columns.size() || (k == 0 && rows[k] != columns))
      throw std::invalid_argument(path.string() + ": holds another table. Choose another folder with --out.");
    const std::vector<std::string>& r = rows[k];
    if (k > 0) out.push_back({r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7]});
  }
  return out;
}

void keep_verdicts(const std::filesystem::path& path, const Figure& figure, const std::string& quality,
                   const std::vector<VerdictRow>& rows) {
  std::vector<VerdictRow> all = read_verdicts(path);
  const std::string name = figure.file.stem().string();
  std::erase_if(all, [&](const VerdictRow& row) { return row.figure == name && row.quality == quality; });
  all.insert(all.end(), rows.begin(), rows.end());
  std::ranges::stable_sort(all, {}, [](const VerdictRow& row) { return std::tie(row.figure, row.quality); });
  std::string text = csv_row(columns);
  for (const VerdictRow& r : all)
    text += csv_row({r.figure, r.quality, r.test, r.measured, r.bound, r.verdict, r.seconds, r.why});
  write_atomically(path, text);
}

}  // namespace hourglass
