// The page of a study.
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <map>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/progress.hpp"
#include "io/scales.hpp"
#include "io/scene_yaml.hpp"
#include "studies/report.hpp"
#include "studies/report_parts.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t most_runs = 200;  ///< told one by one below the table
constexpr int most_thumbnails = 60;

class StudyReport {
 public:
  explicit StudyReport(const fs::path& folder)
      : folder_(folder), rows_(csv_rows(text_at(folder / "results.csv"))) {
    for (const auto& entry : fs::directory_iterator(folder / "inputs"))
      planned_ += entry.path().extension() == ".yaml";
    if (rows_.empty()) throw std::invalid_argument((folder / "results.csv").string() + ": is empty");
    for (std::size_t c = 0; c < rows_[0].size(); ++c) column_[rows_[0][c]] = c;
    for (const char* name : {"run", "status", "discharge_rate", "reason"})
      if (!column_.contains(name))
        throw std::invalid_argument(fmt::format("{}: has no column {}; it is no table of a sweep.",
                                                (folder / "results.csv").string(), name));
    if (rows_.size() > 1) try {
        measured_ = measured_study(folder);
      } catch (const std::exception& error) {
        trouble_ = error.what();
      }
  }

  std::string page() const {
    const std::string name = folder_.filename().string();
    std::string body = fmt::format(
        "<h1>{}</h1>\n<p class=\"soft\">Granular silo flow, a study of hourglass</p>\n", html_text(name));
    body += ending() + cards();
    if (!trouble_.empty())
      body += fmt::format("<p>Not everything could be measured: {}</p>\n", html_text(trouble_));
    if (!measured_.notes.empty()) {
      body += "<h2>What came out</h2>\n<ul>\n";
      for (const std::string& note : measured_.notes) body += "<li>" + html_text(note) + "</li>\n";
      body += "</ul>\n<p class=\"soft\">± is half of the 95 % confidence interval of the fit.</p>\n";
    }
    std::vector<Chart> plots;
    for (const auto& [file, chart] : measured_.charts) {
      plots.push_back(chart);
      std::string& title = plots.back().title;  // the page names the study
      title = title.starts_with(name + ": ") ? title.substr(name.size() + 2)
                                             : spaced(fs::path(file).stem().string());
    }
    if (const std::string drawn = charts_html(plots); !drawn.empty()) body += "<h2>Plots</h2>\n" + drawn;
    body += "<h2>What was asked</h2>\n" + axes();
    body += "<h2>The runs</h2>\n" + table();
    body += details();
    if (rows_.size() > 1) {
      std::size_t row = 1;  // the first that has a summary
      while (row + 1 < rows_.size() && !fs::exists(folder_ / "runs" / rows_[row][0] / "summary.json")) ++row;
      const SummaryFile first(folder_ / "runs" / rows_[row][0]);
      body += fmt::format("<h2>How it was made</h2>\n<p>As run {} was:</p>\n", html_text(rows_[row][0])) +
              provenance_html(first);
      body += "<h2>How to make it again</h2>\n" + again(first);
    }
    return html_page(name + ": report", body);
  }

 private:
  std::string cell(std::size_t row, const std::string& name) const {
    const auto at = column_.find(name);
    return at == column_.end() ? "" : rows_[row].at(at->second);
  }
  std::size_t done() const { return rows_.size() - 1; }
  static bool well(const std::string& status) { return status == "finished" || status == "stopped"; }
  std::size_t failed() const {
    std::size_t n = 0;
    for (std::size_t k = 1; k < rows_.size(); ++k) n += !well(cell(k, "status"));
    return n;
  }
  /// Of a cell; words stay as they are.
  static std::string number(const std::string& text, int digits) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end == text.c_str() ? text : number_text(value, digits);
  }
  std::size_t first_figure() const { return column_.at("status"); }

  std::string ending() const {
    if (done() < planned_)
      return status_html(
          Ending::open, "not finished",
          fmt::format("{} of {} runs have ended; the same command goes on.", done(), planned_));
    if (failed() > 0)
      return status_html(Ending::bad, "finished",
                         fmt::format("{} of {} runs failed; the table says why.", failed(), planned_));
    return status_html(Ending::good, "finished", fmt::format("all {} runs ended well", planned_));
  }

  std::string cards() const {
    double seconds = 0;
    for (std::size_t k = 1; k < rows_.size(); ++k)
      seconds += std::strtod(cell(k, "wall_seconds").c_str(), nullptr);
    return cards_html({{"runs", fmt::format("{} of {}", done(), planned_)},
                       {"failed", fmt::format("{}", failed())},
                       {"all runs took", duration_text(seconds), "one after the other"}});
  }

  std::string axes() const {
    std::vector<std::vector<std::string>> table{{"axis", "values"}};
    for (std::size_t c = 1; c < first_figure(); ++c) {
      std::vector<std::string> values;
      for (std::size_t k = 1; k < rows_.size(); ++k)
        if (std::ranges::find(values, rows_[k][c]) == values.end()) values.push_back(rows_[k][c]);
      table.push_back({html_text(rows_[0][c]), html_text(fmt::format("{}", fmt::join(values, ", ")))});
    }
    return html_table(table);
  }

  std::string table() const {
    std::vector<std::vector<std::string>> table(1);
    std::vector<std::size_t> shown;  // columns that say something
    for (std::size_t c = 0; c < rows_[0].size(); ++c) {
      const bool empty =
          std::all_of(rows_.begin() + 1, rows_.end(), [&](const auto& r) { return r[c].empty(); });
      if (empty && c > first_figure()) continue;
      shown.push_back(c);
      table[0].push_back(html_text(c > first_figure() ? spaced(rows_[0][c]) : rows_[0][c]));
    }
    for (std::size_t k = 1; k < rows_.size(); ++k) {
      std::vector<std::string> cells;
      for (const std::size_t c : shown) {
        const std::string& text = rows_[k][c];
        if (c == 0)
          cells.push_back(k <= most_runs ? fmt::format("<a href=\"#run-{0}\">{0}</a>", html_text(text))
                                         : html_text(text));
        else if (rows_[0][c] == "status")
          cells.push_back(
              fmt::format("<span class=\"{}\">{}</span>", well(text) ? "good" : "bad", html_text(text)));
        else
          cells.push_back(html_text(c > first_figure() && rows_[0][c] != "reason" ? number(text, 4) : text));
      }
      table.push_back(std::move(cells));
    }
    return html_table(table);
  }

  std::string details() const {
    std::string out = "<h2>Run by run</h2>\n";
    if (done() > most_runs) out += fmt::format("<p>The first {} of them.</p>\n", most_runs);
    int thumbnails = 0;
    for (std::size_t k = 1; k <= std::min(done(), most_runs); ++k) {
      const std::string& run = rows_[k][0];
      std::string values;
      for (std::size_t c = 1; c < first_figure(); ++c)
        values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", rows_[0][c], rows_[k][c]);
      out += fmt::format("<details id=\"run-{0}\"><summary>{0}: {1}</summary>\n", html_text(run),
                         html_text(values));
      out += status_html(well(cell(k, "status")) ? Ending::good : Ending::bad, cell(k, "status"),
                         cell(k, "reason"));
      std::vector<std::pair<std::string, std::string>> figures;
      for (std::size_t c = first_figure() + 1; c < rows_[0].size(); ++c) {
        if (rows_[0][c] != "reason" && !rows_[k][c].empty())
          figures.emplace_back(spaced(rows_[0][c]), number(rows_[k][c], 6));
      }
      out += html_pairs(figures);
      if (thumbnails < most_thumbnails) out += last_pictures(run, thumbnails);
      out += fmt::format(
          "<p class=\"soft\">./hourglass run inputs/{}.yaml runs it alone; its folder is runs/{}.</p>\n"
          "</details>\n",
          html_text(run), html_text(run));
    }
    return out;
  }

  std::string last_pictures(const std::string& run, int& thumbnails) const try {
    const Loaded scene = load_scene(folder_ / "inputs" / (run + ".yaml"));
    if (!scene.ok()) return {};
    std::string out;
    for (const Filmstrip& strip : filmstrips(folder_ / "runs" / run, scene.scene, 1, 2)) {
      out += fmt::format("<figure>{}<figcaption>{}, {}</figcaption></figure>\n",
                         html_image(strip.pngs.back(), strip.name + " of run " + run), html_text(strip.name),
                         html_text(strip.captions.back()));
      ++thumbnails;
    }
    return out.empty() ? out : "<div class=\"thumbs\">\n" + out + "</div>\n";
  } catch (const std::exception&) {  // a picture less
    return {};
  }

  std::string again(const SummaryFile& first) const {
    return again_html(first, "sweep study.yaml", "study.yaml", text_at(folder_ / "study.yaml")) +
           "<p>The study names its base scene by a path relative to itself. The scenes that ran, with every "
           "default, are "
           "inputs/*.yaml in the folder of the study; this is the first:</p>\n" +
           fmt::format("<details><summary>inputs/{0}.yaml</summary><pre>{1}</pre></details>\n",
                       html_text(rows_[1][0]),
                       html_text(text_at(folder_ / "inputs" / (rows_[1][0] + ".yaml"))));
  }

  fs::path folder_;
  std::vector<std::vector<std::string>> rows_;
  std::map<std::string, std::size_t> column_;
  std::size_t planned_ = 0;
  Measured measured_;
  std::string trouble_;
};

}  // namespace

std::string study_report(const fs::path& folder) { return StudyReport(folder).page(); }

fs::path report(const fs::path& given, const fs::path& out) {
  const fs::path folder = fs::path(given / "").parent_path();  // with or without a slash at its end
  std::string page;
  if (fs::exists(folder / "results.csv"))
    page = study_report(folder);
  else if (fs::exists(folder / "scene.yaml") && fs::exists(folder / "series.csv"))
    page = run_report(folder);
  else
    throw std::invalid_argument(fmt::format(
        "{}: holds neither a run (scene.yaml, series.csv) nor a sweep (results.csv). Give the folder of one.",
        folder.string()));
  fs::path path = out.empty() ? folder / "report.html" : out;
  write_atomically(path, page);
  return path;
}

}  // namespace hourglass
