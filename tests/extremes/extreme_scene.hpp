#pragma once
// Scenes at the edges of what may be asked for: a Latin hypercube over materials, modules, geometry, walls, fills, steps
// and levers. A number always gives the same scene.
#include <map>
#include <string>

#include "solver/scene.hpp"

namespace hourglass {

inline constexpr int extreme_scenes = 336;

struct ExtremeScene {
  Scene scene;
  std::map<std::string, std::string> drawn;  ///< what to know of it, for a table
};

/// number: 0 to extreme_scenes - 1.
ExtremeScene extreme_scene(int number);

/// The names in ExtremeScene::drawn, in the order of a table.
const std::vector<std::string>& drawn_names();

}  // namespace hourglass
