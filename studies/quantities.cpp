#include "studies/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "io/fit_run.hpp"
#include "solver/steady_flow.hpp"
#include "studies/formula.hpp"
#include "studies/outflow.hpp"

namespace hourglass {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN(), full = 0.999;
using Range = std::array<double, 2>;
constexpr Range everywhere{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

struct Place {
  const YamlNode& node;
  const std::string& below;
  StrictReader& strict;

  void keys(std::vector<std::string> allowed) const {
    allowed.insert(allowed.begin(), "kind");
    strict.known_keys(node, below, allowed);
  }
  double number(const std::string& key, std::optional<double> other = {}) const {
    return strict.number(node, below, key, other);
  }
  std::optional<double> perhaps(const std::string& key) const {
    return node.find(key) ? std::optional(number(key)) : std::nullopt;
  }
  std::string word(const std::string& key, const std::vector<std::string>& words,
                   const std::optional<std::string>& other = {}) const {
    return strict.word(node, below, key, words, other);
  }
  /// Formula of the columns of series.csv.
  std::string formula(const std::string& key) const {
    std::string found = strict.text(node, below, key);
    try {
      if (!found.empty()) names_in(found);
    } catch (const FormulaError& error) {
      strict.say(node.line, below + key, error.what());
    }
    return found;
  }
  Range range(const std::string& key) const { return strict.interval(node, below, key).value_or(everywhere); }
};

bool within(double x, const Range& range) { return x >= range[0] && x <= range[1]; }

// ---- fields -------------------------------------------------------------------------------------------------

/// Values of a field, and its volumes of grains, in the cells of a box that are full of grains.
std::vector<double> cells_in(const Frame& frame, const std::string& field, const Range& x, const Range& y) {
  const CellField &grains = frame.field("grains"), &values = frame.field(field);
  const Patch& patch = values.patch();
  std::vector<double> found;
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      if (grains(i, j) > full && within(patch.x_centre(i), x) && within(patch.y_centre(j), y))
        found.push_back(values(i, j));
  return found;
}

Quantity probe(const Place& at) {
  at.keys({"field", "x", "y", "time", "take", "limit"});
  std::vector<std::string> names;
  for (const FieldInfo& info : known_fields()) names.push_back(info.name);
  const std::string field = at.word("field", names),
                    how = at.word("take", {"mean", "median", "min", "max", "share_below", "part_below"},
                                  "mean");
  const Range x = at.range("x"), y = at.range("y");
  const auto time = at.perhaps("time");
  const double limit = how.ends_with("_below") ? at.number("limit") : 0;
  return [=](const RunData& run) {
    const Frame frame = run.frame(time, {"grains", field});
    std::vector<double> v = cells_in(frame, field, x, y);
    if (v.empty()) return unknown;
    if (how == "share_below" || how == "part_below") {
      const auto slow = static_cast<double>(std::ranges::count_if(v, [&](double a) { return a < limit; }));
      return slow / static_cast<double>(how == "share_below"
                                            ? v.size()
                                            : cells_in(frame, field, everywhere, everywhere).size());
    }
    const auto n = static_cast<double>(v.size());
    if (how == "min") return *std::ranges::min_element(v);
    if (how == "max") return *std::ranges::max_element(v);
    if (how == "median") {
      const auto middle = v.begin() + std::ssize(v) / 2;
      std::ranges::nth_element(v, middle);
      return *middle;
    }
    double sum = 0;
    for (const double a : v) sum += a;
    return sum / n;
  };
}

/// Greatest deviation of the flux down through any row of cells between two heights from Q.
Quantity flux_error(const Place& at) {
  at.keys({"y"});
  const Range y = at.range("y");
  return [=](const RunData& run) {
    const Frame frame = run.frame({}, {"grains"});
    const Patch& patch = frame.velocity_y.patch();
    const double Q = steady_flow(run.scene()).summary.discharge_rate;
    double worst = 0;
    for (int j = 0; j < patch.ny; ++j) {
      if (!within(patch.y_centre(j), y)) continue;
      double flux = 0;
      for (int i = 0; i < patch.nx; ++i)
        flux -= frame.velocity_y(i, j) * patch.h * run.scene().materials[0].density;
      worst = std::max(worst, std::abs(flux / Q - 1));
    }
    return worst;
  };
}

/// Of a stochastic flow: greatest difference of the speeds down at one height from those of the kinematic model with
/// B = L_s/2, over the greatest of these.
Quantity kinematic_distance(const Place& at) {
  at.keys({"y"});
  const double y = at.number("y");
  return [=](const RunData& run) {
    if (run.scene().model != Model::stochastic) return unknown;
    Scene own = run.scene(), other = own;
    resolve_model(own);
    other.model = Model::kinematic;
    other.kinematic = Kinematic{*own.stochastic->L_s / 2, own.stochastic->Q, own.stochastic->orifices};
    other.stochastic.reset();
    const SteadyModel stochastic(own), kinematic(other);
    const Patch patch = own.patch();
    double worst = 0, fastest = 0;
    for (int i = 0; i < patch.nx; ++i) {
      const double v = kinematic.velocity(patch.x_centre(i), y).v;
      worst = std::max(worst, std::abs(stochastic.velocity(patch.x_centre(i), y).v - v));
      fastest = std::max(fastest, std::abs(v));
    }
    return worst / fastest;
  };
}

/// The kinematic model that comes nearest, and at one height how flat both are.
Quantity kinematic_fit(const Place& at) {
  at.keys({"take", "time", "height"});
  const std::string how = at.word("take", {"B", "Q", "misfit", "flatness", "flatness_of_fit", "B_of_height"});
  const auto time = at.perhaps("time");
  const bool of_height = how == "flatness" || how == "flatness_of_fit" || how == "B_of_height";
  const double height = of_height ? at.number("height") : 0;
  return [=](const RunData& run) {
    const RunFit fit = fit_run(run.folder(), time);
    if (how == "B") return fit.B;
    if (how == "Q") return fit.Q;
    if (how == "misfit") return fit.misfit;
    const auto nearest = std::ranges::min_element(
        fit.heights, {}, [&](const RunFit::Height& h) { return std::abs(h.y - height); });
    return how == "flatness" ? nearest->flatness : how == "B_of_height" ? nearest->B : nearest->flatness_fit;
  };
}

// ---- the series ---------------------------------------------------------------------------------------------

Quantity series_value(const Place& at) {
  at.keys({"of", "t", "take"});
  const std::string formula = at.formula("of"), how = at.word("take", {"mean", "min", "max", "last"}, "mean");
  const Range t = at.range("t");
  return [=](const RunData& run) {
    const std::vector<double> values = run.along_series(formula), &times = run.series().at("t");
    double sum = 0, n = 0, least = HUGE_VAL, most = -HUGE_VAL, last = unknown;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!within(times[k], t) || !std::isfinite(values[k])) continue;
      sum += values[k];
      ++n;
      least = std::min(least, values[k]);
      most = std::max(most, last = values[k]);
    }
    if (n == 0) return unknown;
    return how == "mean" ? sum / n : how == "min" ? least : how == "max" ? most : last;
  };
}

/// Where a formula of the series first rises to a level, or falls below it for good.
Quantity crossing(const Place& at) {
  at.keys({"of", "rises_to", "falls_to", "along", "over_largest"});
  const std::string formula = at.formula("of"), along = at.word("along", {"t", "drained"}, "t");
  const bool rises = at.node.find("rises_to");
  if (rises && at.node.find("falls_to"))
    at.strict.say(at.node.line, at.below + "falls_to", "stands beside rises_to. Keep one.");
  const double level = at.number(rises ? "rises_to" : "falls_to");
  const bool relative = at.word("over_largest", {"yes", "no"}, "no") == "yes";
  return [=](const RunData& run) {
    const std::vector<double> values = run.along_series(formula), &x = run.series().at(along);
    double limit = level;
    if (relative) {
      double most = 0;
      for (const double v : values)
        if (std::isfinite(v)) most = std::max(most, v);
      limit *= most;
    }
    double place = unknown, before_x = unknown, before = unknown;
    for (std::size_t k = 1; k < values.size(); ++k) {
      if (!std::isfinite(values[k])) continue;
      const bool over = values[k] >= limit, was_over = before >= limit;
      if (std::isfinite(before) && over != was_over && over == rises) {
        place = before_x + (x[k] - before_x) * (limit - before) / (values[k] - before);
        if (rises) break;
      }
      if (!rises && over) place = unknown;
      before = values[k], before_x = x[k];
    }
    return place;
  };
}

/// How much a formula rises a second time: the lesser of two rises between which it rises more slowly than in either, by
/// means over bins of `along`; 0 if it rises once.
Quantity second_rise(const Place& at) {
  at.keys({"of", "along", "bins"});
  const std::string formula = at.formula("of"), along = at.word("along", {"t", "drained"}, "t");
  const double width = at.number("bins");
  return [=](const RunData& run) {
    const std::vector<double> values = run.along_series(formula), &x = run.series().at(along);
    std::map<long, std::array<double, 2>> bins;  // sum, number
    for (std::size_t k = 1; k < values.size(); ++k)
      if (std::isfinite(values[k])) {
        auto& bin = bins[std::lround(std::floor(x[k] / width))];
        bin[0] += values[k];
        ++bin[1];
      }
    std::vector<double> steps;
    for (auto bin = bins.begin(); bin != bins.end() && std::next(bin) != bins.end(); ++bin)
      steps.push_back(std::next(bin)->second[0] / std::next(bin)->second[1] -
                      bin->second[0] / bin->second[1]);
    double second = 0;
    for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
      const double before = *std::max_element(steps.begin(), steps.begin() + std::ptrdiff_t(i)),
                   after = *std::max_element(steps.begin() + std::ptrdiff_t(i) + 1, steps.end());
      second = std::max(second, std::min(before, after) - std::max(steps[i], 0.0));
    }
    return second;
  };
}

Quantity response(const Place& at) {
  at.keys({"take", "material"});
  const std::string how = at.word("take", {"mean", "variance", "mixing_index"}),
                    material = at.strict.text(at.node, at.below, "material");
  return [=](const RunData& run) {
    const RunData::Columns& c = run.series();
    const StepResponse found = step_response({c.at("t"), c.at("outflow"), c.at(material + "_outflow"),
                                              c.at("mass").front(), c.at(material + "_mass").front()});
    return how == "mean" ? found.mean : how == "variance" ? found.variance : found.mixing_index;
  };
}

// ---- the radial model ---------------------------------------------------------------------------------------

/// q on the axis, or the error of the shooting at one q: in the convention that compression is positive.
Quantity radial(const Place& at) {
  at.keys({"take", "q"});
  const std::string how =
      at.word("take", {"q_axis", "q_wall", "shooting_error", "mass_flow_limit", "half_angle"});
  const double q = how == "shooting_error" ? at.number("q") : 0;
  return [=](const RunData& run) {
    Scene scene = run.scene();
    resolve_model(scene);
    const RadialHopper hopper = radial_hopper(scene);
    constexpr double degrees = 180 / std::numbers::pi;
    if (how == "half_angle") return degrees * hopper.half_angle;
    if (how == "mass_flow_limit") {
      RadialHopper other = hopper;
      other.wall = WallAngle::friction;
      return degrees * mass_flow_limit(other);
    }
    if (how == "shooting_error") return shooting_error(hopper, q).value_or(unknown);
    const auto field = radial_field(hopper);
    if (!field) return unknown;
    return how == "q_axis" ? field->q_axis() : field->at(hopper.half_angle).q;
  };
}

const std::map<std::string, Quantity (*)(const Place&)> kinds{{"probe", probe},
                                                              {"flux_error", flux_error},
                                                              {"kinematic_distance", kinematic_distance},
                                                              {"kinematic_fit", kinematic_fit},
                                                              {"series", series_value},
                                                              {"crossing", crossing},
                                                              {"response", response},
                                                              {"second_rise", second_rise},
                                                              {"radial", radial}};

}  // namespace

Quantity quantity_of(const YamlNode& node, const std::string& below, StrictReader& strict) {
  std::vector<std::string> words;
  for (const auto& [word, build] : kinds) words.push_back(word);
  const std::size_t before = strict.said();
  if (node.kind != YamlNode::Kind::map) {
    strict.say(
        node.line, below.substr(0, below.size() - 1),
        fmt::format("found {} (expected a map with a kind: {}).", what_is(node), fmt::join(words, ", ")));
    return {};
  }
  const std::string kind = strict.word(node, below, "kind", words);
  if (strict.said() > before) return {};
  return kinds.at(kind)({node, below, strict});
}

}  // namespace hourglass
