#include "io/fit_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/scene_yaml.hpp"
#include "io/xdmf.hpp"
#include "solver/diagnostics.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {
namespace {

constexpr int heights = 10;

int frame_for(const std::vector<double>& times, std::optional<double> time, const Scene& scene) {
  if (times.empty()) throw std::runtime_error("the run has no frames");
  if (!time) {
    const auto developed = std::ranges::lower_bound(times, start_up_time(scene));
    return static_cast<int>((developed == times.end() ? developed - 1 : developed) - times.begin());
  }
  if (*time < times.front() || *time > times.back())
    throw std::invalid_argument(fmt::format("time {} is outside the run, whose frames go from {} to {}",
                                            *time, times.front(), times.back()));
  const auto nearer = [&](double a, double b) { return std::abs(a - *time) < std::abs(b - *time); };
  return static_cast<int>(std::ranges::min_element(times, nearer) - times.begin());
}

/// The scene of a run, as one of the kinematic model.
Scene scene_of(const std::filesystem::path& run) {
  const Loaded loaded = load_scene(run / "scene.yaml");
  if (!loaded.ok()) throw std::runtime_error(loaded.diagnostics.front().text());
  Scene scene = loaded.scene;
  scene.model = Model::kinematic;
  for (const Problem& problem : check(scene))
    if (problem.fatal)
      throw std::invalid_argument(fmt::format("{}: {}: {}", run.string(), problem.path, problem.message));
  return scene;
}

/// Share of the samples faster than half the largest of them.
double flatness(const std::vector<double>& v) {
  const double half = 0.5 * *std::ranges::min_element(v);
  const auto fast = std::ranges::count_if(v, [&](double x) { return x <= half; });
  return static_cast<double>(fast) / static_cast<double>(v.size());
}

}  // namespace

RunFit fit_run(const std::filesystem::path& run, std::optional<double> time) {
  const Scene scene = scene_of(run);
  const FieldReader reader(run);
  const int number = frame_for(reader.times(), time, scene);
  const Frame frame = reader.read(number, {"grains"});
  const CellField& grains = frame.field("grains");
  const Patch& patch = grains.patch();

  std::vector<VelocitySample> all;
  std::vector<std::vector<VelocitySample>> rows;
  for (int j = 0; j < patch.ny; ++j) {
    std::vector<VelocitySample> row;
    for (int i = 0; i < patch.nx; ++i)
      if (grains(i, j) > 0.999) row.push_back({patch.x_centre(i), patch.y_centre(j), frame.velocity_y(i, j)});
    all.insert(all.end(), row.begin(), row.end());
    if (row.size() > static_cast<std::size_t>(patch.nx) / 2) rows.push_back(std::move(row));
  }
  const Floor floor = floor_of(scene, 1, OrificeForm::slot);  // of discharge 1
  const KinematicFit fit = fit_kinematic(floor, all);
  RunFit out{frame.t, fit.B, fit.factor, fit.misfit, {}};
  Floor scaled = floor;
  for (FloorSource& source : scaled.sources) source.rate *= fit.factor;
  const KinematicFlow model(scaled, fit.B);
  const int wanted = std::min(heights, static_cast<int>(rows.size()));
  for (int k = 0; k < wanted; ++k) {
    RunFit::Height h;
    h.samples = std::move(rows[(2 * k + 1) * rows.size() / (2 * wanted)]);
    h.y = h.samples.front().y;
    std::vector<double> v;
    for (const VelocitySample& s : h.samples) {
      v.push_back(s.v);
      h.fit.push_back(model.at(s.x, s.y).v);
    }
    h.B = fit_kinematic(floor, h.samples).B;
    h.fastest = -*std::ranges::min_element(v);
    h.fastest_fit = -*std::ranges::min_element(h.fit);
    h.flatness = flatness(v);
    h.flatness_fit = flatness(h.fit);
    out.heights.push_back(std::move(h));
  }
  return out;
}

std::string text_of(const RunFit& fit) {
  std::string text = fmt::format(
      "Kinematic model fitted to v at t = {:.6g}: B = {:.6g}, Q = {:.6g}, misfit {:.3g} of the root mean "
      "square of v\n"
      "The same as a scene: --set model=kinematic --set kinematic.B={:.6g} --set kinematic.Q={:.6g}\n\n"
      "{:>10} {:>12} {:>12} {:>12} {:>14} {:>14}\n",
      fit.t, fit.B, fit.Q, fit.misfit, fit.B, fit.Q, "height", "B of it", "fastest", "of the fit",
      "over half", "of the fit");
  for (const RunFit::Height& h : fit.heights)
    text += fmt::format("{:>10.4g} {:>12.4g} {:>12.4g} {:>12.4g} {:>14.3f} {:>14.3f}\n", h.y, h.B, h.fastest,
                        h.fastest_fit, h.flatness, h.flatness_fit);
  return text +
         "\nover half: share of the width where v is more than half of the fastest; larger is flatter.\n";
}

std::string csv_of(const RunFit& fit) {
  std::string text = "x,y,v,v_fit\n";
  for (const RunFit::Height& h : fit.heights)
    for (std::size_t k = 0; k < h.samples.size(); ++k)
      text += fmt::format("{},{},{},{}\n", h.samples[k].x, h.samples[k].y, h.samples[k].v, h.fit[k]);
  return text;
}

}  // namespace hourglass
