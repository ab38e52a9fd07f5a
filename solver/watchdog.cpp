#include "solver/watchdog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "solver/diagnostics.hpp"
#include "solver/time_step.hpp"

namespace hourglass {
namespace {

/// Free fall over the whole domain, this many times; nothing in a silo is faster.
constexpr double speed_margin = 10;
/// Shares of the initial mass.
constexpr double mass_doubt = 1e-5, mass_lost = 1e-2;
/// Share of the grains' cells; at two looks one after the other, since grains that fall on others push hard for a moment.
constexpr double pressure_doubt = 0.02;

/// Cell of the largest |u| + |v|.
std::array<int, 2> fastest_cell(const Fields& f) {
  std::array<int, 2> at{0, 0};
  double most = -1;
  for (int j = 0; j < f.p.ny(); ++j)
    for (int i = 0; i < f.p.nx(); ++i) {
      const double speed = std::max(std::abs(f.u(i, j)), std::abs(f.u(i + 1, j))) +
                           std::max(std::abs(f.v(i, j)), std::abs(f.v(i, j + 1)));
      if (speed > most) most = speed, at = {i, j};
    }
  return at;
}

double heaviest(const Scene& scene) {
  double rho = scene.air.density;
  for (const Material& m : scene.materials) rho = std::max(rho, m.density);
  return rho;
}

}  // namespace

Watchdog::Watchdog(const Simulation::Impl& state, double initial_mass)
    : s_(state), initial_mass_(initial_mass) {
  const Scene& scene = s_.scene;
  std::array rows{RowSums(s_.fields.p.ny()), RowSums(s_.fields.p.ny())};
  const FastestCells start = fastest_cells(s_.fields, 1, rows);
  const double walls = scene.wall_friction ? std::hypot(scene.wall_friction->wall_velocity[0],
                                                        scene.wall_friction->wall_velocity[1])
                                           : 0;
  const double fall = std::sqrt(2 * scene.g() * (scene.width + scene.height));
  const double usual = std::max({fall, start.near_grains, start.air, walls});
  // Along a periodic slope a flow may gather speed for ever.
  const bool bounded = scene.wall(Side::left) != Wall::periodic && usual > 0;
  most_speed_ = bounded ? speed_margin * usual : std::numeric_limits<double>::infinity();
}

std::string Watchdog::place(int i, int j) const {
  const Patch& patch = s_.fields.patch();
  return fmt::format("cell ({}, {}), x = {:.6g}, y = {:.6g}", i, j, patch.x_corner(i) + 0.5 * patch.h,
                     patch.y_corner(j) + 0.5 * patch.h);
}

Trouble Watchdog::of_step(const StepReport& report) {
  for (const auto& [name, stats] : {std::pair{"pressure", &report.pressure},
                                    {"viscous", &report.viscous},
                                    {"fluidity", &report.fluidity}}) {
    const bool finite = std::isfinite(stats->final);
    if (stats->converged && finite) continue;
    return {fmt::format(
                "the {} solve missed its tolerance at t = {:.6g} (step {}): {:.3g} instead of {:.3g} after "
                "{} iterations, worst at {}",
                name, report.t, report.step, stats->final, stats->tolerance, stats->iterations,
                place(stats->worst_i, stats->worst_j)),
            !finite || stats->final > 1e3 * stats->tolerance};
  }
  if (report.max_speed > most_speed_) {
    const auto [i, j] = fastest_cell(s_.fields);
    return {
        fmt::format(
            "a speed of {:.3g} at t = {:.6g} (step {}), {} times that of free fall through the domain, at {}",
            report.max_speed, report.t, report.step, speed_margin, place(i, j)),
        true};
  }
  return {};
}

Trouble Watchdog::of_state() {
  const double error = s_.mass_error(initial_mass_);
  if (error <= mass_lost && std::isfinite(error)) return {};
  return {fmt::format("mass is not conserved: {:.3g} of it is not accounted for at t = {:.6g} (step {})",
                      error, s_.t, s_.steps),
          true};
}

std::vector<std::string> Watchdog::doubts() {
  std::vector<std::string> found{doubt_of_mass(), doubt_of_pressure()};
  found.erase(std::remove(found.begin(), found.end(), ""), found.end());
  return found;
}

std::string Watchdog::doubt_of_mass() {
  const double error = s_.mass_error(initial_mass_);
  if (said_mass_ || error <= mass_doubt) return {};
  said_mass_ = true;
  return fmt::format(
      "{:.3g} of the mass is not accounted for at t = {:.6g}: take a smaller accuracy.pressure_tolerance",
      error, s_.t);
}

std::string Watchdog::doubt_of_pressure() {
  const Scene& scene = s_.scene;
  // A moving wall may press as it likes.
  if (said_pressure_ || s_.t < start_up_time(scene) ||
      (scene.wall_friction && scene.wall_friction->wall_velocity != std::array<double, 2>{0, 0}))
    return {};
  const double share = pressure_outside(scene, s_.fields, s_.geometry.get(),
                                        fastest_grains(s_.fields, s_.geometry.get(), s_.threads));
  looks_outside_ = share > pressure_doubt ? looks_outside_ + 1 : 0;
  if (looks_outside_ < 2) return {};
  said_pressure_ = true;
  return fmt::format(
      "the pressure of {:.3g} of the grains lies outside of what their weight accounts for at t = {:.6g}: "
      "the flow may "
      "be wrong though mass is conserved; compare with a smaller time.dt_max, or with "
      "accuracy.splitting.outer 3",
      share, s_.t);
}

double pressure_outside(const Scene& scene, const Fields& fields, const Geometry* geometry, double fastest) {
  const double rho = heaviest(scene);
  const double weight =
      rho * (std::abs(scene.gravity[0]) * scene.width + std::abs(scene.gravity[1]) * scene.height);
  if (weight <= 0) return 0;
  const double least = -0.01 * weight, most = weight + rho * fastest * fastest;
  long grains = 0, outside = 0;
  for (int j = 0; j < fields.p.ny(); ++j)
    for (int i = 0; i < fields.p.nx(); ++i) {
      if (fields.grains(i, j) <= 0.5 || (geometry && geometry->volume(i, j) == 0)) continue;
      ++grains;
      outside += fields.p(i, j) < least || fields.p(i, j) > most;
    }
  return grains > 0 ? static_cast<double>(outside) / static_cast<double>(grains) : 0;
}

}  // namespace hourglass
