#pragma once
// Picture of what modules cost.
#include <filesystem>
#include <string>
#include <vector>

namespace hourglass::perf {

struct ModulePrice {
  std::string name;
  double bytes;                 ///< more a cell
  std::vector<double> percent;  ///< more time a step, by grid
};

/// Bars of time, one a grid; bytes at the right. Throws what draw_png does.
void draw_prices(const std::vector<ModulePrice>& prices, const std::vector<int>& grids,
                 const std::filesystem::path& path);

}  // namespace hourglass::perf
