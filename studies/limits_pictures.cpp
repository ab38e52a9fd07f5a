#include "studies/limits_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/chart.hpp"
#include "studies/limits.hpp"

namespace hourglass {
namespace {

constexpr double shown_growth = 0.1;  // either way from 0

Series thesis_points() {
  Series points{.name = "friction sets of the thesis", .line = false, .mark = Mark::disc, .colour = 6};
  for (const FrictionSet& set : thesis_sets) {
    points.x.push_back(set.mu_s);
    points.y.push_back(set.delta_mu);
    points.labels.push_back(set.name);
  }
  return points;
}

Series analytic_curve(double I_0, double I) {
  Series curve{.name = "C(I) = 0, Barker et al. 2015", .dashed = true, .colour = 6};
  for (int k = 1; k <= 100; ++k)
    if (const auto mu_s = analytic_border(0.01 * k, I_0, I); mu_s && *mu_s <= 1.1) {
      curve.x.push_back(*mu_s);
      curve.y.push_back(0.01 * k);
    }
  return curve;
}

HeatMap heat_map(const GrowthMap& map) {
  HeatMap out;
  out.value = {.title = "growth of the wave per step, ln", .range = {{-shown_growth, shown_growth}}};
  out.colours = ColourMap::signs;
  out.at_x = map.at_x;
  out.at_y = map.at_y;
  for (const double g : map.growth) out.values.push_back(std::clamp(g, -shown_growth, shown_growth));
  out.contours = {0};
  out.contour_name = "measured: growth 0";
  return out;
}

}  // namespace

std::vector<std::array<double, 2>> GrowthMap::border() const {
  std::vector<std::array<double, 2>> points;
  for (std::size_t j = 0; j < at_y.size(); ++j) {
    const auto row = growth.begin() + static_cast<long>(j * at_x.size());
    if (const auto x = first_crossing(at_x, {row, row + static_cast<long>(at_x.size())}))
      points.push_back({*x, at_y[j]});
  }
  return points;
}

void draw_friction_map(const GrowthMap& map, double I_0, double I, const std::filesystem::path& path) {
  HeatMap out = heat_map(map);
  out.title = fmt::format("Short waves in a shear flow at I = {}, I_0 = {}", I, I_0);
  out.x.title = "static friction mu_s";
  out.y.title = "delta_mu";
  out.over = {analytic_curve(I_0, I), thesis_points()};
  draw_heat_map(out, path);
}

void draw_cap_map(const GrowthMap& map, const Scene& scene, double I, const std::filesystem::path& path) {
  const double unit = scales(scene).viscosity;
  const Material& m = scene.materials.at(0);
  HeatMap out = heat_map(map);
  for (double& y : out.at_y) y /= unit;
  out.title = fmt::format("Short waves at I = {}: mu_s = {}, delta_mu = {}", I, m.mu_s, m.delta_mu);
  out.x = {.title = "I_0", .log = true};
  out.y = {.title = "eta_max [ρ √(g d³)]", .log = true};
  Series cap{.name = "eta_max = mu P/|shear rate|", .dashed = true, .colour = 6};
  ShearProbe probe = bare_probe(scene, I);
  for (int k = 0; k <= 80; ++k) {
    probe.scene.materials[0].I_0 = 1e-3 * std::pow(10, 0.05 * k);
    cap.x.push_back(probe.scene.materials[0].I_0);
    cap.y.push_back(probe.viscosity() / unit);
  }
  out.over = {cap};
  Series limit{.name = "C(I) = 0, Barker et al. 2015", .colour = 6};
  Grain grain = grain_of(m);
  bool ill = false;
  for (int k = 0; k <= 4000; ++k) {
    grain.I_0 = 1e-3 * std::pow(10, 0.001 * k);
    const bool now = well_posedness(I, grain) > 0;
    if (k > 0 && now != ill) {
      out.over.push_back(limit);
      out.over.back().x = {grain.I_0, grain.I_0};
      out.over.back().y = {out.at_y.front(), out.at_y.back()};
      limit.name.clear();
    }
    ill = now;
  }
  draw_heat_map(out, path);
}

void draw_borders(const std::vector<BorderCurve>& borders, double I_0, double I,
                  const std::filesystem::path& path) {
  Chart chart;
  chart.title = fmt::format("Where short waves neither grow nor decay, I = {}, I_0 = {}", I, I_0);
  chart.x = {.title = "static friction mu_s", .range = {{0, 1.1}}};
  chart.y = {.title = "delta_mu", .range = {{0, 1}}};
  chart.series.push_back(analytic_curve(I_0, I));
  constexpr std::array marks{Mark::disc, Mark::square, Mark::diamond, Mark::triangle, Mark::ring};
  int k = 0;
  for (const BorderCurve& border : borders) {
    Series curve{.name = border.name, .mark = marks[k % marks.size()], .colour = k % 6};
    if (border.points.empty()) curve.name += " (no border here)";
    for (const auto& [x, y] : border.points) {
      curve.x.push_back(x);
      curve.y.push_back(y);
    }
    chart.series.push_back(curve);
    ++k;
  }
  chart.series.push_back(thesis_points());
  draw_chart(chart, path);
}

}  // namespace hourglass
