#include "perf/roofline.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "io/canvas.hpp"

namespace hourglass::perf {
namespace {

// Pixels.
constexpr int width = 1860, height = 1150, left = 130, bottom = 110, right = 1210, top = 1050;
constexpr int column = 9, spacing = 40;  // of the two grids of a kernel; between kernels
constexpr int tick = 10;

class Chart {
 public:
  std::vector<Ceiling> ceilings;
  struct Kernel {
    std::string name;
    double bytes;
    std::vector<Result> at;  ///< the grids drawn
  };
  std::vector<Kernel> kernels;  ///< by rising bytes a cell
  int small = 0, large = 0;     ///< the grids drawn
  std::array<double, 2> x{4, 160}, y{5e6, 3e10};

  void draw(const std::filesystem::path& path) {
    const ColourScale scale({0, 1}, false, ColourMap::viridis);
    small_colour_ = scale.colour_at(0.2);
    large_colour_ = scale.colour_at(0.7);
    paint_axes();
    for (const Ceiling& ceiling : ceilings) paint_ceiling(ceiling);
    paint_kernels();
    paint_key();
    canvas_.write(path);
  }

 private:
  static double along(double value, std::array<double, 2> range, int from, int to) {
    return from + (to - from) * std::log(value / range[0]) / std::log(range[1] / range[0]);
  }
  double px(double bytes) const { return along(bytes, x, left, right); }
  double py(double rate) const { return along(rate, y, bottom, top); }

  void line(double x0, double y0, double x1, double y1, const Colour& colour, double thickness,
            bool dashed = false) {
    canvas_.line({{x0, y0}, {x1, y1}}, colour, thickness, dashed);
  }
  void dot(double at_x, double at_y, const Colour& colour, bool full) {
    canvas_.disc(at_x, at_y, 2 * column, colour);
    if (!full) canvas_.disc(at_x, at_y, 2 * column - 6, blank);
  }
  void text(const std::string& what, double at_x, double at_y, Align across, Align up) {
    canvas_.text(what, at_x, at_y, across, up);
  }

  void paint_axes() {
    for (const double bytes : {5, 10, 20, 50, 100}) {
      line(px(bytes), bottom, px(bytes), top, faint, 2);
      line(px(bytes), bottom, px(bytes), bottom - tick, ink, 2);
      text(number_text(bytes), px(bytes), bottom - 2 * tick, Align::middle, Align::end);
    }
    for (const Tick& t : log_ticks(y[0], y[1])) {
      if (!t.label.empty()) line(left, py(t.value), right, py(t.value), faint, 2);
      line(left, py(t.value), left - (t.label.empty() ? tick / 2 : tick), py(t.value), ink, 2);
      text(t.label, left - 2 * tick, py(t.value), Align::end, Align::middle);
    }
    line(left, bottom, right, bottom, ink, 2);
    line(left, bottom, left, top, ink, 2);
    text("bytes a cell, counted", (left + right) / 2.0, 18, Align::middle, Align::begin);
    text("cell updates a second, one thread", left - 2 * tick, top + 40, Align::begin, Align::begin);
  }

  /// rate * bytes = gigabytes, where it is inside.
  void paint_ceiling(const Ceiling& ceiling) {
    const double flow = 1e9 * ceiling.gigabytes;
    const double from = std::max(x[0], flow / y[1]), to = std::min(x[1], flow / y[0]);
    if (from >= to) return;
    line(px(from), py(flow / from), px(to), py(flow / to),
         ceiling.where == "memory" ? large_colour_ : small_colour_, 4, dashes(ceiling));
  }
  void paint_sample(const Ceiling& ceiling, double at_x, double at_y) {
    line(at_x, at_y, at_x + 75, at_y, ceiling.where == "memory" ? large_colour_ : small_colour_, 4,
         dashes(ceiling));
  }
  static bool dashes(const Ceiling& c) { return c.threads > 1; }

  /// Where the kernels stand: at their bytes, but those that would overlap move apart.
  std::vector<double> places() const {
    std::vector<double> at;
    for (const Kernel& kernel : kernels) at.push_back(px(kernel.bytes));
    for (int round = 0; round < 1000; ++round)
      for (std::size_t k = 1; k < at.size(); ++k) {
        const double lacking = std::max(0.0, spacing - (at[k] - at[k - 1]));
        at[k - 1] -= lacking / 2;
        at[k] += lacking / 2;
      }
    return at;
  }

  void paint_kernels() {
    const std::vector<double> at_x = places();
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      double highest = bottom;
      for (const Result& r : kernels[k].at) {
        const bool is_small = r.n == small;
        const Colour& colour = is_small ? small_colour_ : large_colour_;
        const double at = at_x[k] + (is_small ? -column : column), fast = py(r.cells_per_second);
        if (r.plain_cells_per_second > 0) {
          line(at, fast, at, py(r.plain_cells_per_second), colour, 3);
          dot(at, py(r.plain_cells_per_second), colour, false);
        }
        dot(at, fast, colour, true);
        highest = std::max(highest, fast);
      }
      text(letter(k), at_x[k], highest + 14, Align::middle, Align::begin);
    }
  }
  static std::string letter(std::size_t k) { return {static_cast<char>('a' + k)}; }

  void paint_key() {
    double at = top - 10;
    const double x0 = right + 45, step = 42;
    const auto entry = [&](const std::string& what) {
      text(what, x0 + 90, at, Align::begin, Align::middle);
      at -= step;
    };
    for (const Ceiling& ceiling : ceilings) {
      paint_sample(ceiling, x0, at);
      entry(fmt::format("{}, {} thread{}: {} GB/s", ceiling.where, ceiling.threads,
                        ceiling.threads > 1 ? "s" : "", number_text(ceiling.gigabytes, 2)));
    }
    at -= step / 2;
    for (const int n : {small, large}) {
      dot(x0 + 35, at, n == small ? small_colour_ : large_colour_, true);
      entry(fmt::format("{}² cells", n));
    }
    dot(x0 + 35, at, ink, false);
    entry("plain twin, scalar");
    at -= step / 2;
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      text(letter(k), x0 + 35, at, Align::middle, Align::middle);
      entry(fmt::format("{}, {:g} B", kernels[k].name, kernels[k].bytes));
    }
  }

  Canvas canvas_{width, height};
  Colour small_colour_{}, large_colour_{};
};

}  // namespace

void draw_roofline(const std::vector<Ceiling>& ceilings, const std::vector<Result>& results,
                   const std::filesystem::path& path) {
  Chart chart;
  chart.ceilings = ceilings;
  for (const Result& r : results) {
    chart.small = chart.small == 0 ? r.n : std::min(chart.small, r.n);
    chart.large = std::max(chart.large, r.n);
  }
  for (const Result& r : results) {
    if (r.threads != 1 || (r.n != chart.small && r.n != chart.large)) continue;
    auto& kernels = chart.kernels;
    auto same = std::find_if(kernels.begin(), kernels.end(), [&](const auto& k) { return k.name == r.name; });
    if (same == kernels.end()) same = kernels.insert(same, {r.name, r.bytes, {}});
    same->at.push_back(r);
  }
  std::stable_sort(chart.kernels.begin(), chart.kernels.end(),
                   [](const auto& a, const auto& b) { return a.bytes < b.bytes; });
  chart.draw(path);
}

}  // namespace hourglass::perf
