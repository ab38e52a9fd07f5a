#pragma once
// How long a run will take, to an order of magnitude and at no cost; `hourglass plan` knows better, in seconds a scene.
#include <algorithm>
#include <cmath>

#include "solver/diagnostics.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// Seconds a cell and step, one thread, before anything has been timed (docs/plan.md).
inline constexpr double cell_step_seconds = 150e-9;

/// Largest speed of the grains [L/T]: 1.4 sqrt(g W), W the widest orifice.
inline double expected_speed(const Scene& scene) {
  double widest = 0;
  for (const Orifice& orifice : scene.orifices) widest = std::max(widest, orifice.width);
  return 1.4 * std::sqrt(scene.g() * widest);
}

/// Steps that dt_max, or the Courant number at this speed, allows to time.end; without one until the whole domain would
/// have left at the rate rho sqrt(g) W^1.5. 0 for a model in closed form.
inline double expected_steps(const Scene& scene, double speed) {
  if (scene.model != Model::mu_I) return 0;
  const TimeControl& time = scene.time;
  const double longest = scene.accuracy.step_factor * time.dt_max;
  const double dt = speed > 0 ? std::min(longest, time.cfl * scene.patch().h / speed) : longest;
  double end = time.end > 0 ? time.end : HUGE_VAL;
  if (const double scale = discharge_scale(scene, total_width(scene)); time.end <= 0 && scale > 0)
    end = scene.materials[0].density * scene.width * scene.height * scene.copies() / scale;
  const double most = time.max_steps > 0 ? static_cast<double>(time.max_steps) : HUGE_VAL;
  return std::min(std::ceil(end / dt), most);
}

}  // namespace hourglass
