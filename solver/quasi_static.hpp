#pragma once
// How much of the grains hardly moves, and how much of that lies on top of an insert.
#include <array>
#include <vector>

#include "kernels/geometry.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"
#include "solver/simulation.hpp"

namespace hourglass {

/// Grains slower than so many sqrt(g d) are told of; those slower than the second count as quasi-static.
inline constexpr std::array quasi_static_thresholds{1e-2, 1e-3, 1e-4};

/// sqrt(g d), d that of material 0 [L/T].
double grain_speed(const Scene& scene);

/// Grains slower than this count as quasi-static: 1e-3 sqrt(g d).
double quasi_static_speed(const Scene& scene);

/// An edge of an insert that is level and looks up.
struct FlatTop {
  double x0, x1, y;  ///< [L], x0 < x1
};

/// Of all inserts but circles; none where gravity does not point down.
std::vector<FlatTop> flat_tops(const Scene& scene);

/// Shares of the grain volume that are slower than each of some speeds.
struct SlowShares {
  std::vector<double> all;
  /// Of it, what lies straight above a flat top, up to the surface; empty without flat tops.
  std::vector<double> above_flat_tops;
};

/// speeds [L/T]; geometry: nullptr, or that of the scene.
SlowShares slow_shares(const Fields& fields, const Geometry* geometry, const std::vector<FlatTop>& tops,
                       const std::vector<double>& speeds, int threads);
/// The same of fields at cell centres.
SlowShares slow_shares(const CellField& grains, const CellField& speed, const Geometry* geometry,
                       const std::vector<FlatTop>& tops, const std::vector<double>& speeds, int threads);

/// By quasi_static_thresholds.
std::vector<double> slow_speeds(const Scene& scene);

/// Fills in what a row tells of shares by quasi_static_thresholds.
void tell_slow(const SlowShares& shares, SeriesRow& row);

}  // namespace hourglass
