#include "studies/shear_probe.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {
namespace {

constexpr double amplitude = 1e-4;      // of the wave's shear rate over that of the flow
constexpr int transient = 6;            // steps that the pressure takes to follow
constexpr int aspect = 12;              // height over width
constexpr double largest_angle = 0.44;  // rad; beyond, waves that are near 45 degrees grow hardly less

/// The scene of the probe. Gravity only says what the scale of a pressure is; its weight is a hundredth of P.
Scene scene_of(const ShearProbe& probe) {
  Scene s;
  s.materials = {probe.scene.materials.at(0)};
  s.rheology = probe.scene.rheology;
  s.nonlocal = probe.scene.nonlocal;
  if (s.nonlocal) s.nonlocal->walls = FluidityWall::no_flux;
  s.cells_x = probe.cells;
  s.width = probe.wavelength / std::cos(probe.angle());
  const double h = s.width / s.cells_x;
  s.height = aspect * s.width;
  s.fill = {{0, {{0, 0}, {s.width, 0}, {s.width, s.height}, {0, s.height}}}};
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, Wall::free_slip};
  s.rheology.background_pressure = probe.pressure;
  s.gravity = {0, -4e-5 * probe.pressure / (s.materials[0].density * h)};
  s.start_pressure = StartPressure::hydrostatic;
  s.time.dt_max = probe.time_step();
  s.time.max_steps = probe.steps;
  s.accuracy.precision = Precision::full;
  s.accuracy.viscous_tolerance = 1e-9;
  s.accuracy.pressure_tolerance = 1e-13;
  s.accuracy.fluidity_tolerance = 1e-6;
  s.accuracy.max_iterations = 500;
  s.accuracy.splitting = probe.scene.accuracy.splitting;
  s.threads = 1;
  return s;
}

/// rms over the middle rows of how far v is from its mean along the flow.
double wave_in(const Fields& f) {
  const int nx = f.v.nx(), ny = f.p.ny();
  double sum = 0;
  for (int j = 11 * ny / 24; j < 13 * ny / 24; ++j) {
    double mean = 0;
    for (int i = 0; i < nx; ++i) mean += f.v(i, j) / nx;
    for (int i = 0; i < nx; ++i) sum += (f.v(i, j) - mean) * (f.v(i, j) - mean);
  }
  return std::sqrt(sum);
}

/// u = γ̇ y and the wave, whose stream function is taken at corners, so that it has no divergence.
void start(const ShearProbe& probe, Fields& f) {
  const Patch& patch = f.patch();
  const double rate = probe.shear_rate(), k = 2 * M_PI / probe.wavelength;
  const double kx = k * std::cos(probe.angle()), ky = k * std::sin(probe.angle());
  const auto psi = [&](int i, int j) {
    return amplitude * rate / (k * k) * std::cos(kx * patch.x_corner(i) + ky * patch.y_corner(j));
  };
  for (int j = 0; j < f.u.ny(); ++j)
    for (int i = 0; i < f.u.nx(); ++i)
      f.u(i, j) = rate * patch.y_centre(j) + (psi(i, j + 1) - psi(i, j)) / patch.h;
  for (int j = 1; j + 1 < f.v.ny(); ++j)
    for (int i = 0; i < f.v.nx(); ++i) f.v(i, j) = -(psi(i + 1, j) - psi(i, j)) / patch.h;
}

}  // namespace

FrictionAt friction_at(double I, const Material& material, const Rheology& rheology) {
  const Grain grain = grain_of(material);
  const auto regularised =
      rheology.law == Law::mu_I_regularised ? regularised_friction(material, rheology) : std::nullopt;
  if (rheology.law == Law::newtonian || (rheology.law == Law::mu_I_regularised && !regularised))
    throw std::invalid_argument("the law has no friction for this material");
  const auto mu = [&](double at) { return regularised ? regularised->mu(at, grain) : mu_of_I(at, grain); };
  const double step = 1e-4;
  return {mu(I), std::log(mu(I * (1 + step)) / mu(I * (1 - step))) / std::log((1 + step) / (1 - step))};
}

double lag_factor(const FrictionAt& f) {
  const double rest = 1 - f.nu, q = f.mu * (1 - f.nu / 2);
  return q <= 2 * rest ? rest + q * q / (4 * rest) : q;
}

/// F: what smoothing leaves of the wave's shear rate.
static double smoothed(const ShearProbe& probe) {
  const double k = 2 * M_PI / probe.wavelength;
  return std::exp(-std::pow(k * probe.scene.rheology.smoothing_length, 2) / 4);
}

double ShearProbe::angle() const {
  const FrictionAt f = friction_at(I, scene.materials.at(0), scene.rheology);
  const double S = f.mu * (1 - f.nu / 2) / (2 * (1 - f.nu) * smoothed(*this));
  return S < 1 && f.nu < 1 ? std::min(0.5 * std::asin(S), largest_angle) : largest_angle;
}
double ShearProbe::shear_rate() const {
  const Material& m = scene.materials.at(0);
  return I * std::sqrt(pressure / m.density) / m.diameter;
}
double ShearProbe::viscosity() const {
  return friction_at(I, scene.materials.at(0), scene.rheology).mu * pressure / shear_rate();
}
double ShearProbe::time_step() const {
  const double k = 2 * M_PI / wavelength;
  return stiffness * scene.materials.at(0).density / (viscosity() * k * k);
}

Growth measured_growth(const ShearProbe& probe) {
  Simulation simulation(scene_of(probe));
  start(probe, simulation.fields());
  std::vector<double> logs;
  try {
    for (int n = 1; n <= probe.steps; ++n) {
      const StepReport report = simulation.step();
      if (!report.viscous.converged || !report.pressure.converged) return {NAN, NAN};
      if (n >= transient) logs.push_back(std::log(wave_in(simulation.fields())));
    }
  } catch (const std::runtime_error&) {  // not a number
    return {NAN, NAN};
  }
  const auto n = static_cast<double>(logs.size());
  double slope = 0;
  for (std::size_t k = 0; k < logs.size(); ++k) slope += (static_cast<double>(k) - (n - 1) / 2) * logs[k];
  slope *= 12 / (n * (n * n - 1));
  return {slope, slope / (probe.time_step() * probe.shear_rate())};
}

Growth predicted_growth(const ShearProbe& probe) {
  const Splitting& splitting = probe.scene.accuracy.splitting;
  if (probe.scene.nonlocal || splitting.outer > 1 || splitting.picard > 1) return {NAN, NAN};
  const FrictionAt f = friction_at(probe.I, probe.scene.materials.at(0), probe.scene.rheology);
  const Rheology& rheology = probe.scene.rheology;
  const double per_step = probe.time_step() * probe.shear_rate();
  const double share = std::min(rheology.eta_max / probe.viscosity(), 1.0);
  const double s = share * probe.stiffness;
  const double k = 2 * M_PI / probe.wavelength, angle = probe.angle();
  const double h = probe.wavelength / std::cos(angle) / probe.cells;
  const double a = std::cos(k * std::cos(angle) * h / 2) * std::cos(k * std::sin(angle) * h / 2);
  const double F = smoothed(probe);
  const double c = std::cos(2 * angle), S = std::sin(2 * angle), q = f.mu * (1 - f.nu / 2);
  const double r = s * (2 - splitting.rotational) / (1 + 2 * s);
  if (share < 1) return {-std::log(1 + s), -std::log(1 + s) / per_step};
  const double from_rate = (1 - f.nu) * a * a * F;
  const double m11 = (1 + s * from_rate * c * c) / (1 + s), m12 = -s * c * (1 - f.nu / 2) * a / (1 + s),
               m21 = -(1 - r) * S * f.mu * from_rate * c, m22 = (1 - r) * S * q * a + r;
  const std::complex<double> root =
      std::sqrt(std::complex<double>((m11 - m22) * (m11 - m22) / 4 + m12 * m21, 0));
  const double mean = (m11 + m22) / 2;
  const double growth = std::log(std::max(std::abs(mean + root), std::abs(mean - root)));
  return {growth, growth / per_step};
}

}  // namespace hourglass
