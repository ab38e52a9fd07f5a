#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "io/chart.hpp"
#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/frame.hpp"
#include "io/scene_yaml.hpp"
#include "solver/diagnostics.hpp"
#include "studies/beverloo.hpp"
#include "studies/measured.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double noticed = 0.01;  ///< a dip and a recovery of less are not told
constexpr std::array marks{Mark::disc, Mark::square, Mark::diamond, Mark::triangle, Mark::ring};

double number_in(const std::string& text) {
  double value = unknown;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() ? value : unknown;
}

struct Row {
  std::vector<std::string> values;  ///< by axis
  double rate = unknown;            ///< of runs that ended well
  Scene scene;
};

/// A line of a plot: the runs that differ in nothing but one group of axes.
struct Line {
  std::string name;  ///< of what it has in common with itself only; empty if it is the only one
  std::vector<const Row*> rows;
};

class StudyMeasure {
 public:
  explicit StudyMeasure(const fs::path& folder) : folder_(folder) {
    read();
    find_groups();
  }

  Measured all() {
    curves();
    std::string text = csv_row(
        {"runs", "points", "fit", "C", "C_interval", "k", "k_interval", "n", "n_interval", "residual"});
    const std::size_t head = text.size();
    for (const std::vector<std::size_t>& group : groups_) text += beverloo(group);
    if (text.size() > head) out_.tables.emplace_back("fit.csv", text);
    return std::move(out_);
  }

 private:
  // ---- the table ---------------------------------------------------------------------------------------------

  void read() {
    const fs::path path = folder_ / "results.csv";
    const std::vector<std::vector<std::string>> rows = csv_rows(text_at(path));
    if (rows.size() < 2)
      throw std::invalid_argument(path.string() + ": has no rows yet. Let the sweep go on.");
    const auto column = [&](const char* name) {
      const auto at = std::ranges::find(rows[0], name);
      if (at == rows[0].end())
        throw std::invalid_argument(
            fmt::format("{}: has no column {}; it is no table of a sweep.", path.string(), name));
      return static_cast<std::size_t>(at - rows[0].begin());
    };
    const std::size_t status = column("status"), rate = column("discharge_rate");
    axes_.assign(rows[0].begin() + 1, rows[0].begin() + static_cast<long>(status));
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const std::vector<std::string>& cells = rows[k];
      if (cells.size() != rows[0].size())
        throw std::invalid_argument(fmt::format("{}: row {} has {} cells instead of {}", path.string(), k,
                                                cells.size(), rows[0].size()));
      const Loaded loaded = load_scene(folder_ / "inputs" / (cells[0] + ".yaml"));
      if (!loaded.ok()) throw std::invalid_argument(loaded.diagnostics.front().text());
      const bool well = cells[status] == "finished" || cells[status] == "stopped";
      rows_.push_back({{cells.begin() + 1, cells.begin() + static_cast<long>(status)},
                       well ? number_in(cells[rate]) : unknown,
                       loaded.scene});
    }
  }

  /// Axes that advance together: the value of one tells that of the other, and the other way round.
  void find_groups() {
    const auto paired = [&](std::size_t a, std::size_t b) {
      std::map<std::string, std::string> there, back;
      return std::ranges::all_of(rows_, [&](const Row& row) {
        const std::string &x = row.values[a], &y = row.values[b];
        return there.emplace(x, y).first->second == y && back.emplace(y, x).first->second == x;
      });
    };
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const auto group = std::ranges::find_if(groups_, [&](const auto& g) { return paired(g[0], a); });
      if (group == groups_.end())
        groups_.push_back({a});
      else
        group->push_back(a);
    }
  }

  std::vector<Line> lines_along(const std::vector<std::size_t>& group) const {
    std::set<std::size_t> one_value;  // axes that say nothing
    for (std::size_t a = 0; a < axes_.size(); ++a)
      if (std::ranges::all_of(rows_, [&](const Row& row) { return row.values[a] == rows_[0].values[a]; }))
        one_value.insert(a);
    std::vector<Line> lines;
    for (const Row& row : rows_) {
      std::vector<std::string> parts;
      for (std::size_t a = 0; a < axes_.size(); ++a)
        if (std::ranges::count(group, a) == 0 && one_value.count(a) == 0)
          parts.push_back(fmt::format("{} = {}", axes_[a], row.values[a]));
      const std::string name = fmt::format("{}", fmt::join(parts, ", "));
      const auto at = std::ranges::find(lines, name, &Line::name);
      if (at == lines.end())
        lines.push_back({name, {&row}});
      else
        at->rows.push_back(&row);
    }
    return lines;
  }

  // ---- the rate along the first axis -------------------------------------------------------------------------

  void curves() {
    const auto group = std::ranges::find_if(groups_, [&](const std::vector<std::size_t>& g) {
      return std::ranges::all_of(rows_,
                                 [&](const Row& row) { return std::isfinite(number_in(row.values[g[0]])); });
    });
    if (group == groups_.end()) return;  // words only
    const std::size_t axis = group->front();
    const auto x_of = [&](const Row* row) { return number_in(row->values[axis]); };
    const std::string unit = unit_text("M/T", rows_[0].scene.units);
    Chart raw{.title = folder_.filename().string(),
              .x = {.title = axes_[axis]},
              .y = {.title = fmt::format("discharge rate [{}]", unit)}};
    Chart normalised = raw;
    std::string text = csv_row({"runs", axes_[axis], "discharge_rate", "normalised"});
    std::vector<Line> lines = lines_along(*group);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      Line& line = lines[k];
      std::ranges::sort(line.rows, {}, x_of);
      Series series{.name = line.name, .mark = marks[k % marks.size()], .colour = static_cast<int>(k)};
      for (const Row* row : line.rows) {
        series.x.push_back(x_of(row));
        series.y.push_back(row->rate);
      }
      raw.series.push_back(series);
      for (double& rate : series.y) rate /= line.rows[0]->rate;
      normalised.series.push_back(series);
      for (std::size_t i = 0; i < line.rows.size(); ++i)
        text += csv_row({line.name, line.rows[i]->values[axis], fmt::format("{}", line.rows[i]->rate),
                         fmt::format("{}", series.y[i])});
      tell_dip(line, series);
    }
    normalised.y.title =
        fmt::format("discharge rate over that at {} = {}", axes_[axis], lines[0].rows[0]->values[axis]);
    normalised.lines.push_back({ReferenceLine::Way::horizontal, 1, ""});
    const auto [least, greatest] = std::ranges::minmax(raw.series[0].x);
    if (least > 0 && greatest > 50 * least) raw.x.log = normalised.x.log = true;
    out_.tables.emplace_back("curves.csv", text);
    draw("discharge_rate.png", raw);
    draw("normalised.png", normalised);
  }

  /// The lowest point that has a recovery after it.
  void tell_dip(const Line& line, const Series& series) {
    double low = 1 - noticed, at = unknown, back = 0, after = 0;  // after: the largest rate behind the point
    for (std::size_t i = series.y.size(); i-- > 0;) {
      const double y = series.y[i];
      if (y < low && after > (1 + noticed) * y) low = y, at = series.x[i], back = after;
      if (std::isfinite(y)) after = std::max(after, y);
    }
    if (std::isfinite(at))
      out_.notes.push_back(fmt::format("{}{}a dip of {:.1f} % at {}, then back to {:.1f} % of the first",
                                       line.name, line.name.empty() ? "" : ": ", 100 * (1 - low), at,
                                       100 * back));
  }

  // ---- the law of Beverloo -----------------------------------------------------------------------------------

  /// The scale of a rate in rho sqrt(g) d^m, and m.
  static std::pair<double, double> scale_of(const Scene& scene) {
    const double d = scene.materials[0].diameter;
    return {discharge_scale(scene, d), scene.axisymmetric() ? 2.5 : 1.5};
  }

  static DischargePoint point_of(const Row& row) { return discharge_point(row.scene, row.rate); }

  struct Model {
    const char* name;
    BeverlooHeld held;
  };

  /// Rows of fit.csv, and a plot; nothing if the group does not change the width of the orifices, or not often enough.
  std::string beverloo(const std::vector<std::size_t>& group) {
    std::vector<Line> lines = lines_along(group);
    std::string text;
    const auto [scale, m] = scale_of(rows_[0].scene);
    Chart chart{.title = fmt::format("{}: Beverloo's law", folder_.filename().string()),
                .x = {.title = "width of the orifices [d]"},
                .y = {.title = m == 1.5 ? "discharge rate [ρ √(g d³)]" : "discharge rate [ρ √(g d⁵)]"}};
    const std::vector<Model> models{
        {"k free", {{}, m}}, {"k = 0", {0.0, m}}, {"k and n free", {{}, {}}}, {"n free, k = 0", {0.0, {}}}};
    for (std::size_t l = 0; l < lines.size(); ++l) {
      std::vector<DischargePoint> points;
      std::set<double> widths;
      for (const Row* row : lines[l].rows) {
        if (!std::isfinite(row->rate) || row->scene.orifices.empty()) continue;
        points.push_back(point_of(*row));
        widths.insert(total_width(row->scene));
      }
      if (widths.size() < 3) continue;
      for (std::size_t f = 0; f < models.size(); ++f) {
        if (points.size() < (f == 2 ? 4u : 3u)) continue;
        const BeverlooFit fit = fit_beverloo(points, models[f].held, m);
        std::vector<std::string> cells{lines[l].name, fmt::format("{}", points.size()), models[f].name};
        std::vector<std::string> told;
        for (int i = 0; i < 3; ++i) {
          cells.push_back(fmt::format("{}", fit.value[i]));
          cells.push_back(fmt::format("{}", fit.interval[i]));
          if (fit.interval[i] != 0)
            told.push_back(fmt::format("{} = {:.4g} ± {:.2g}", "Ckn"[i], fit.value[i], fit.interval[i]));
        }
        cells.push_back(fmt::format("{}", fit.residual));
        text += csv_row(cells);
        out_.notes.push_back(fmt::format("{}{}{}: {}, residual {:.3g}", lines[l].name,
                                         lines[l].name.empty() ? "" : ", ", models[f].name,
                                         fmt::join(told, ", "), fit.residual));
        if (f < 2) show(chart, lines[l].name, points, fit, f == 0, static_cast<int>(l));
      }
    }
    if (!text.empty()) draw("beverloo.png", chart);
    return text;
  }

  static void show(Chart& chart, const std::string& name, const std::vector<DischargePoint>& points,
                   const BeverlooFit& fit, bool k_free, int colour) {
    const std::string prefix = name.empty() ? "" : name + ": ";
    // A point stands at the sum of its widths; those between have their proportions.
    const auto total = [](const DischargePoint& p) {
      double sum = 0;
      for (const double width : p.widths) sum += width;
      return sum;
    };
    const auto widest = std::ranges::max_element(points, {}, total);
    if (k_free) {
      Series runs{.name = prefix + "runs",
                  .line = false,
                  .mark = marks[static_cast<std::size_t>(colour) % marks.size()],
                  .colour = colour};
      for (const DischargePoint& p : points) {
        runs.x.push_back(total(p));
        runs.y.push_back(p.rate);
      }
      chart.series.push_back(runs);
    }
    Series line{.name = prefix + (k_free ? fmt::format("k = {:.3g} ± {:.2g}", fit.value[1], fit.interval[1])
                                         : "k = 0"),
                .dashed = !k_free,
                .colour = colour};
    constexpr int pieces = 100;
    for (int i = 1; i <= pieces; ++i) {
      std::vector<double> widths = widest->widths;
      for (double& width : widths) width *= 1.03 * i / pieces;
      const double rate = fit.rate(widths), half = fit.rate_interval(widths);
      line.x.push_back(total({widths, 0}));
      line.y.push_back(rate);
      if (k_free && std::isfinite(half)) {
        line.lower.push_back(std::max(0.0, rate - half));
        line.upper.push_back(rate + half);
      }
    }
    chart.series.push_back(line);
  }

  void draw(const std::string& name, const Chart& chart) { out_.charts.emplace_back(name, chart); }

  fs::path folder_;
  std::vector<std::string> axes_;
  std::vector<Row> rows_;
  std::vector<std::vector<std::size_t>> groups_;  ///< axes by number
  Measured out_;
};

}  // namespace

Measured measured_study(const fs::path& folder) { return StudyMeasure(folder).all(); }

void measure_study(const fs::path& folder) { measured_study(folder).write(folder); }

}  // namespace hourglass
