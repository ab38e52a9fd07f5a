#pragma once
// Named stage timers; the order of first use is the order of the report.
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "solver/archive.hpp"

namespace hourglass {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class Timers {
 public:
  /// Runs f and adds its time to the stage.
  template <class F>
  void time(const char* stage, F&& f) {
    const auto start = Clock::now();
    f();
    add(stage, seconds_since(start));
  }
  void add(const char* stage, double seconds) {
    for (auto& [name, total] : stages_)
      if (name == stage) {
        total += seconds;
        return;
      }
    stages_.emplace_back(stage, seconds);
  }
  void walk(Archive& archive) {
    std::vector<std::string> names;
    std::vector<double> seconds;
    for (const auto& [name, total] : stages_) {
      names.push_back(name);
      seconds.push_back(total);
    }
    archive.texts("stages", names);
    archive.numbers("stage_seconds", seconds);
    stages_.clear();
    for (std::size_t k = 0; k < std::min(names.size(), seconds.size()); ++k)
      stages_.emplace_back(names[k], seconds[k]);
  }
  const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
};

}  // namespace hourglass
