#include "perf/modules_chart.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "io/canvas.hpp"

namespace hourglass::perf {
namespace {

constexpr int width = 1500, left = 470, right = 1230, row = 84, foot = 110, head = 90;

}  // namespace

void draw_prices(const std::vector<ModulePrice>& prices, const std::vector<int>& grids,
                 const std::filesystem::path& path) {
  double least = 0, most = 100;
  for (const ModulePrice& p : prices)
    for (double percent : p.percent) {
      most = std::max(most, 1.05 * percent);
      least = std::min(least, 1.05 * percent);
    }
  const double bottom = foot, top = foot + row * static_cast<double>(prices.size());
  const auto x = [&](double percent) { return left + (right - left) * (percent - least) / (most - least); };
  const ColourScale scale({0, 1}, false, ColourMap::viridis);
  const double bars = static_cast<double>(grids.size());
  const auto colour = [&](std::size_t grid) {
    return scale.colour_at(0.2 + 0.5 * static_cast<double>(grid) / std::max(1.0, bars - 1));
  };

  Canvas canvas(width, static_cast<int>(top) + head);
  const double step = most - least > 300 ? 100 : most - least > 120 ? 50 : 20;
  for (double tick = std::ceil(least / step) * step + 0.0; tick <= most; tick += step) {
    canvas.line({{x(tick), bottom}, {x(tick), top}}, tick == 0 ? ink : faint);
    canvas.text(fmt::format("{:.0f}", tick), x(tick), bottom - 12, Align::middle, Align::end);
  }
  canvas.text("more time a step, %", (left + right) / 2.0, 18, Align::middle);
  canvas.text("more bytes a cell", width - 20, top + 22, Align::end);
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const double at = left + 260.0 * static_cast<double>(g);
    canvas.area(Rectangle{at, top + 24, 34, 24}, colour(g));
    canvas.text(fmt::format("{}²", grids[g]), at + 46, top + 36, Align::begin, Align::middle);
  }
  const double thick = (row - 24.0) / bars;
  for (std::size_t k = 0; k < prices.size(); ++k) {
    const double middle = top - row * (static_cast<double>(k) + 0.5);
    canvas.text(prices[k].name, left - 24, middle, Align::end, Align::middle);
    canvas.text(fmt::format("{:.0f}", prices[k].bytes), width - 20, middle, Align::end, Align::middle);
    for (std::size_t g = 0; g < grids.size(); ++g) {
      const double value = std::clamp(prices[k].percent[g], least, most);
      const double low = middle + thick * (bars / 2 - static_cast<double>(g) - 1);
      canvas.area(Rectangle{std::min(x(0), x(value)), low, std::abs(x(value) - x(0)) + 1, thick - 2},
                  colour(g));
    }
  }
  canvas.write(path);
}

}  // namespace hourglass::perf
