#pragma once
// The parts of check(), and what they share.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "solver/range.hpp"
#include "solver/scene.hpp"

namespace hourglass {

inline constexpr double edge_tolerance = 1e-6;  // in cells: what still counts as whole

class Problems {
 public:
  void error(std::string path, std::string message) {
    list.push_back({std::move(path), std::move(message), true});
  }
  void warn(std::string path, std::string message) {
    list.push_back({std::move(path), std::move(message), false});
  }
  /// A number that must be finite and `ok`; says whether it is.
  bool require(bool ok, const std::string& path, double value, std::string_view allowed,
               std::string_view cure = "") {
    if (ok && std::isfinite(value)) return true;
    error(path,
          fmt::format("{} is out of range (must be {}).{}{}", value, allowed, cure.empty() ? "" : " ", cure));
    return false;
  }
  bool require(const Range& range, const std::string& path, double value, std::string_view cure = "") {
    return require(range.holds(value), path, value, range.words(), cure);
  }

  /// Whether nothing at this path or below it is wrong so far; of the whole scene for none.
  bool is_sound(const std::string& path) const {
    return std::none_of(list.begin(), list.end(), [&](const Problem& p) {
      return p.fatal && (path.empty() || p.path == path || p.path.starts_with(path + "."));
    });
  }

  std::vector<Problem> list;
};

/// Whether this many cells across give a whole number of rows and enough levels of multigrid.
bool suits(const Scene& scene, int cells_x);

/// "cells_x >= 256", for which `size` is at least so many cells; `or_else` if that would be too many.
std::string cells_for(const Scene& scene, double size, double cells, const char* or_else);

/// The material that the fills paint at a point; -1: air. With a start grains may be anywhere.
int painted(const Scene& scene, double x, double y);

/// Whether a side is open and gravity does not keep grains from leaving over it.
bool leaves_over(const Scene& scene, Side side);

/// Numbers by themselves, each against the range of its key. Call first: other checks ask what is sound.
void check_ranges(const Scene& scene, Problems& problems);

/// Walls, the middle of the domain, orifices. `domain_sound`: there is a grid.
void check_openings(const Scene& scene, bool domain_sound, Problems& problems);

/// Inserts, the hopper, and the ways that they leave. Call after the fills and the openings.
void check_solids(const Scene& scene, bool domain_sound, Problems& problems);

/// What a model in closed form cannot honour or does not use, and its parameters. Call last.
void check_model(const Scene& scene, Problems& problems);

}  // namespace hourglass
