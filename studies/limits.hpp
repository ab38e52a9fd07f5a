#pragma once
// Where a scene's flow is well posed, and what a cure does to that: growth of short waves (studies/shear_probe.hpp) over the
// planes (mu_s, delta_mu) and (I_0, eta_max) about the scene's first material.
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/shear_probe.hpp"

namespace hourglass {

/// What may hold the growth.
struct Cure {
  std::string name;  ///< in tables and pictures
  std::function<void(ShearProbe&)> apply;
};
/// The first does nothing; none has the scene's own.
const std::vector<Cure>& cures();

/// The friction sets of the reference thesis, all with I_0 = 0.6.
struct FrictionSet {
  const char* name;
  double mu_s, delta_mu;
};
inline constexpr std::array<FrictionSet, 3> thesis_sets{
    {{"low", 0.47, 0.38}, {"medium", 0.62, 0.48}, {"high", 0.77, 0.58}}};

/// A probe of the scene as it stands, less its cures: waves as long as four of its cells, on a finer grid, P of the middle of its height, at I. Waves are
/// taken shorter at larger I, where the flow would turn them before they grow. Throws std::invalid_argument for a scene
/// without friction.
ShearProbe bare_probe(const Scene& scene, double I);

/// The mu_s at which C(I) = 0, of grains with this delta_mu and I_0; nullopt if there is none in (0, 3).
std::optional<double> analytic_border(double delta_mu, double I_0, double I);

/// A value of x where y(x), given at rising x, passes 0 upwards for the first time, by a line between neighbours; points
/// that are not finite are left out.
std::optional<double> first_crossing(const std::vector<double>& x, const std::vector<double>& y);

struct LimitsOptions {
  std::filesystem::path out;
  bool quick = false;  ///< a coarse map
};

/// Measures what is not yet in the folder's table limits_growth.csv, draws growth_slow.png, growth_fast.png, cap.png and
/// borders.png, writes limits_cures.csv and prints it. The scene must be free of fatal problems. Throws
/// std::invalid_argument where the scene has no friction or the folder another table, std::runtime_error for the disk.
void measure_limits(const Scene& scene, const LimitsOptions& options);

}  // namespace hourglass
