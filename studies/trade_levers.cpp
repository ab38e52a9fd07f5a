#include "studies/trade_levers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/polygon.hpp"

namespace hourglass {
namespace {

struct Lever {
  const char* key;
  double (*own)(const Scene&);  ///< nullptr: the values are words
  std::vector<double> factors;  ///< of its own value
  std::vector<const char*> words{};
  bool (*applies)(const Scene&) = nullptr;  ///< nullptr: always
  bool model = false;
};

const std::vector<Lever>& levers() {
  static const std::vector<Lever> table{
      {"grid.cells_x", [](const Scene& s) { return double(s.cells_x); }, {0.25, 0.375, 0.5, 0.75, 1.5, 2}},
      {"time.cfl", [](const Scene& s) { return s.time.cfl; }, {0.25, 0.5}},
      {"time.dt_max", [](const Scene& s) { return s.time.dt_max; }, {0.25, 0.5, 2, 4, 8}},
      {"accuracy.viscous_tolerance",
       [](const Scene& s) { return s.accuracy.viscous_tolerance; },
       {1e-2, 0.1, 5, 20, 100}},
      {"accuracy.pressure_tolerance",
       [](const Scene& s) { return s.accuracy.pressure_tolerance; },
       {1e-3, 0.1, 3, 30, 300}},
      {"accuracy.fluidity_tolerance",
       [](const Scene& s) { return s.accuracy.fluidity_tolerance; },
       {0.1, 3, 10},
       {},
       [](const Scene& s) { return s.nonlocal.has_value(); }},
      {"accuracy.precision", nullptr, {}, {"full"}},
      {"accuracy.vof", nullptr, {}, {"upwind"}},
      {"accuracy.splitting.outer", nullptr, {}, {"2"}},
      {"accuracy.splitting.picard", nullptr, {}, {"2", "4"}},
      {"accuracy.splitting.rotational", nullptr, {}, {"0", "0.5"}},
      {"air.model", nullptr, {}, {"none", "passive"}},
      {"domain.symmetry", nullptr, {}, {"mirror"}},
      {"stop.steady_discharge",
       nullptr,
       {},
       {"1e-2", "1e-3"},
       [](const Scene& s) { return !s.orifices.empty(); }},
      {"output.series_every", [](const Scene& s) { return s.output.series_every; }, {0.2, 4}},
      {"accuracy", nullptr, {}, {"fast", "balanced", "accurate"}},
      {"accuracy.vof", nullptr, {}, {"upwind"}},
      {"accuracy.extra_sweeps", nullptr, {}, {"1", "2"}},
      {"accuracy.extrapolate", nullptr, {}, {"1", "2"}},
      {"accuracy.solids",
       nullptr,
       {},
       {"staircase"},
       [](const Scene& s) { return !s.inserts.empty() || s.hopper.has_value(); }},
      {"physics.rheology.corner_mean", nullptr, {}, {"arithmetic"}},
      {"physics.rheology.eta_max",
       [](const Scene& s) { return s.rheology.eta_max; },
       {1e-4, 1e-2, 0.1, 10},
       {},
       nullptr,
       true},
      {"physics.rheology.smoothing_length",
       [](const Scene& s) { return s.rheology.smoothing_length; },
       {0, 0.5, 2},
       {},
       nullptr,
       true},
  };
  return table;
}

bool near(double a, double b, double scale) { return std::abs(a - b) <= 1e-9 * scale; }

/// Whether for each corner of a fill there is its image.
bool own_image(const Fill& fill, double width) {
  return std::all_of(fill.points.begin(), fill.points.end(), [&](const auto& p) {
    return std::any_of(fill.points.begin(), fill.points.end(), [&](const auto& q) {
      return near(q[0], width - p[0], width) && near(q[1], p[1], width);
    });
  });
}

}  // namespace

std::string Variant::name() const {
  return sets.empty() ? "balanced" : fmt::format("{}", fmt::join(sets, " "));
}

std::vector<Variant> one_lever_variants(const Scene& balanced) {
  std::vector<Variant> variants;
  for (const Lever& lever : levers()) {
    if (lever.applies && !lever.applies(balanced)) continue;
    std::vector<std::string> values(lever.words.begin(), lever.words.end());
    for (const double factor : lever.factors) {
      const double value = factor * lever.own(balanced);
      if (lever.own(balanced) != 0) values.push_back(fmt::format("{:.6g}", value));
    }
    for (const std::string& value : values) {
      if (std::string_view(lever.key) ==
          "accuracy")  // the words as they are meant: with the grid that they choose
        variants.push_back({lever.key, {"accuracy=" + value, "grid.cells_x=auto"}, false, false});
      Variant v{lever.key, {fmt::format("{}={}", lever.key, value)}, false, lever.model};
      v.halved = v.lever == "domain.symmetry";
      if (!v.halved || halved(balanced)) variants.push_back(std::move(v));
    }
  }
  return variants;
}

std::optional<Scene> halved(const Scene& scene) {
  const double middle = scene.width / 2;
  const auto is_image = [&](double a, double b) { return near(a, scene.width - b, scene.width); };
  if (scene.left_is_middle() || scene.gravity[0] != 0 || scene.cells_x % 2 != 0 ||
      scene.wall(Side::left) != scene.wall(Side::right) || scene.wall(Side::left) == Wall::periodic)
    return std::nullopt;
  Scene half = scene;
  half.symmetry = Symmetry::mirror;
  half.walls[static_cast<int>(Side::left)] = Wall::free_slip;
  half.width = middle;
  half.cells_x /= 2;

  half.orifices.clear();
  for (const Orifice& o : scene.orifices) {
    const bool upright = o.wall == Side::left || o.wall == Side::right;
    const bool has_image =
        std::any_of(scene.orifices.begin(), scene.orifices.end(), [&](const Orifice& other) {
          if (!near(other.width, o.width, scene.width)) return false;
          if (upright)
            return other.wall != o.wall && (other.wall == Side::left || other.wall == Side::right) &&
                   near(other.centre, o.centre, scene.width);
          return other.wall == o.wall && is_image(other.centre, o.centre);
        });
    if (!has_image) return std::nullopt;
    if (upright ? o.wall == Side::right : o.centre >= middle - 1e-9 * scene.width) {
      half.orifices.push_back(o);
      if (!upright) half.orifices.back().centre = std::max(0.0, o.centre - middle);
    }
  }
  half.inserts.clear();
  for (const Insert& insert : scene.inserts) {
    if (insert.shape == Shape::polygon) return std::nullopt;  // the others are their own images
    const bool has_image = std::any_of(scene.inserts.begin(), scene.inserts.end(), [&](const Insert& other) {
      return other.shape == insert.shape && near(other.width, insert.width, scene.width) &&
             near(other.height, insert.height, scene.width) &&
             near(other.centre[1], insert.centre[1], scene.width) &&
             is_image(other.centre[0], insert.centre[0]);
    });
    if (!has_image) return std::nullopt;
    if (insert.centre[0] < middle - 1e-9 * scene.width) continue;
    half.inserts.push_back(insert);
    half.inserts.back().centre[0] = std::max(0.0, insert.centre[0] - middle);
  }
  for (Fill& fill : half.fill) {
    if (!own_image(fill, scene.width)) return std::nullopt;
    fill.points = half_of(fill.points, 0, middle, +1);
    for (auto& corner : fill.points) corner[0] -= middle;
  }
  const std::vector<Problem> problems = check(half);
  if (std::any_of(problems.begin(), problems.end(), [](const Problem& p) { return p.fatal; }))
    return std::nullopt;
  return half;
}

}  // namespace hourglass
