// The page of a run.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/frame.hpp"
#include "io/plan.hpp"
#include "io/progress.hpp"
#include "io/scales.hpp"
#include "io/scene_yaml.hpp"
#include "studies/report_parts.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

constexpr int most_pictures = 40;

class RunReport {
 public:
  explicit RunReport(const fs::path& run) : run_(run), summary_(run) {
    const Loaded loaded = load_scene(run / "scene.yaml");
    if (!loaded.ok()) throw std::invalid_argument(loaded.diagnostics.front().text());
    scene_ = loaded.scene;
    try {
      series_ = csv_columns(run / "series.csv");
      measured_ = measured_run(run);
    } catch (const std::exception& error) {  // a run that has just begun, or has lost a file
      trouble_ = error.what();
    }
  }

  std::string page() const {
    std::string body =
        fmt::format("<h1>{}</h1>\n<p class=\"soft\">Granular silo flow, a run of hourglass</p>\n",
                    html_text(scene_.name));
    body += ending() + cards();
    if (!trouble_.empty())
      body += fmt::format("<p>Not everything could be measured: {}</p>\n", html_text(trouble_));
    body += "<h2>What was asked</h2>\n" + asked();
    body += "<h2>Pictures</h2>\n" + pictures();
    std::vector<Chart> plots;
    for (const auto& [name, chart] : measured_.charts) plots.push_back(untitled(chart));
    if (auto chart = by_orifice()) plots.push_back(*chart);
    if (const std::string drawn = charts_html(plots); !drawn.empty()) body += "<h2>Plots</h2>\n" + drawn;
    if (measured_.figures.size() > 1) body += "<h2>Measured</h2>\n" + figures();
    body += "<h2>Health of the solver</h2>\n" + health();
    body += "<h2>How it was made</h2>\n" + provenance_html(summary_);
    body +=
        "<h2>How to make it again</h2>\n" + again_html(summary_, fmt::format("run scene.yaml{}", threads()),
                                                       "scene.yaml", text_at(run_ / "scene.yaml"));
    return html_page(fmt::format("{}: report", scene_.name), body);
  }

 private:
  std::string unit(const char* dimension) const { return unit_text(dimension, scene_.units); }
  std::string threads() const {
    const std::string number = summary_.text("threads");
    return number.empty() ? "" : " --threads " + number;
  }
  const std::vector<double>* column(const std::string& name) const {
    const auto at = series_.find(name);
    return at == series_.end() || at->second.empty() ? nullptr : &at->second;
  }
  /// Titles in the page need not name the run.
  Chart untitled(Chart chart) const {
    if (chart.title.starts_with(scene_.name + ": ")) chart.title.erase(0, scene_.name.size() + 2);
    return chart;
  }

  std::string ending() const {
    if (!summary_.there()) {
      const auto* t = column("t");
      return status_html(Ending::open, "not finished",
                         fmt::format("There is no summary: the run is still at work, or it was killed. What "
                                     "follows is what it has left {}.",
                                     t ? fmt::format("up to t = {} {}", number_text(t->back(), 4), unit("T"))
                                       : "before its first row"));
    }
    const std::string status = summary_.text("status");
    const bool good = status == "finished" || status == "stopped";
    return status_html(good ? Ending::good : Ending::bad, status, summary_.text("reason"));
  }

  std::string cards() const {
    std::vector<Card> cards;
    const auto figure = [&](const std::string& quantity) {
      const auto at = std::ranges::find(measured_.figures, quantity, &Measured::Figure::quantity);
      return at == measured_.figures.end() ? nullptr : &*at;
    };
    const auto add = [&](const std::string& name, const std::string& key, const std::string& of_unit = "",
                         double factor = 1) {
      if (const auto value = summary_.number(key))
        cards.push_back({name, value_text(*value * factor), of_unit});
    };
    const YamlNode* limit = summary_.node("extrapolation");
    if (limit && limit->find("discharge_rate"))
      cards.push_back({"discharge rate at vanishing cells",
                       value_text(std::strtod(limit->find("discharge_rate")->text.c_str(), nullptr),
                                  std::strtod(limit->find("error_bar")->text.c_str(), nullptr)),
                       unit("M/T")});
    if (const auto* rate = figure("discharge_rate"))
      cards.push_back({"discharge rate", value_text(rate->value, rate->standard_error), rate->unit});
    else
      add("discharge rate", "discharge_rate", unit("M/T"));
    if (const auto* constant = figure("discharge_constant"))
      cards.push_back({scene_.axisymmetric() ? "discharge over ρ √g W^2.5" : "discharge over ρ √g W^1.5",
                       value_text(constant->value, constant->standard_error)});
    add("grains slower than 10⁻³ √(g d)", "quasi_static_fraction", "%", 100);
    add("of them above flat tops", "quasi_static_above_flat_top", "%", 100);
    for (const Measured::Figure& f : measured_.figures)
      if (f.quantity.ends_with("_mean_residence_time") || f.quantity.ends_with("_mixing_index"))
        cards.push_back({spaced(f.quantity), value_text(f.value), f.unit});
    add("loss of mass not seen at the orifices", "mass_error", "of the grains");
    if (const auto* t = column("t"); t && scene_.model == Model::mu_I)
      cards.push_back({"time reached", value_text(t->back()), unit("T")});
    const Patch p = scene_.patch();
    cards.push_back({"grid", fmt::format("{} × {}", p.nx, p.ny),
                     fmt::format("cells of {} {}", number_text(p.h, 4), unit("L"))});
    if (scene_.model == Model::mu_I) add("steps", "steps");
    if (const auto seconds = summary_.number("wall_seconds"))
      cards.push_back({"took", duration_text(*seconds),
                       fmt::format("on {} thread{}", summary_.text("threads"),
                                   summary_.text("threads") == "1" ? "" : "s")});
    if (scene_.model == Model::mu_I) add("cell-steps a second", "cell_steps_per_second");
    add("memory at most", "peak_memory_bytes", "MiB", 1.0 / (1 << 20));
    return cards_html(cards);
  }

  /// "quasi_static_1e-3_above_flat_top": what it is.
  static std::string words_of(const std::string& quantity) {
    const std::string slow = "quasi_static_", above = "_above_flat_top";
    if (!quantity.starts_with(slow)) return spaced(quantity);
    const bool on_top = quantity.ends_with(above);
    const std::string threshold =
        quantity.substr(slow.size(), quantity.size() - slow.size() - (on_top ? above.size() : 0));
    return fmt::format("share of grains slower than {} √(g d){}",
                       number_text(std::strtod(threshold.c_str(), nullptr)),
                       on_top ? ", above flat tops" : "");
  }

  std::string asked() const {
    std::vector<std::pair<std::string, std::string>> rows;
    const auto add = [&](const std::string& name, const std::string& what) { rows.emplace_back(name, what); };
    const Patch p = scene_.patch();
    add("model", model_names[static_cast<int>(scene_.model)]);
    add("domain", fmt::format("{} × {} {}{}{}", number_text(scene_.width), number_text(p.ny * p.h), unit("L"),
                              scene_.axisymmetric() ? ", around an axis" : "",
                              scene_.symmetry == Symmetry::mirror ? ", one half of a silo" : ""));
    for (const Material& m : scene_.materials)
      add("material " + m.name,
          fmt::format("μ_s {}, Δμ {}, I_0 {}, diameter {} {}, density {} {}", number_text(m.mu_s),
                      number_text(m.delta_mu), number_text(m.I_0), number_text(m.diameter), unit("L"),
                      number_text(m.density), unit("M/L^2")));
    for (std::size_t k = 0; k < scene_.orifices.size(); ++k) {
      const Orifice& o = scene_.orifices[k];
      add(fmt::format("orifice {}", k),
          fmt::format("{} {} wide, centre at {} {}, {}", number_text(o.width), unit("L"),
                      number_text(o.centre), unit("L"), side_names[static_cast<int>(o.wall)]));
    }
    for (const Insert& i : scene_.inserts)
      add("insert", i.shape == Shape::polygon
                        ? fmt::format("polygon of {} corners", i.points.size())
                        : fmt::format("{}, {} wide, at ({}, {}) {}", shape_names[static_cast<int>(i.shape)],
                                      number_text(i.width), number_text(i.centre[0]),
                                      number_text(i.centre[1]), unit("L")));
    if (scene_.hopper)
      add("hopper",
          fmt::format("walls at {}° to the vertical, outlet {} {}", number_text(scene_.hopper->half_angle),
                      number_text(scene_.hopper->outlet), unit("L")));
    const auto add_number = [&](const std::string& name, const std::optional<double>& value,
                                const std::string& of_unit) {
      if (value) add(name, fmt::format("{} {}", number_text(*value), of_unit));
    };
    if (scene_.kinematic) add_number("B", scene_.kinematic->B, unit("L"));
    if (scene_.kinematic) add_number("Q", scene_.kinematic->Q, unit("M/T"));
    if (scene_.stochastic) add_number("L_s", scene_.stochastic->L_s, unit("L"));
    if (scene_.stochastic) add_number("Q", scene_.stochastic->Q, unit("M/T"));
    if (scene_.radial) {
      add_number("φ", scene_.radial->phi, "°");
      add_number("φ of the walls", scene_.radial->phi_w, "°");
      add_number("half angle", scene_.radial->half_angle, "°");
      add_number("Q", scene_.radial->Q, unit("M/T"));
    }
    if (scene_.model == Model::mu_I) {
      for (const Switch& s : switches_of(scene_).on) add(s.key, s.what);
      add("end",
          fmt::format("{}{}",
                      scene_.time.end > 0 ? fmt::format("t = {} {}", number_text(scene_.time.end), unit("T"))
                                          : "by its stop conditions",
                      scene_.stop.mass_below
                          ? fmt::format(", or less than {} of the grains left", *scene_.stop.mass_below)
                          : ""));
    }
    return html_pairs(rows);
  }

  std::string pictures() const {
    std::string why;
    try {
      if (const auto strips = filmstrips(run_, scene_, most_pictures, 1); !strips.empty())
        return html_viewer(strips);
    } catch (const std::exception& error) {
      why = fmt::format(" ({})", error.what());
    }
    return fmt::format("<p>None: the run has stored neither fields nor snapshots that can be read{}.</p>\n",
                       html_text(why));
  }

  Chart over_time(const std::string& title, const std::string& y) const {
    return {.title = title, .x = {.title = fmt::format("time [{}]", unit("T"))}, .y = {.title = y}};
  }
  /// A line of a column of the series; its first row is before the first step.
  void add_line(Chart& chart, const std::string& name, const std::string& label) const {
    const auto *t = column("t"), *values = column(name);
    if (!t || !values || t->size() < 2) return;
    if (std::all_of(values->begin(), values->end(), [](double v) { return !(v != 0); })) return;
    chart.series.push_back({.name = label,
                            .x = {t->begin() + 1, t->end()},
                            .y = {values->begin() + 1, values->end()},
                            .colour = static_cast<int>(chart.series.size())});
  }

  std::optional<Chart> by_orifice() const {
    if (scene_.orifices.size() < 2) return {};
    Chart chart = over_time("discharge by orifice", fmt::format("discharge rate [{}]", unit("M/T")));
    for (std::size_t k = 0; k < scene_.orifices.size(); ++k)
      add_line(chart, fmt::format("outflow_{}", k), fmt::format("orifice {}", k));
    return chart.series.empty() ? std::nullopt : std::optional(chart);
  }

  std::string figures() const {
    std::vector<std::vector<std::string>> rows{{"quantity", "value", "unit", "from t", "to t"}};
    for (const Measured::Figure& f : measured_.figures)
      rows.push_back({html_text(words_of(f.quantity)), value_text(f.value, f.standard_error),
                      html_text(f.unit), number_text(f.from, 4), number_text(f.to, 4)});
    return html_table(rows) +
           "<p class=\"soft\">± is the standard error over the window. It does not hold the error of the "
           "grid.</p>\n";
  }

  std::string health() const {
    std::string out;
    if (scene_.model != Model::mu_I) return "<p>A formula: nothing was solved step by step.</p>\n";
    std::vector<Card> cards;
    if (summary_.there()) {
      cards.push_back({"steps that missed a tolerance", summary_.text("missed_tolerances")});
      cards.push_back({"times it went back and on with more care", summary_.text("back_offs")});
      if (const auto worst = summary_.number("worst_max_divergence"))
        cards.push_back({"largest |div u| dt of any step", value_text(*worst),
                         fmt::format("tolerance {}", number_text(scene_.accuracy.pressure_tolerance))});
      out += cards_html(cards);
    }
    if (const YamlNode* warnings = summary_.node("warnings"); warnings && !warnings->items.empty()) {
      out += "<h3>Warnings</h3>\n<ul>\n";
      for (const YamlNode& warning : warnings->items) out += "<li>" + html_text(warning.text) + "</li>\n";
      out += "</ul>\n";
    }
    std::vector<Chart> charts;
    charts.push_back(over_time("iterations of a step", "iterations"));
    for (const char* solve : {"pressure", "viscous", "fluidity"})
      add_line(charts.back(), fmt::format("iterations_{}", solve), solve);
    charts.push_back(over_time("length of a step", fmt::format("dt [{}]", unit("T"))));
    add_line(charts.back(), "dt", "");
    charts.push_back(over_time("divergence", "max |div u| dt"));
    charts.back().y.log = true;
    add_line(charts.back(), "max_divergence", "");
    if (!charts.back().series.empty())
      charts.back().lines.push_back(
          {ReferenceLine::Way::horizontal, scene_.accuracy.pressure_tolerance, "tolerance"});
    charts.push_back(over_time("grain cells where μ(I) is ill-posed", "share of the grain cells"));
    add_line(charts.back(), "ill_posed_fraction", "");
    out += charts_html(charts);
    if (const YamlNode* stages = summary_.node("stages"); stages && !stages->keys.empty()) {
      double all = 0;
      const auto seconds = [](const YamlNode& node) { return std::strtod(node.text.c_str(), nullptr); };
      for (const auto& [stage, value] : stages->keys) all += seconds(value);
      std::vector<std::vector<std::string>> rows{{"stage", "seconds", "share"}};
      for (const auto& [stage, value] : stages->keys)
        rows.push_back({html_text(stage), number_text(seconds(value), 3),
                        fmt::format("<span class=\"bar\" style=\"width:{:.2f}rem\"></span> {:.0f} %",
                                    8 * seconds(value) / all, 100 * seconds(value) / all)});
      out += "<h3>Where the time went</h3>\n" + html_table(rows);
    }
    return out;
  }

  fs::path run_;
  SummaryFile summary_;
  Scene scene_;
  CsvColumns series_;
  Measured measured_;
  std::string trouble_;
};

}  // namespace

std::string run_report(const fs::path& run) { return RunReport(run).page(); }

}  // namespace hourglass
