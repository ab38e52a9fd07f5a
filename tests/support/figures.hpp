#pragma once
// Measured figures, for docs/verification.md: `HOURGLASS_FIGURES=1 ./verification` prints them.
#include <cstdio>
#include <cstdlib>

namespace hourglass {

inline bool figures_wanted() { return std::getenv("HOURGLASS_FIGURES") != nullptr; }

/// printf, when figures are asked for.
template <class... Args>
void figure(const char* format, Args... args) {
  if (!figures_wanted()) return;
  std::printf(format, args...);
  std::putchar('\n');
  std::fflush(stdout);
}

}  // namespace hourglass
