#pragma once
// `hourglass fit`: the kinematic model that comes nearest to a stored run.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "solver/models/kinematic_fit.hpp"

namespace hourglass {

struct RunFit {
  double t = 0;  ///< of the frame [T]
  double B = 0;  ///< [L]
  double Q = 0;  ///< discharge rate of the whole silo [M/T]
  double misfit = 0;

  /// A row of cells.
  struct Height {
    double y = 0;                           ///< [L]
    double B = 0;                           ///< fitted to this row alone [L]
    double fastest = 0, fastest_fit = 0;    ///< largest speed downwards, of run and fit [L/T]
    double flatness = 0, flatness_fit = 0;  ///< share of the row's width that is faster than half of it [1]
    std::vector<VelocitySample> samples{};  ///< of the run
    std::vector<double> fit{};              ///< of the fit at the same places [L/T]
  };
  std::vector<Height> heights;  ///< about ten, from the floor to the surface
};

/// Fits B and Q, the same for all heights, to the vertical velocity in all cells full of grains of one frame:
/// the nearest to `time`, or the first whose flow has developed. Throws std::runtime_error if the run cannot
/// be read, std::invalid_argument if its scene is none that the kinematic model can have, or the time is
/// outside the run.
RunFit fit_run(const std::filesystem::path& run, std::optional<double> time);

/// What `hourglass fit` prints.
std::string text_of(const RunFit& fit);

/// A row each for x, y, v of the run and v of the fit.
std::string csv_of(const RunFit& fit);

}  // namespace hourglass
