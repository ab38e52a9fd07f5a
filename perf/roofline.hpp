#pragma once
// The roofline (Williams, Waterman & Patterson 2009) in the units of this solver: cells a second over bytes a
// cell, so that a bandwidth is a straight line and no operation need be counted.
#include <filesystem>
#include <string>
#include <vector>

#include "perf/harness.hpp"

namespace hourglass::perf {

/// What the triad gives.
struct Ceiling {
  std::string where;
  int threads;
  double gigabytes;  ///< a second; 0: not measured
};

/// One thread: each kernel at its smallest and largest grid, with its plain twin below.
void draw_roofline(const std::vector<Ceiling>& ceilings, const std::vector<Result>& results,
                   const std::filesystem::path& path);

}  // namespace hourglass::perf
