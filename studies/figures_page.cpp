#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "io/files.hpp"
#include "studies/figure_pictures.hpp"
#include "studies/figures.hpp"
#include "studies/verdicts.hpp"

namespace hourglass {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> best_first(figure_qualities.rbegin(), figure_qualities.rend());
constexpr const char *begin_mark = "<!-- figures: begin -->", *end_mark = "<!-- figures: end -->";

struct Shown {
  Figure figure;  ///< at the best quality there is
  std::string quality;
  std::vector<VerdictRow> rows;  ///< each test at the best quality that asks it
};

std::string counts_of(const std::vector<Shown>& all) {
  std::map<std::string, std::map<std::string, int>> counts;  // by quality and verdict
  for (const Shown& one : all)
    for (const VerdictRow& row : one.rows) ++counts[row.quality][row.verdict];
  std::string text = "| quality | tests | pass | differ | fail |\n|---|---|---|---|---|\n";
  for (const auto& [quality, by] : counts) {
    const auto n = [&by = by](const char* verdict) { return by.count(verdict) ? by.at(verdict) : 0; };
    text += fmt::format("| {} | {} | {} | {} | {} |\n", quality, n("pass") + n("differs") + n("fail"),
                        n("pass"), n("differs"), n("fail"));
  }
  return text;
}

std::string list_of(const std::vector<Shown>& all) {
  std::string text = "| figure | what | quality | verdicts |\n|---|---|---|---|\n";
  for (const Shown& one : all) {
    std::vector<std::string> verdicts;
    for (const char* verdict : verdict_names)
      if (const auto n = std::ranges::count(one.rows, verdict, &VerdictRow::verdict); n > 0)
        verdicts.push_back(fmt::format("{} {}", n, verdict));
    text += fmt::format("| {} | {} | {} | {} |\n", one.figure.number, one.figure.title, one.quality,
                        fmt::join(verdicts, ", "));
  }
  return text;
}

std::string contradictions_of(const std::vector<Shown>& all) {
  std::string text;
  for (const Shown& one : all)
    for (const VerdictRow& row : one.rows)
      if (row.verdict == "differs")
        text += fmt::format("* **{}**, {}: measured {}, the thesis {}. {}\n", one.figure.number, row.test,
                            row.measured, row.bound, row.why);
  return text.empty() ? "None.\n" : text;
}

std::string section_of(const Shown& one, const std::map<std::string, std::string>& pictures,
                       const std::string& folder) {
  const Figure& figure = one.figure;
  std::string text = fmt::format("### {} {}\n\n{}\n\n", figure.number, figure.title, figure.finding);
  if (!figure.note.empty()) text += figure.note + "\n\n";
  text += fmt::format("`configs/figures/{}`, {}, {} s of runs\n\n", figure.file.filename().string(),
                      one.quality, one.rows.front().seconds);
  text += "| test | quality | measured | thesis | verdict |\n|---|---|---|---|---|\n";
  for (const VerdictRow& row : one.rows)
    text += fmt::format("| {} | {} | {} | {} | {} |\n", row.test, row.quality, row.measured, row.bound,
                        row.verdict);
  text += '\n';
  for (const auto& [name, caption] : pictures) text += fmt::format("![{}]({}/{})\n\n", caption, folder, name);
  return text;
}

}  // namespace

void write_figures_page(const std::vector<fs::path>& files, const fs::path& out, const fs::path& page) {
  const std::vector<VerdictRow> rows = read_verdicts(out / "verdicts.csv");
  std::vector<Shown> all;
  for (const fs::path& file : figure_files(files)) {
    std::vector<VerdictRow> its;
    for (const std::string& quality : best_first)
      for (const VerdictRow& row : rows)
        if (row.figure == file.stem().string() && row.quality == quality &&
            std::ranges::count(its, row.test, &VerdictRow::test) == 0)
          its.push_back(row);
    if (its.empty()) continue;
    const std::string quality = its.front().quality;
    all.push_back({read_figure(file, quality), quality, std::move(its)});
  }
  if (all.empty())
    throw std::invalid_argument((out / "verdicts.csv").string() +
                                ": has no verdicts. Run hourglass figures first.");

  const std::string folder = page.stem().string();
  fs::create_directories(page.parent_path() / folder);
  std::string text = fmt::format("\n{}\n{}\n## Where hourglass contradicts the thesis\n\n{}\n## Figures\n\n",
                                 counts_of(all), list_of(all), contradictions_of(all));
  for (const Shown& one : all) {
    std::map<std::string, std::string> pictures;  // captions by name
    for (const std::string& quality : best_first)
      for (const FigurePicture& picture : read_figure(one.figure.file, quality).pictures) {
        const std::string name = picture_name(one.figure, picture);
        const fs::path from = out / quality / "pictures" / name;
        if (fs::exists(from) && pictures.emplace(name, picture.caption).second)
          fs::copy_file(from, page.parent_path() / folder / name, fs::copy_options::overwrite_existing);
      }
    text += section_of(one, pictures, folder);
  }
  // What is written by hand around the marks stays.
  const std::string before = text_at(page);
  const std::size_t begin = before.find(begin_mark), end = before.find(end_mark);
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    write_atomically(page, fmt::format("# Figures\n\n{}\n{}{}\n", begin_mark, text, end_mark));
    return;
  }
  write_atomically(page, before.substr(0, begin) + begin_mark + '\n' + text + before.substr(end));
}

}  // namespace hourglass
