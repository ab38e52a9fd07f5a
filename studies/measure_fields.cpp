#include "studies/measure_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/csv.hpp"
#include "solver/boundary_of.hpp"
#include "solver/geometry.hpp"

namespace hourglass {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// The numbers of "1,2.5,-3"; none if it is anything else.
std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  const char *at = text.data(), *end = at + text.size();
  for (;;) {
    double x = 0;
    const auto [stop, error] = std::from_chars(at, end, x);
    if (error != std::errc() || !std::isfinite(x)) return {};
    numbers.push_back(x);
    if (stop == end) return numbers;
    if (*stop != ',') return {};
    at = stop + 1;
  }
}

std::string cell(double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; }

}  // namespace

std::string quasi_static_name(double threshold) {
  const double decade = std::round(std::log10(threshold));
  if (decade < 0 && std::abs(threshold / std::pow(10, decade) - 1) < 1e-12)
    return fmt::format("quasi_static_1e{}", static_cast<int>(decade));
  return fmt::format("quasi_static_{}", threshold);
}

FieldMeasure::FieldMeasure(const std::filesystem::path& run, const Scene& scene,
                           const MeasureOptions& options)
    : scene_(scene), reader_(run), geometry_(geometry_of(scene, boundary_of(scene))),
      thresholds_(options.speeds), fields_(options.fields), probe_texts_(options.probes) {
  if (reader_.times().empty())
    throw std::runtime_error(fmt::format("{}: holds no frames yet", (run / "fields.h5").string()));
  if (thresholds_.empty()) thresholds_.assign(quasi_static_thresholds.begin(), quasi_static_thresholds.end());
  const std::vector<std::string> stored = reader_.names(0);
  const auto is_there = [&](const std::string& name) {
    return name == "velocity_x" || name == "velocity_y" || std::ranges::count(stored, name) > 0;
  };
  if (fields_.empty()) {
    for (const FieldInfo& known : known_fields())
      if (is_there(known.name)) fields_.push_back(known.name);
  }
  for (const std::string& name : fields_)
    if (!is_there(name))
      throw std::invalid_argument(fmt::format("--field {}: not stored; stored are velocity_x, velocity_y, {}",
                                              field_info(name).name, fmt::join(stored, ", ")));
  for (const std::string& text : options.lines) lines_.push_back(line_of(text));
  for (const std::string& text : options.probes) probes_.push_back(probe_of(text));
  if (!options.times.empty()) frames_ = frames_at(reader_.times(), options.times);
}

FieldMeasure::Line FieldMeasure::line_of(const std::string& text) const {
  const Patch p = scene_.patch();
  std::vector<double> ends;
  if (const bool upright = text.starts_with("x="); upright || text.starts_with("y=")) {
    if (const auto at = numbers_in(std::string_view(text).substr(2)); at.size() == 1)
      ends =
          upright ? std::vector{at[0], 0.0, at[0], p.ny * p.h} : std::vector{0.0, at[0], scene_.width, at[0]};
  } else {
    ends = numbers_in(text);
  }
  const double length = ends.size() == 4 ? std::hypot(ends[2] - ends[0], ends[3] - ends[1]) : 0;
  if (!(length > 0))
    throw std::invalid_argument(fmt::format(
        "--line {}: must be two places x0,y0,x1,y1, or x=X or y=Y for a line across the domain", text));
  Line line{text, {}, {}};
  try {
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / p.h - 1e-9)));
    for (int k = 0; k <= pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      line.points.emplace_back(scene_, geometry_.get(), (1 - share) * ends[0] + share * ends[2],
                               (1 - share) * ends[1] + share * ends[3]);
      line.s.push_back(share * length);
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("--line {}: {}", text, error.what()));
  }
  return line;
}

FieldPoint FieldMeasure::probe_of(const std::string& text) const {
  const std::vector<double> place = numbers_in(text);
  if (place.size() != 2) throw std::invalid_argument(fmt::format("--probe {}: must be a place x,y", text));
  try {
    return {scene_, geometry_.get(), place[0], place[1]};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("--probe {}: {}", text, error.what()));
  }
}

std::vector<int> FieldMeasure::frames_in(double from, double to) const {
  std::vector<int> frames;
  for (int k = 0; k < static_cast<int>(reader_.times().size()); ++k)
    if (reader_.times()[k] >= from && reader_.times()[k] <= to) frames.push_back(k);
  if (frames.empty()) frames.push_back(static_cast<int>(reader_.times().size()) - 1);
  return frames;
}

Frame FieldMeasure::read(int frame) const {
  std::vector<std::string> names{"grains"};
  for (const std::string& name : fields_)
    if (name != "grains" && name != "velocity_x" && name != "velocity_y") names.push_back(name);
  return reader_.read(frame, names);
}

std::vector<double> FieldMeasure::values_at(const FieldPoint& point, const Frame& frame) const {
  std::vector<double> values;
  for (const std::string& name : fields_)
    values.push_back(point.value(name,
                                 name == "velocity_x"   ? frame.velocity_x
                                 : name == "velocity_y" ? frame.velocity_y
                                                        : frame.field(name),
                                 frame.field("grains")));
  return values;
}

void FieldMeasure::quasi_static(double from, double to, Measured& out) const {
  const std::vector<FlatTop> tops = flat_tops(scene_);
  std::vector<double> speeds;
  std::vector<std::string> names;
  for (const double threshold : thresholds_) {
    speeds.push_back(threshold * grain_speed(scene_));
    names.push_back(quasi_static_name(threshold));
  }
  for (std::size_t k = 0; !tops.empty() && k < thresholds_.size(); ++k)
    names.push_back(names[k] + "_above_flat_top");
  std::vector<std::vector<double>> shares(names.size());
  std::string text = "t," + csv_row(names);
  for (int k = 0; k < static_cast<int>(reader_.times().size()); ++k) {
    const Frame frame = reader_.read(k, {"grains"});
    CellField speed(frame.velocity_x.patch());
    for (int j = 0; j < speed.ny(); ++j)
      for (int i = 0; i < speed.nx(); ++i)
        speed(i, j) = std::hypot(frame.velocity_x(i, j), frame.velocity_y(i, j));
    const SlowShares slow = slow_shares(frame.field("grains"), speed, geometry_.get(), tops, speeds, 1);
    std::vector<double> row = slow.all;
    row.insert(row.end(), slow.above_flat_tops.begin(), slow.above_flat_tops.end());
    text += fmt::format("{},{}\n", frame.t, fmt::join(row, ","));
    for (std::size_t n = 0; n < row.size(); ++n) shares[n].push_back(row[n]);
  }
  out.tables.emplace_back("quasi_static.csv", text);

  const std::vector<int> frames = frames_in(from, to);
  for (std::size_t n = 0; n < names.size(); ++n) {
    double sum = 0;
    for (const int k : frames) sum += shares[n][k];
    out.figures.push_back({names[n],
                           sum / static_cast<double>(frames.size()),
                           "",
                           {},
                           reader_.times()[frames.front()],
                           reader_.times()[frames.back()]});
  }
  if (reader_.times().size() < 3) return;
  Chart chart{.title = fmt::format("{}: grains that hardly move", scene_.name),
              .x = {.title = fmt::format("time [{}]", unit_text("T", scene_.units))},
              .y = {.title = "share of the grains"}};
  for (std::size_t n = 0; n < names.size(); ++n) {
    const std::size_t k = n % thresholds_.size();
    const bool above = n >= thresholds_.size();
    chart.series.push_back({.name = fmt::format("{}slower than {} √(g d)", above ? "above a flat top, " : "",
                                                number_text(thresholds_[k])),
                            .x = {reader_.times().begin() + 1, reader_.times().end()},  // at first all rest
                            .y = {shares[n].begin() + 1, shares[n].end()},
                            .dashed = above,
                            .colour = static_cast<int>(k)});
  }
  out.charts.emplace_back("quasi_static.png", chart);
}

FieldMeasure::Values FieldMeasure::along(const Line& line, const std::vector<int>& frames) const {
  Values sums(fields_.size(), std::vector<double>(line.points.size())), counts = sums;
  for (const int k : frames) {
    const Frame frame = read(k);
    for (std::size_t m = 0; m < line.points.size(); ++m) {
      const std::vector<double> values = values_at(line.points[m], frame);
      for (std::size_t f = 0; f < values.size(); ++f)
        if (std::isfinite(values[f])) sums[f][m] += values[f], counts[f][m] += 1;
    }
  }
  for (std::size_t f = 0; f < sums.size(); ++f)
    for (std::size_t m = 0; m < sums[f].size(); ++m)
      sums[f][m] = counts[f][m] > 0 ? sums[f][m] / counts[f][m] : unknown;
  return sums;
}

void FieldMeasure::profiles(double from, double to, Measured& out) const {
  if (lines_.empty()) return;
  struct Curve {
    std::vector<int> frames;
    std::string time, name;  ///< in the table, in the legend
  };
  const auto time_text = [&](int k) {
    return fmt::format("{} {}", number_text(reader_.times()[k], 4), unit_text("T", scene_.units));
  };
  std::vector<Curve> curves;
  for (const int k : frames_)
    curves.push_back({{k}, fmt::format("{}", reader_.times()[k]), "t = " + time_text(k)});
  if (curves.empty()) {
    const std::vector<int> all = frames_in(from, to);
    const int first = all.front(), last = all.back();
    curves.push_back(
        {all, "mean",
         fmt::format("mean, t = {} to {}", number_text(reader_.times()[first], 4), time_text(last))});
  }
  std::vector<std::string> head{"line", "t", "s", "x", "y"};
  head.insert(head.end(), fields_.begin(), fields_.end());
  std::string text = csv_row(head);
  for (std::size_t l = 0; l < lines_.size(); ++l) {
    const Line& line = lines_[l];
    const bool upright = line.points.front().x() == line.points.back().x(),
               level = line.points.front().y() == line.points.back().y();
    std::vector<double> place = line.s;
    for (std::size_t m = 0; m < place.size() && (upright || level); ++m)
      place[m] = upright ? line.points[m].y() : line.points[m].x();
    const std::string across = upright ? "y" : !level ? "distance" : scene_.axisymmetric() ? "r" : "x";
    std::vector<Chart> charts;
    for (const std::string& field : fields_)
      charts.push_back({.title = fmt::format("{}: line {}", scene_.name, line.text),
                        .x = {.title = fmt::format("{} [{}]", across, unit_text("L", scene_.units))},
                        .y = {.title = axis_title(field), .log = field_info(field).logarithmic}});
    for (std::size_t c = 0; c < curves.size(); ++c) {
      const Values values = along(line, curves[c].frames);
      for (std::size_t m = 0; m < line.points.size(); ++m) {
        std::vector<std::string> cells{fmt::format("{}", l + 1), curves[c].time, fmt::format("{}", line.s[m]),
                                       fmt::format("{}", line.points[m].x()),
                                       fmt::format("{}", line.points[m].y())};
        for (const auto& of_field : values) cells.push_back(cell(of_field[m]));
        text += csv_row(cells);
      }
      for (std::size_t f = 0; f < fields_.size(); ++f)
        charts[f].series.push_back(
            {.name = curves[c].name, .x = place, .y = values[f], .colour = static_cast<int>(c)});
    }
    for (std::size_t f = 0; f < fields_.size(); ++f)
      out.charts.emplace_back(fmt::format("profile_{}_{}.png", l + 1, fields_[f]), charts[f]);
  }
  out.tables.emplace_back("profiles.csv", text);
}

void FieldMeasure::probes(Measured& out) const {
  if (probes_.empty()) return;
  const std::size_t frames = reader_.times().size();
  std::vector<Values> values(probes_.size(), Values(fields_.size()));
  for (std::size_t k = 0; k < frames; ++k) {
    const Frame frame = read(static_cast<int>(k));
    for (std::size_t n = 0; n < probes_.size(); ++n) {
      const std::vector<double> now = values_at(probes_[n], frame);
      for (std::size_t f = 0; f < now.size(); ++f) values[n][f].push_back(now[f]);
    }
  }
  std::vector<std::string> head{"probe", "x", "y", "t"};
  head.insert(head.end(), fields_.begin(), fields_.end());
  std::string text = csv_row(head);
  for (std::size_t n = 0; n < probes_.size(); ++n)
    for (std::size_t k = 0; k < frames; ++k) {
      std::vector<std::string> cells{fmt::format("{}", n + 1), fmt::format("{}", probes_[n].x()),
                                     fmt::format("{}", probes_[n].y()),
                                     fmt::format("{}", reader_.times()[k])};
      for (const auto& of_field : values[n]) cells.push_back(cell(of_field[k]));
      text += csv_row(cells);
    }
  for (std::size_t f = 0; frames > 1 && f < fields_.size(); ++f) {
    Chart chart{.title = fmt::format("{}: probes", scene_.name),
                .x = {.title = fmt::format("time [{}]", unit_text("T", scene_.units))},
                .y = {.title = axis_title(fields_[f]), .log = field_info(fields_[f]).logarithmic}};
    for (std::size_t n = 0; n < probes_.size(); ++n)
      chart.series.push_back({.name = fmt::format("({})", probe_texts_[n]),
                              .x = reader_.times(),
                              .y = values[n][f],
                              .colour = static_cast<int>(n)});
    out.charts.emplace_back(fmt::format("probes_{}.png", fields_[f]), chart);
  }
  out.tables.emplace_back("probes.csv", text);
}

std::string FieldMeasure::axis_title(const std::string& field) const {
  const FieldInfo& info = field_info(field);
  const std::string unit = unit_text(info.dimension, scene_.units);
  return unit.empty() ? info.label : fmt::format("{} [{}]", info.label, unit);
}

}  // namespace hourglass
