#pragma once
// Named stage timers; the order of first use is the order of the report.
#include <chrono>
#include <string>
#include <utility>
#include <vector>

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
  const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
};

}  // namespace hourglass
