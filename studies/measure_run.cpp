#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>

#include "io/chart.hpp"
#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/frame.hpp"
#include "io/scene_yaml.hpp"
#include "solver/diagnostics.hpp"
#include "studies/measure.hpp"
#include "studies/measure_fields.hpp"
#include "studies/outflow.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

class RunMeasure {
 public:
  RunMeasure(const fs::path& run, const MeasureOptions& options) : columns_(csv_columns(run / "series.csv")) {
    const Loaded loaded = load_scene(run / "scene.yaml");
    if (!loaded.ok()) throw std::invalid_argument(loaded.diagnostics.front().text());
    scene_ = loaded.scene;
    if (fs::exists(run / "fields.h5"))
      fields_.emplace(run, scene_, options);
    else if (!options.lines.empty() || !options.probes.empty() || !options.speeds.empty())
      throw std::invalid_argument(
          fmt::format("{}: has no fields to measure along lines, at probes or by other thresholds. Run the "
                      "scene with output.fields_every above 0.",
                      run.string()));
  }

  Measured all() {
    if (scene_.model == Model::mu_I) {  // others have one row, and the discharge that they were given
      discharge_rate();
      for (std::size_t m = 1; m < scene_.materials.size(); ++m) tracer(scene_.materials[m].name);
      if (!shares_.empty()) step_plots();
    }
    if (fields_) fields();
    std::string table = "quantity,value,standard_error,from,to\n";
    for (const Measured::Figure& f : out_.figures)
      table += csv_row({f.quantity, fmt::format("{}", f.value),
                        f.standard_error ? fmt::format("{}", *f.standard_error) : "",
                        fmt::format("{}", f.from), fmt::format("{}", f.to)});
    out_.tables.emplace_back("measure.csv", table);
    return std::move(out_);
  }

 private:
  void add(const std::string& quantity, double value, const std::string& unit,
           std::optional<double> error = {}) {
    out_.figures.push_back({quantity, value, unit, error, window_.from, window_.to});
  }
  std::string title(const std::string& what, const std::string& unit) const {
    return fmt::format("{} [{}]", what, unit_text(unit, scene_.units));
  }

  void discharge_rate() {
    const std::vector<double>&t = columns_["t"], &mass = columns_["mass"], &outflow = columns_["outflow"];
    History kept;
    double fed = 0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      if (scene_.feed && k > 0) fed += columns_["fed"][k] * (t[k] - t[k - 1]);
      kept.push_back({t[k], mass[k] - fed});
    }
    window_ = discharge(scene_, kept);
    const RateEstimate rate = rate_with_error(kept, window_.from, window_.to);
    add("discharge_rate", rate.rate, unit_text("M/T", scene_.units), rate.standard_error);
    if (const double scale = discharge_scale(scene_, total_width(scene_)); scale > 0)
      add("discharge_constant", rate.rate / scale, "",
          rate.standard_error ? std::optional(*rate.standard_error / scale) : std::nullopt);
    Chart chart{.title = fmt::format("{}: discharge", scene_.name),
                .x = {.title = title("time", "T")},
                .y = {.title = title("discharge rate", "M/T")}};
    chart.series.push_back(
        {.name = "outflow", .x = {t.begin() + 1, t.end()}, .y = {outflow.begin() + 1, outflow.end()}});
    Series line{
        .name = "fit to the mass", .x = {rate.from, rate.to}, .y = {rate.rate, rate.rate}, .colour = 1};
    if (const double error = rate.standard_error.value_or(0); error > 0) {
      line.lower = {rate.rate - error, rate.rate - error};
      line.upper = {rate.rate + error, rate.rate + error};
    }
    chart.series.push_back(line);
    draw("discharge.png", chart);
  }

  void tracer(const std::string& name) {
    OutflowSeries series{columns_["t"], columns_["outflow"], columns_[name + "_outflow"],
                         columns_["mass"].front(), columns_[name + "_mass"].front()};
    const StepResponse response = step_response(series);
    add(name + "_mean_residence_time", response.mean, unit_text("T", scene_.units));
    add(name + "_residence_time_variance", response.variance, scene_.units == Units::grain ? "d/g" : "s²");
    add(name + "_mixing_index", response.mixing_index, "");
    shares_.emplace_back(name, response);
  }

  void step_plots() {
    Chart share{.title = fmt::format("{}: step change", scene_.name),
                .x = {.title = title("time", "T")},
                .y = {.title = "F, share of the outflow", .range = {{0, 1.02}}}};
    Chart drained = share, residence = share;
    drained.x.title = "share of the silo drained";
    residence.y = {.title = title("E = dF/dt", "1/T")};
    const std::vector<double> mass = columns_["mass"];
    std::vector<std::string> head{"t", "drained"};
    std::string residence_text = "material,t,E\n";
    for (std::size_t k = 0; k < shares_.size(); ++k) {
      const auto& [name, response] = shares_[k];
      const int colour = static_cast<int>(k);
      share.series.push_back({.name = name, .x = response.t, .y = response.F, .colour = colour});
      drained.series.push_back({.name = name, .x = response.drained, .y = response.F, .colour = colour});
      residence.series.push_back({.name = name, .x = response.E_t, .y = response.E, .colour = colour});
      head.push_back(name + "_F");
      for (std::size_t i = 0; i < response.E.size(); ++i)
        residence_text +=
            csv_row({name, fmt::format("{}", response.E_t[i]), fmt::format("{}", response.E[i])});
    }
    if (shares_.size() == 1) {  // of several, what is first in is not one step
      const double before = 1 - columns_[shares_[0].first + "_mass"].front() / mass.front();
      drained.series.push_back({.name = "first in, first out",
                                .x = {0, before, before, 1},
                                .y = {0, 0, 1, 1},
                                .dashed = true,
                                .colour = 6});
    }
    const StepResponse& first = shares_[0].second;
    std::string text = csv_row(head);
    for (std::size_t i = 0; i < first.t.size(); ++i) {
      std::vector<std::string> cells{fmt::format("{}", first.t[i]), fmt::format("{}", first.drained[i])};
      for (const auto& [name, response] : shares_) cells.push_back(fmt::format("{}", response.F[i]));
      text += csv_row(cells);
    }
    out_.tables.emplace_back("step_change.csv", text);
    out_.tables.emplace_back("residence_time.csv", residence_text);
    draw("step_change.png", share);
    draw("step_change_drained.png", drained);
    draw("residence_time.png", residence);
  }

  void fields() {
    fields_->quasi_static(window_.from, window_.to, out_);
    fields_->profiles(window_.from, window_.to, out_);
    fields_->probes(out_);
  }

  void draw(const std::string& name, const Chart& chart) { out_.charts.emplace_back(name, chart); }

  CsvColumns columns_;
  Scene scene_;
  std::optional<FieldMeasure> fields_;
  DischargeWindow window_;
  Measured out_;
  std::vector<std::pair<std::string, StepResponse>> shares_;  ///< by material beyond the first
};

}  // namespace

Measured measured_run(const fs::path& run, const MeasureOptions& options) {
  return RunMeasure(run, options).all();
}

void Measured::write(const fs::path& folder) const {
  fs::create_directories(folder / "plots");
  std::vector<fs::path> old;  // of an earlier call, which had other lines and fields
  for (const std::string kind : {"profile_", "probes_"})
    if (std::ranges::any_of(charts, [&](const auto& chart) { return chart.first.starts_with(kind); }))
      for (const auto& entry : fs::directory_iterator(folder / "plots"))
        if (entry.path().filename().string().starts_with(kind)) old.push_back(entry.path());
  for (const fs::path& path : old) fs::remove(path);
  for (const auto& [name, text] : tables) write_atomically(folder / name, text);
  for (const Figure& f : figures)
    fmt::print("{}: {:.6g}{}{}{}\n", f.quantity, f.value,
               f.standard_error ? fmt::format(" ± {:.2g}", *f.standard_error) : "", f.unit.empty() ? "" : " ",
               f.unit);
  for (const std::string& note : notes) fmt::print("{}\n", note);
  for (const auto& [name, text] : tables) fmt::print("{}\n", (folder / name).string());
  std::fflush(stdout);
  for (const auto& [name, chart] : charts) draw_chart(chart, folder / "plots" / name);
}

void measure_run(const fs::path& run, const MeasureOptions& options) {
  measured_run(run, options).write(run);
}

void measure(const fs::path& folder, const MeasureOptions& options) {
  if (fs::exists(folder / "results.csv")) {
    if (!options.lines.empty() || !options.probes.empty() || !options.speeds.empty())
      throw std::invalid_argument(
          fmt::format("{}: lines, probes and thresholds are measured in a run, not in a study. Give one of "
                      "the folders in {}.",
                      folder.string(), (folder / "runs").string()));
    return measure_study(folder);
  }
  if (fs::exists(folder / "series.csv")) return measure_run(folder, options);
  throw std::invalid_argument(
      fmt::format("{}: holds neither a run (series.csv) nor a sweep (results.csv). Give the folder of one.",
                  folder.string()));
}

}  // namespace hourglass
