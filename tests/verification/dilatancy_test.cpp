// Packing fraction phi(I): mass and rate of a drain in each mode, and the uniform I of Bagnold flow.
#include <catch2/catch.hpp>

#include "tests/support/figures.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

/// To a steady rate.
Scene drain(int cells, std::optional<DilatancyMode> mode, double phi_g = 0.2) {
  Scene s = silo(cells, 27.386);
  if (mode) s.dilatancy = Dilatancy{.phi_g = phi_g, .mode = *mode};
  return s;
}

/// Extremes of the packing fraction in cells full of grains.
class Packing : public Observer {
 public:
  explicit Packing(const Simulation& simulation) : simulation_(simulation) {}
  void on_step(const StepReport& report, double) override {
    if (report.step % 20 != 0) return;
    const Fields& f = simulation_.fields();
    const double phi_max = simulation_.scene().dilatancy->phi_max;
    for (int j = 0; j < f.p.ny(); ++j)
      for (int i = 0; i < f.p.nx(); ++i) {
        if (f.grains(i, j) <= 0.99) continue;
        const double phi = phi_max * f.solid[0](i, j) / f.grains(i, j);
        low = std::min(low, phi);
        high = std::max(high, phi);
      }
  }
  double low = 1, high = 0;

 private:
  const Simulation& simulation_;
};

/// What has left through orifices, by material, from the rates of the series.
class Outflow : public Observer {
 public:
  void on_series(const SeriesRow& row) override {
    lost.resize(row.material_outflow.size());
    for (std::size_t k = 0; k < lost.size(); ++k) lost[k] += row.material_outflow[k] * (row.step.t - t_);
    t_ = row.step.t;
  }
  std::vector<double> lost;

 private:
  double t_ = 0;
};

const char* name_of(DilatancyMode mode) { return dilatancy_mode_names[static_cast<int>(mode)]; }

}  // namespace

TEST_CASE("dilatancy, a whole drain at 64^2: mass is kept, the packing stays in its range", "[slow]") {
  for (DilatancyMode mode : {DilatancyMode::source, DilatancyMode::relax}) {
    Scene scene = drain(64, mode);
    scene.time.end = 300;
    scene.stop.mass_below = 0.25;
    Simulation simulation(scene);
    Packing packing(simulation);
    const Summary summary = simulation.run({&packing});
    figure("dilatancy %s, whole drain at 64^2: mass error %.1e, packing %.4f to %.4f, missed %ld",
           name_of(mode), summary.mass_error, packing.low, packing.high, summary.missed_tolerances);
    CHECK(summary.status == Status::stopped);
    CHECK(summary.missed_tolerances == 0);
    CHECK(summary.mass_error < 1e-12);
    CHECK(packing.low > 0.99 * scene.dilatancy->phi_min);
    CHECK(packing.high < 1.01 * scene.dilatancy->phi_max);
  }
}

TEST_CASE("dilatancy: a silo drains more slowly, by mode weight half as much so; mass or volume is kept") {
  std::vector<double> rates;
  for (std::optional<DilatancyMode> mode : {std::optional<DilatancyMode>{},
                                            {DilatancyMode::source},
                                            {DilatancyMode::relax},
                                            {DilatancyMode::weight}}) {
    const Summary summary = Simulation(drain(64, mode)).run();
    rates.push_back(summary.discharge_rate);
    figure("dilatancy %s, 64^2: rate %.3f (%+.1f %%), mass error %.1e, missed %ld",
           mode ? name_of(*mode) : "none", rates.back(), 100 * (rates.back() / rates[0] - 1),
           summary.mass_error, summary.missed_tolerances);
    CHECK(summary.missed_tolerances == 0);
    // Solid that is carried by itself is kept to rounding. Of mode weight the volume is, as VOF keeps it.
    CHECK(summary.mass_error < (mode && *mode != DilatancyMode::weight ? 1e-12 : 1e-6));
  }
  for (std::size_t k : {1, 2}) {
    CHECK(rates[k] < 0.9 * rates[0]);
    CHECK(rates[k] > 0.7 * rates[0]);
    CHECK(rates[3] > rates[k]);
  }
  CHECK(rates[3] < rates[0]);
}

TEST_CASE("dilatancy, a drain: half the step gives the same rate", "[slow]") {
  for (DilatancyMode mode : {DilatancyMode::source, DilatancyMode::relax}) {
    std::vector<double> rates;
    for (double dt_max : {0.0548, 0.0274, 0.0137}) {
      Scene scene = drain(64, mode);
      scene.time.dt_max = dt_max;
      scene.time.cfl = 0.5 * dt_max / 0.0548;
      rates.push_back(Simulation(scene).run().discharge_rate);
    }
    figure("dilatancy %s, 64^2: rate by step %.3f %.3f %.3f", name_of(mode), rates[0], rates[1], rates[2]);
    CHECK(rates[1] == Approx(rates[0]).epsilon(0.03));
    CHECK(rates[2] == Approx(rates[1]).epsilon(0.03));
  }
}

// S does not depend on the pressure then, and a pressure that grains do not feel must not be given to them.
TEST_CASE("dilatancy with no slope, or next to none, is the plain run", "[slow]") {
  Scene scene = drain(64, {});
  Simulation plain(scene);
  const Summary without = plain.run();
  for (DilatancyMode mode : {DilatancyMode::source, DilatancyMode::relax, DilatancyMode::weight})
    for (double phi_g : {0.0, 1e-5}) {
      Simulation with(drain(64, mode, phi_g));
      Packing packing(with);
      const Summary summary = with.run({&packing});
      double volume = 0, same = 0;
      for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) {
          volume += with.fields().grains(i, j);
          same += plain.fields().grains(i, j);
        }
      const double rate = summary.discharge_rate / without.discharge_rate - 1;
      figure("dilatancy %s, phi_g %.0e: rate off by %.1e, volume by %.1e, packing %.6f to %.6f",
             name_of(mode), phi_g, rate, volume / same - 1, packing.low, packing.high);
      CHECK(std::abs(rate) < (phi_g == 0 ? 1e-4 : 1e-3));
      CHECK(std::abs(volume / same - 1) < (phi_g == 0 ? 1e-5 : 1e-3));
      if (phi_g > 0) continue;  // a cell in free fall is loose at any slope, for its I is without bound
      CHECK(packing.low > 0.6 - 1e-5);
      CHECK(packing.high < 0.6 + 1e-5);
    }
}

TEST_CASE("dilatancy, two materials: the mass of each is kept") {
  for (DilatancyMode mode : {DilatancyMode::source, DilatancyMode::relax}) {
    Scene scene = silo(64, 12);
    scene.dilatancy = Dilatancy{.mode = mode};
    Material heavy = scene.materials[0];
    heavy.name = "heavy";
    heavy.density = 2;
    heavy.phi_g = 0.1;
    scene.materials.push_back(heavy);
    scene.fill.push_back(fill_box(1, 0, 150, 10, 60));
    scene.output.series_every = 1;
    Simulation simulation(scene);
    const std::vector<double> before = simulation.material_mass();
    Outflow outflow;
    simulation.run({&outflow});
    const std::vector<double>&after = simulation.material_mass(), &lost = outflow.lost;
    for (int k = 0; k < 2; ++k) {
      const double error = std::abs(before[k] - after[k] - lost[k]) / before[k];
      figure("dilatancy %s, two materials: %d lost %.1f of %.1f, error %.1e", name_of(mode), k, lost[k],
             before[k], error);
      CHECK(lost[k] > 0);
      CHECK(error < 1e-6);
    }
  }
}

// Bagnold flow has one I everywhere, tan alpha = mu(I), so one phi(I) and one density rho phi / phi_max: P is that much
// lower, and the velocity, (2/3) (I/d) sqrt(P_floor / rho) h, by the root of it.
TEST_CASE("dilatancy, Bagnold flow: the packing settles at phi(I)") {
  const double alpha = 0.40, d = 0.25;
  const Material grains = well_posed_grains();
  const double I =
      grains.I_0 * (std::tan(alpha) - grains.mu_s) / (grains.mu_s + grains.delta_mu - std::tan(alpha));
  for (DilatancyMode mode : {DilatancyMode::source, DilatancyMode::relax}) {
    Scene s;
    s.height = 1;
    s.width = 4.0 / 32;
    s.cells_x = 4;
    s.gravity = {std::sin(alpha), -std::cos(alpha)};
    s.materials = {grains};
    s.materials[0].diameter = d;
    s.fill = {fill_box(0, 0, s.width, 0, 1)};
    s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::open};
    s.rheology.eta_min = 1e-6;
    s.rheology.eta_max = 1e5;
    s.rheology.smoothing_length = 0;
    s.rheology.corner_mean = CornerMean::arithmetic;
    s.dilatancy = Dilatancy{.mode = mode, .relaxation_time = 0.5};
    s.accuracy = {.viscous_tolerance = 1e-6, .pressure_tolerance = 1e-8, .precision = Precision::full};
    s.threads = 1;
    Simulation simulation(s);
    Fields& f = simulation.fields();
    const int n = f.p.ny();
    const double wanted = 0.6 - 0.2 * I, lighter = wanted / 0.6;
    const auto speed = [&](double y) {
      return 2.0 / 3 * I / d * std::sqrt(lighter * std::cos(alpha)) * (1 - std::pow(1 - y, 1.5));
    };
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < f.u.nx(); ++i) f.u(i, j) = speed(f.patch().y_centre(j));
      for (int i = 0; i < 4; ++i) f.p(i, j) = std::cos(alpha) * (1 - f.patch().y_centre(j));
    }
    while (simulation.t() < 40) simulation.step(40);
    double worst = 0, surface = 0, slower = 0;
    for (int j = 0; j < n; ++j) {
      const double phi = 0.6 * f.solid[0](1, j) / f.grains(1, j);
      // The grid does not resolve I in the last cells below the surface, where the shear rate goes as its root.
      double& largest = j < n - 2 ? worst : surface;
      largest = std::max(largest, std::abs(phi / wanted - 1));
      slower = std::max(slower, std::abs(f.u(1, j) - speed(f.patch().y_centre(j))) / speed(1));
    }
    figure(
        "dilatancy %s, Bagnold: packing off phi(I) = %.4f by at most %.2e, in the two surface cells %.2e, "
        "speed by %.2e",
        name_of(mode), wanted, worst, surface, slower);
    CHECK(worst < 0.01);
    CHECK(surface < 0.05);
    CHECK(slower < 0.01);
  }
}
