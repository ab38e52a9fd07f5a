#pragma once
// The levers that a trade pulls, as data: adding a line to the table adds a lever.
#include <optional>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

/// One way to run a scene.
struct Variant {
  std::string lever;              ///< key that it sets; empty: none
  std::vector<std::string> sets;  ///< path=value, as of --set
  bool halved = false;            ///< the right half of a scene that is its own mirror image
  bool model = false;             ///< changes what is modelled: measured, but not combined or recommended

  /// What it sets, with blanks between: its name in runs.csv.
  std::string name() const;
};

/// All settings of all levers that apply to the scene, but for those that it has already.
std::vector<Variant> one_lever_variants(const Scene& balanced);

/// The right half, if the scene is its own mirror image, so that nothing but the grid's rounding tells them apart.
std::optional<Scene> halved(const Scene& scene);

}  // namespace hourglass
