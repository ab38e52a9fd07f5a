#include "studies/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "io/csv.hpp"
#include "studies/limits_pictures.hpp"

namespace hourglass {
namespace {

std::vector<double> spread(double first, double last, int count, bool log = false) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) {
    const double part = static_cast<double>(k) / (count - 1);
    values.push_back(log ? first * std::pow(last / first, part) : first + part * (last - first));
  }
  return values;
}

/// The table of growth: a point is measured once, whoever asks.
class GrowthTable {
 public:
  explicit GrowthTable(const std::filesystem::path& folder)
      : ledger_(folder / "limits_growth.csv",
                {"point", "cure", "I", "mu_s", "delta_mu", "I_0", "eta_max", "wavelength", "growth_per_step",
                 "growth_per_shear", "predicted_per_step", "lag_factor", "C"}) {}

  /// Growth per step with a cure; NaN where the law has no friction or a solve failed.
  double operator()(ShearProbe probe, const Cure& cure) {
    const Material m = probe.scene.materials[0];
    const double wished_cap = probe.scene.rheology.eta_max;
    cure.apply(probe);
    const std::string key = fmt::format("{} I={:.4g} {:.6g},{:.6g},{:.6g},{:.6g}", cure.name, probe.I, m.mu_s,
                                        m.delta_mu, m.I_0, wished_cap);
    if (const Ledger::Row* row = ledger_.find(key)) return number(row->at("growth_per_step"));
    const auto cell = [](double x) { return std::isfinite(x) ? fmt::format("{:.6g}", x) : std::string(); };
    Ledger::Row row{{"point", key},
                    {"cure", cure.name},
                    {"I", cell(probe.I)},
                    {"mu_s", cell(m.mu_s)},
                    {"delta_mu", cell(m.delta_mu)},
                    {"I_0", cell(m.I_0)},
                    {"eta_max", cell(wished_cap)},
                    {"wavelength", cell(probe.wavelength)},
                    {"C", cell(well_posedness(probe.I, grain_of(m)))}};
    Growth measured{NAN, NAN};
    if (has_friction(probe)) {
      measured = measured_growth(probe);
      row["growth_per_step"] = cell(measured.per_step);
      row["growth_per_shear"] = cell(measured.per_shear);
      row["predicted_per_step"] = cell(predicted_growth(probe).per_step);
      row["lag_factor"] =
          cell(lag_factor(friction_at(probe.I, probe.scene.materials[0], probe.scene.rheology)));
    }
    ledger_.add(row);
    if (ledger_.rows().size() % 50 == 0) {
      fmt::print("{} points\n", ledger_.rows().size());
      std::fflush(stdout);
    }
    return measured.per_step;
  }

 private:
  static bool has_friction(const ShearProbe& probe) {
    return probe.scene.rheology.law != Law::mu_I_regularised ||
           regularised_friction(probe.scene.materials[0], probe.scene.rheology).has_value();
  }
  static double number(const std::string& cell) { return cell.empty() ? NAN : std::stod(cell); }

  Ledger ledger_;
};

GrowthMap friction_map(const Scene& scene, double I, const Cure& cure, GrowthTable& table, bool coarse) {
  GrowthMap map{spread(0.1, 1.1, coarse ? 6 : 11), spread(0.04, 1.0, coarse ? 5 : 9), {}};
  for (const double delta_mu : map.at_y)
    for (const double mu_s : map.at_x) {
      ShearProbe probe = bare_probe(scene, I);
      probe.scene.materials[0].mu_s = mu_s;
      probe.scene.materials[0].delta_mu = delta_mu;
      map.growth.push_back(table(probe, cure));
    }
  return map;
}

GrowthMap cap_map(const Scene& scene, double I, GrowthTable& table, bool quick) {
  const double unit = scales(scene).viscosity;
  GrowthMap map{
      spread(1e-3, 10, quick ? 5 : 9, true), spread(30 * unit, 3e4 * unit, quick ? 4 : 10, true), {}};
  for (const double eta_max : map.at_y)
    for (const double I_0 : map.at_x) {
      ShearProbe probe = bare_probe(scene, I);
      probe.scene.materials[0].I_0 = I_0;
      probe.scene.rheology.eta_max = eta_max;
      probe.scene.rheology.eta_min = std::min(probe.scene.rheology.eta_min, eta_max / 10);
      map.growth.push_back(table(probe, cures().front()));
    }
  return map;
}

}  // namespace

const std::vector<Cure>& cures() {
  const auto smoothed = [](double grains) {
    return [grains](ShearProbe& p) {
      p.scene.rheology.smoothing_length = grains * p.scene.materials[0].diameter;
    };
  };
  static const std::vector<Cure> list{
      {"none", [](ShearProbe&) {}},
      {"smoothing_length d/2", smoothed(0.5)},
      {"smoothing_length d", smoothed(1)},
      {"law mu_I_regularised", [](ShearProbe& p) { p.scene.rheology.law = Law::mu_I_regularised; }},
      {"nonlocal thesis", [](ShearProbe& p) { p.scene.nonlocal = Nonlocal{}; }},
      {"nonlocal kamrin", [](ShearProbe& p) { p.scene.nonlocal = Nonlocal{.closure = Closure::kamrin}; }},
      {"a quarter of the step", [](ShearProbe& p) { p.stiffness /= 4; }},
      {"splitting.picard 2", [](ShearProbe& p) { p.scene.accuracy.splitting.picard = 2; }},
      {"splitting.outer 2", [](ShearProbe& p) { p.scene.accuracy.splitting.outer = 2; }},
  };
  return list;
}

ShearProbe bare_probe(const Scene& scene, double I) {
  if (scene.rheology.law == Law::newtonian)
    throw std::invalid_argument("limits: law newtonian has no friction, so nothing is ill-posed (mu_I).");
  if (scene.model != Model::mu_I)
    throw std::invalid_argument("limits: the model of this scene has no friction law (only mu_I).");
  ShearProbe probe;
  probe.scene = scene;
  probe.scene.rheology.law = Law::mu_I;
  probe.scene.rheology.smoothing_length = 0;
  probe.scene.rheology.cap = Cap::clip;
  probe.scene.nonlocal.reset();
  probe.scene.accuracy.splitting = Splitting{};
  probe.I = I;
  probe.pressure = 0.5 * scene.materials[0].density * scene.g() * scene.height;
  probe.wavelength = 4 * scene.width / scene.cells_x * std::min(1.0, 0.02 / I);
  return probe;
}

std::optional<double> analytic_border(double delta_mu, double I_0, double I) {
  const auto C = [&](double mu_s) {
    return well_posedness(I, Grain{.mu_s = mu_s, .delta_mu = delta_mu, .I_0 = I_0});
  };
  std::vector<double> mu_s, value;
  for (int k = 1; k <= 30000; ++k) {
    mu_s.push_back(1e-4 * k);
    value.push_back(C(mu_s.back()));
  }
  return first_crossing(mu_s, value);
}

std::optional<double> first_crossing(const std::vector<double>& x, const std::vector<double>& y) {
  std::optional<std::size_t> before;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(y[k])) continue;
    if (before && y[*before] <= 0 && y[k] > 0)
      return x[*before] + (x[k] - x[*before]) * y[*before] / (y[*before] - y[k]);
    before = k;
  }
  return std::nullopt;
}

void measure_limits(const Scene& scene, const LimitsOptions& options) {
  const double slow = 0.01, fast = 0.3, I_0 = scene.materials.at(0).I_0;
  bare_probe(scene, slow);
  std::filesystem::create_directories(options.out);
  GrowthTable table(options.out);
  const GrowthMap fast_map = friction_map(scene, fast, cures().front(), table, options.quick);
  draw_friction_map(fast_map, I_0, fast, options.out / "growth_fast.png");
  const GrowthMap caps = cap_map(scene, slow, table, options.quick);
  draw_cap_map(caps, scene, slow, options.out / "cap.png");

  std::vector<BorderCurve> borders;
  std::vector<std::vector<std::string>> rows;
  for (const Cure& cure : cures()) {
    const bool bare = &cure == &cures().front();
    const GrowthMap map = friction_map(scene, slow, cure, table, options.quick || !bare);
    if (bare) draw_friction_map(map, I_0, slow, options.out / "growth_slow.png");
    borders.push_back({cure.name, map.border()});
    std::vector<std::string> row{cure.name};
    for (const FrictionSet& set : thesis_sets) {
      ShearProbe probe = bare_probe(scene, slow);
      probe.scene.materials[0].mu_s = set.mu_s;
      probe.scene.materials[0].delta_mu = set.delta_mu;
      const double growth = table(probe, cure);
      row.push_back(std::isfinite(growth) ? fmt::format("{:+.4f}", growth) : "no solution");
    }
    // Along the sets' own ratio of delta_mu to mu_s.
    std::vector<double> mu_s = spread(0.1, 1.1, options.quick ? 6 : 11), growth;
    for (const double m : mu_s) {
      ShearProbe probe = bare_probe(scene, slow);
      probe.scene.materials[0].mu_s = m;
      probe.scene.materials[0].delta_mu = thesis_sets[1].delta_mu / thesis_sets[1].mu_s * m;
      growth.push_back(table(probe, cure));
    }
    const auto border = first_crossing(mu_s, growth);
    row.push_back(border ? fmt::format("{:.3f}", *border)
                  : std::any_of(growth.begin(), growth.end(), [](double g) { return g > 0; })
                      ? "below 0.1"
                      : "none to 1.1");
    rows.push_back(row);
  }
  draw_borders(borders, I_0, slow, options.out / "borders.png");

  std::string csv = csv_row({"cure", "low", "medium", "high", "border_mu_s"});
  fmt::print(
      "\nGrowth per step at I = {} of waves as long as four cells of the scene, and the mu_s where it is 0\n",
      slow);
  fmt::print("{:<24} {:>12} {:>12} {:>12} {:>12}\n", "", "low", "medium", "high", "border");
  for (const auto& row : rows) {
    csv += csv_row(row);
    fmt::print("{:<24} {:>12} {:>12} {:>12} {:>12}\n", row[0], row[1], row[2], row[3], row[4]);
  }
  write_atomically(options.out / "limits_cures.csv", csv);
}

}  // namespace hourglass
