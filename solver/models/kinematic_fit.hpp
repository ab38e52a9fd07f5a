#pragma once
// B and Q of the kinematic model from measured vertical velocities, by least squares.
#include <span>

#include "solver/models/kinematic.hpp"

namespace hourglass {

struct VelocitySample {
  double x = 0, y = 0;  ///< [L], y above the floor
  double v = 0;         ///< vertical velocity [L/T]
};

struct KinematicFit {
  double B = 0;       ///< [L]
  double factor = 0;  ///< of all rates of the floor's sources [1]
  double misfit = 0;  ///< root of the sum of squared differences over that of squared v [1]
};

/// The B and the common factor of the sources' rates that bring the sum of (v - v_model)^2 to its least. The
/// factor follows linearly from B; B by Gauss and Newton from the best of a scan over 1e-4 to 1 of the width.
/// Throws std::invalid_argument if nothing moves.
KinematicFit fit_kinematic(const Floor& floor, std::span<const VelocitySample> samples);

}  // namespace hourglass
