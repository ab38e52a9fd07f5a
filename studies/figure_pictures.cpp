#include "studies/figure_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "io/chart.hpp"
#include "io/fit_run.hpp"
#include "io/montage.hpp"
#include "solver/diagnostics.hpp"
#include "solver/steady_flow.hpp"
#include "studies/beverloo.hpp"

namespace hourglass {
namespace {

namespace fs = std::filesystem;

constexpr int chart_width = 900, chart_height = 620;
constexpr std::array marks{Mark::disc, Mark::square, Mark::diamond, Mark::triangle, Mark::ring};

class Drawing {
 public:
  Drawing(const Figure& figure, const FigurePicture& picture, const FigureTable& table, const fs::path& path)
      : figure_(figure), p_(picture), table_(table), path_(path), runs_(table.chosen(picture.where)) {
    std::erase_if(runs_, [](const FigureRun* run) { return !run->ended_well; });
  }

  void draw() {
    if (runs_.empty()) throw std::runtime_error(path_.string() + ": none of its runs ended well");
    switch (p_.kind) {
      case PictureKind::panels:
        return panels();
      case PictureKind::curves:
        return curves();
      case PictureKind::series:
        return series();
      case PictureKind::profiles:
        return profiles();
      case PictureKind::beverloo:
        return beverloo();
      case PictureKind::radial:
        return radial();
    }
  }

 private:
  /// What tells a run from the others that are drawn; `but` is an axis that does not count.
  std::string label(const FigureRun& run, std::optional<std::size_t> but = {}) const {
    std::vector<std::string> parts;
    for (std::size_t a = 0; a < run.run.values.size(); ++a) {
      const bool differ = std::ranges::any_of(
          runs_, [&](const FigureRun* other) { return other->run.values[a] != run.run.values[a]; });
      if (!differ || a == but || advances_with(a, but)) continue;
      const std::string& value = run.run.values[a];
      parts.push_back(number_in(value) ? figure_.study.axes[a].name + " = " + value : value);
    }
    return fmt::format("{}", fmt::join(parts, ", "));
  }
  bool advances_with(std::size_t a, std::optional<std::size_t> b) const {
    return b && std::ranges::any_of(figure_.study.groups, [&](const std::vector<int>& group) {
             return std::ranges::count(group, int(a)) > 0 && std::ranges::count(group, int(*b)) > 0;
           });
  }
  Units units() const { return runs_[0]->run.scene.units; }

  Chart chart() const {
    return {.title = p_.caption,
            .x = {.title = p_.x_title},
            .y = {.title = p_.y_title},
            .width = chart_width,
            .height = chart_height};
  }

  // ---- fields ------------------------------------------------------------------------------------------------

  void panels() {
    struct One {
      Picture picture;
      std::string label;
    };
    std::vector<One> all;
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const FigureRun* run : runs_) {
      std::vector<std::optional<double>> times(p_.times.begin(), p_.times.end());
      if (times.empty()) times.emplace_back();
      for (const std::optional<double>& time : times) {
        const Frame frame = run->data.frame(time, {"grains", p_.field});
        Picture picture = picture_of(p_.field, frame, run->data.info(), {.overlays = p_.overlays});
        const auto extremes = shown_extremes(picture);
        lo = std::min(lo, extremes[0]);
        hi = std::max(hi, extremes[1]);
        std::string text = label(*run);
        if (times.size() > 1) text += fmt::format("{}t = {:.0f} √(d/g)", text.empty() ? "" : ", ", frame.t);
        all.push_back({std::move(picture), std::move(text)});
      }
    }
    std::vector<Panel> panels;
    for (One& one : all) {
      if (p_.range) one.picture.range = p_.range;
      if (!one.picture.range) one.picture.range = nice_range(lo, hi, one.picture.log_scale);
      const fs::path file =
          path_.parent_path() / fmt::format("{}_panel_{}.png", path_.stem().string(), panels.size());
      render_png(one.picture, file);
      panels.push_back({file, one.label});
    }
    const int width = panels.size() == 1 ? 900 : p_.columns <= 2 ? 760 : p_.columns == 3 ? 600 : 500;
    draw_montage(panels, p_.columns, width, path_);
    for (const Panel& panel : panels) fs::remove(panel.picture);
  }

  // ---- charts ------------------------------------------------------------------------------------------------

  void curves() {
    Chart out = chart();
    if (out.x.title.empty()) out.x.title = figure_.study.axes[*p_.along].name;
    out.x.log = p_.log_x, out.y.log = p_.log_y;
    const bool words = std::ranges::any_of(
        runs_, [&](const FigureRun* run) { return !number_in(run->run.values[*p_.along]); });
    for (const FigureRun* run : runs_) {
      const std::string name = label(*run, p_.along);
      auto at = std::ranges::find(out.series, name, &Series::name);
      if (at == out.series.end()) {
        const auto k = out.series.size();
        at = out.series.insert(
            out.series.end(),
            {.name = name, .line = !words, .mark = marks[k % marks.size()], .colour = int(k)});
      }
      at->x.push_back(table_.place(*run, *p_.along));
      at->y.push_back(table_.number(*run, p_.y));
      if (words) at->labels.push_back(run->run.values[*p_.along]);
    }
    for (const FigureRun* level : p_.line ? table_.chosen(p_.line->where) : std::vector<const FigureRun*>{})
      for (std::size_t k = 0, n = out.series.size(); k < n; ++k) {
        if (out.series[k].name != label(*level, p_.along)) continue;
        const double y = p_.line_times * table_.number(*level, p_.line->of);
        const auto [from, to] = std::ranges::minmax(out.series[k].x);
        out.series.push_back({.name = n == 1 ? p_.line_title : out.series[k].name + ", " + p_.line_title,
                              .x = {from, to},
                              .y = {y, y},
                              .dashed = true,
                              .colour = int(k)});
      }
    if (p_.over_first) {
      std::map<int, double> first;  // by colour: a line and its level
      for (const Series& s : out.series) first.emplace(s.colour, s.y.front());
      for (Series& s : out.series)
        for (double& y : s.y) y /= first[s.colour];
    }
    draw_chart(out, path_);
  }

  void series() {
    Chart out = chart();
    if (out.x.title.empty())
      out.x.title =
          p_.x == "t" ? fmt::format("time [{}]", unit_text("T", units())) : "share of the silo drained";
    for (const FigureRun* run : runs_)
      for (const auto& [name, formula] : p_.formulas) {
        const std::string of = label(*run);
        out.series.push_back({.name = name.empty() || of.empty() ? name + of : of + ": " + name,
                              .x = run->data.series().at(p_.x),
                              .y = run->data.along_series(formula),
                              .colour = int(out.series.size())});
        out.series.back().x.front() =
            std::numeric_limits<double>::quiet_NaN();  // rows hold means since the last
      }
    draw_chart(out, path_);
  }

  void profiles() {
    Chart out = chart();
    out.x.title = fmt::format("x [{}]", unit_text("L", units()));
    out.y.title = fmt::format("vertical velocity [{}]", unit_text("L/T", units()));
    const RunFit fit =
        fit_run(runs_[0]->data.folder(), p_.times.empty() ? std::nullopt : std::optional(p_.times[0]));
    std::set<const RunFit::Height*> drawn;
    for (const double height : p_.heights) {
      const auto h = std::ranges::min_element(fit.heights, {},
                                              [&](const auto& one) { return std::abs(one.y - height); });
      if (!drawn.insert(&*h).second) continue;
      const int colour = int(drawn.size()) - 1;
      Series run{.name = fmt::format("mu(I), y = {:.0f}", h->y),
                 .line = false,
                 .mark = Mark::disc,
                 .colour = colour};
      Series model{.name = "fit", .dashed = false, .colour = colour};
      const std::size_t every = std::max<std::size_t>(1, h->samples.size() / 64);
      for (std::size_t k = 0; k < h->samples.size(); ++k) {
        model.x.push_back(h->samples[k].x);
        model.y.push_back(h->fit[k]);
        if (k % every != 0) continue;
        run.x.push_back(h->samples[k].x);
        run.y.push_back(h->samples[k].v);
      }
      out.series.push_back(run);
      out.series.push_back(model);
    }
    draw_chart(out, path_);
  }

  void beverloo() {
    Chart out = chart();
    out.x.title = "width of the orifices [d]";
    out.y.title =
        runs_[0]->run.scene.axisymmetric() ? "discharge rate [ρ √(g d⁵)]" : "discharge rate [ρ √(g d³)]";
    struct Line {
      std::string name;
      std::vector<DischargePoint> points;
      std::vector<double> widths;
    };
    std::vector<Line> lines;
    for (const FigureRun* run : runs_) {
      const std::string name = label(*run, width_axis());
      auto at = std::ranges::find(lines, name, &Line::name);
      if (at == lines.end()) at = lines.insert(lines.end(), Line{name, {}, {}});
      at->points.push_back(discharge_point(run->run.scene, table_.number(*run, p_.y)));
      at->widths.push_back(total_width(run->run.scene));
    }
    const double m = runs_[0]->run.scene.axisymmetric() ? 2.5 : 1.5;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      const Line& line = lines[l];
      const std::string prefix = line.name.empty() ? "" : line.name + ": ";
      Series runs{.name = prefix + "runs", .line = false, .mark = marks[l % marks.size()], .colour = int(l)};
      for (std::size_t k = 0; k < line.points.size(); ++k) {
        runs.x.push_back(line.widths[k]);
        runs.y.push_back(line.points[k].rate);
      }
      out.series.push_back(runs);
      if (line.points.size() < 3) continue;
      for (const bool free : {true, false}) {
        if (!free && lines.size() > 2) continue;
        const BeverlooFit fit = fit_beverloo(line.points, {free ? std::nullopt : std::optional(0.0), m}, m);
        Series curve{
            .name =
                prefix + (free ? fmt::format("k = {:.2f} ± {:.2f}", fit.value[1], fit.interval[1]) : "k = 0"),
            .dashed = !free,
            .colour = int(l)};
        const auto widest = std::ranges::max_element(line.widths) - line.widths.begin();
        for (int i = 1; i <= 100; ++i) {
          std::vector<double> widths = line.points[widest].widths;
          for (double& w : widths) w *= 1.03 * i / 100;
          curve.x.push_back(1.03 * line.widths[widest] * i / 100);
          curve.y.push_back(fit.rate(widths));
        }
        out.series.push_back(curve);
      }
    }
    draw_chart(out, path_);
  }
  /// The axis whose values go with the total width.
  std::optional<std::size_t> width_axis() const {
    for (std::size_t a = 0; a < figure_.study.axes.size(); ++a) {
      std::map<std::string, std::set<double>> widths;
      for (const FigureRun* run : runs_) widths[run->run.values[a]].insert(total_width(run->run.scene));
      if (widths.size() > 1 &&
          std::ranges::all_of(widths, [](const auto& one) { return one.second.size() == 1; }))
        return a;
    }
    return std::nullopt;
  }

  void radial() {
    Chart out = chart();
    Scene scene = runs_[0]->run.scene;
    resolve_model(scene);
    const RadialHopper hopper = radial_hopper(scene);
    constexpr int points = 400;
    constexpr double degrees = 180 / std::numbers::pi;
    Series line{};
    if (p_.y == "error") {
      out.x.title = "q on the axis (compression positive)";
      out.y.title = "psi at the wall less what it must be [degrees]";
      for (int k = 0; k <= points; ++k) {
        const double q = p_.q_range[0] + (p_.q_range[1] - p_.q_range[0]) * k / points;
        line.x.push_back(q);
        line.y.push_back(degrees *
                         shooting_error(hopper, q).value_or(std::numeric_limits<double>::quiet_NaN()));
      }
      out.lines.push_back({ReferenceLine::Way::horizontal, 0, ""});
    } else if (const auto field = radial_field(hopper)) {
      out.x.title = "theta [degrees]";
      out.y.title = "q";
      for (int k = 0; k <= points; ++k) {
        line.x.push_back(degrees * hopper.half_angle * k / points);
        line.y.push_back(field->at(hopper.half_angle * k / points).q);
      }
    }
    out.series.push_back(line);
    draw_chart(out, path_);
  }

  const Figure& figure_;
  const FigurePicture& p_;
  const FigureTable& table_;
  fs::path path_;
  std::vector<const FigureRun*> runs_;
};

}  // namespace

std::string picture_name(const Figure& figure, const FigurePicture& picture) {
  return figure.file.stem().string() + '_' + picture.name + ".png";
}

std::vector<fs::path> draw_pictures(const Figure& figure, const FigureTable& table, const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<fs::path> paths;
  for (const FigurePicture& picture : figure.pictures) {
    paths.push_back(folder / picture_name(figure, picture));
    Drawing(figure, picture, table, paths.back()).draw();
  }
  return paths;
}

}  // namespace hourglass
