#pragma once
// The pictures of studies/limits.hpp.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

/// Growth per step over a plane, row by row; NaN where there is none.
struct GrowthMap {
  std::vector<double> at_x, at_y, growth;

  /// Points (x, y) of growth 0, one a row that has one.
  std::vector<std::array<double, 2>> border() const;
};

struct BorderCurve {
  std::string name;
  std::vector<std::array<double, 2>> points;  ///< (mu_s, delta_mu)
};

void draw_friction_map(const GrowthMap& map, double I_0, double I, const std::filesystem::path& path);
/// I_0 and eta_max about the scene's first material.
void draw_cap_map(const GrowthMap& map, const Scene& scene, double I, const std::filesystem::path& path);
void draw_borders(const std::vector<BorderCurve>& borders, double I_0, double I,
                  const std::filesystem::path& path);

}  // namespace hourglass
