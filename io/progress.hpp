#pragma once
// How far long work has come: on a terminal one live line, elsewhere a plain line at every 5 %.
#include <chrono>
#include <cstdio>
#include <string>

namespace hourglass {

class Progress {
 public:
  /// Writes to `out`; quiet writes nothing.
  explicit Progress(bool quiet, std::FILE* out = stdout);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Is it time for a new line? Cheap: ask before composing `text`.
  bool due(double fraction_done) const;
  /// Shows "<per cent> <text> <time left>".
  void show(double fraction_done, const std::string& text);
  /// A line of its own that does not tear the live one.
  void say(const std::string& line);
  /// Leaves the live line standing; later calls of show() begin a new one.
  void end();

 private:
  /// A reader that has gone, or a full device, is no reason to end the work.
  void put(const std::string& text);

  using Clock = std::chrono::steady_clock;
  std::FILE* out_;
  bool quiet_, live_;
  bool on_line_ = false;  ///< the cursor stands behind a live line
  double begun_ = -1;     ///< the fraction shown first: work that goes on begins with more than 0
  int marks_ = 0;         ///< steps of 5 % shown so far, plus one
  Clock::time_point start_ = Clock::now(), shown_{};
};

/// A line on standard error. Where it cannot be written the work goes on, and the exit status says what happened.
void tell(const std::string& line) noexcept;

/// 4.2 s, 42 s, 3 min 20 s, 5 h 07 min, 2 d 4 h.
std::string duration_text(double seconds);

}  // namespace hourglass
