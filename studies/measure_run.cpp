#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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
  RunMeasure(const fs::path& run, const MeasureOptions& options)
      : run_(run), columns_(csv_numbers(run / "series.csv")) {
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
    fs::create_directories(run / "plots");
  }

  void all() {
    if (scene_.model == Model::mu_I) {  // others have one row, and the discharge that they were given
      discharge_rate();
      for (std::size_t m = 1; m < scene_.materials.size(); ++m) tracer(scene_.materials[m].name);
      if (!shares_.empty()) step_plots();
    }
    if (fields_) fields();
    write_atomically(run_ / "measure.csv", table_);
    fmt::print("{}\n", (run_ / "measure.csv").string());
  }

 private:
  void add(const std::string& quantity, double value, const std::string& unit,
           std::optional<double> error = {}) {
    table_ += csv_row({quantity, fmt::format("{}", value), error ? fmt::format("{}", *error) : "",
                       fmt::format("{}", window_.from), fmt::format("{}", window_.to)});
    fmt::print("{}: {:.6g}{}{}{}\n", quantity, value, error ? fmt::format(" ± {:.2g}", *error) : "",
               unit.empty() ? "" : " ", unit);
  }
  void add(const FrameMean& mean) {
    table_ += csv_row({mean.quantity, fmt::format("{}", mean.value), "", fmt::format("{}", mean.from),
                       fmt::format("{}", mean.to)});
    fmt::print("{}: {:.4g}\n", mean.quantity, mean.value);
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
    write_atomically(run_ / "step_change.csv", text);
    write_atomically(run_ / "residence_time.csv", residence_text);
    draw("step_change.png", share);
    draw("step_change_drained.png", drained);
    draw("residence_time.png", residence);
  }

  void fields() {
    for (const FrameMean& mean : fields_->quasi_static(window_.from, window_.to)) add(mean);
    fields_->profiles(window_.from, window_.to);
    fields_->probes();
  }

  void draw(const std::string& name, const Chart& chart) const { draw_chart(chart, run_ / "plots" / name); }

  fs::path run_;
  std::map<std::string, std::vector<double>> columns_;
  Scene scene_;
  std::optional<FieldMeasure> fields_;
  DischargeWindow window_;
  std::string table_ = "quantity,value,standard_error,from,to\n";
  std::vector<std::pair<std::string, StepResponse>> shares_;  ///< by material beyond the first
};

}  // namespace

void measure_run(const fs::path& run, const MeasureOptions& options) { RunMeasure(run, options).all(); }

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
