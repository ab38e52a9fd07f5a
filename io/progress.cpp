#include "io/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

constexpr int mark_percent = 5;
constexpr std::chrono::milliseconds refresh{200};

int marks_passed(double fraction_done) {
  return static_cast<int>(fraction_done * 100 / mark_percent + 1e-9) + 1;
}

int columns_of(std::FILE* out) {
  winsize size{};
  return ::ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

void tell(const std::string& line) noexcept { std::fprintf(stderr, "%s\n", line.c_str()); }

std::string duration_text(double seconds) {
  if (!(seconds >= 0 && seconds < 1e9)) return "?";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  if (s < 86400) return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
  return fmt::format("{} d {} h", s / 86400, s / 3600 % 24);
}

Progress::Progress(bool quiet, std::FILE* out) : out_(out), quiet_(quiet), live_(::isatty(fileno(out))) {}

Progress::~Progress() { end(); }

bool Progress::due(double fraction_done) const {
  if (quiet_) return false;
  if (live_) return fraction_done >= 1 || Clock::now() - shown_ >= refresh;
  return marks_passed(fraction_done) > marks_;
}

void Progress::show(double fraction_done, const std::string& text) {
  if (quiet_) return;
  shown_ = Clock::now();
  marks_ = std::max(marks_, marks_passed(fraction_done));
  if (begun_ < 0) begun_ = fraction_done;
  const double elapsed = std::chrono::duration<double>(shown_ - start_).count();
  std::string line = fmt::format("{:3.0f} %  {}", std::floor(100 * fraction_done + 1e-9), text);
  if (fraction_done > begun_ && fraction_done < 1) {
    line += fmt::format("  {} left", duration_text(elapsed * (1 - fraction_done) / (fraction_done - begun_)));
  }
  if (live_) {
    line.resize(
        std::min<std::size_t>(line.size(), columns_of(out_) - 1));  // a wrapped line would not be overwritten
    put(fmt::format("\r{}\x1b[K", line));
    on_line_ = true;
  } else {
    put(line + '\n');
  }
}

void Progress::say(const std::string& line) {
  if (quiet_) return;
  end();
  put(line + '\n');
}

void Progress::end() {
  if (!on_line_) return;
  on_line_ = false;
  put("\n");
}

void Progress::put(const std::string& text) {
  std::fputs(text.c_str(), out_);
  std::fflush(out_);
}

}  // namespace hourglass
