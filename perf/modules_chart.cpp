#include "perf/modules_chart.hpp"

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "io/offscreen.hpp"
#include "io/scales.hpp"

namespace hourglass::perf {
namespace {

constexpr int width = 1500, left = 470, right = 1230, row = 84, foot = 110, head = 90, font = 27;
using Colour = std::array<unsigned char, 3>;

class Chart : public vtkContextItem {
 public:
  static Chart* New();
  vtkTypeMacro(Chart, vtkContextItem);

  std::vector<ModulePrice> prices;
  std::vector<int> grids;
  int height = 0;
  double least = 0, most = 100;

  bool Paint(vtkContext2D* context) override {
    c_ = context;
    const ColourScale scale({0, 1}, false, ColourMap::viridis);
    const double bottom = foot, top = height - head;
    const double step = most - least > 300 ? 100 : most - least > 120 ? 50 : 20;
    for (double tick = std::ceil(least / step) * step + 0.0; tick <= most; tick += step) {
      line(x(tick), bottom, x(tick), top, tick == 0 ? 40 : 225);
      text(fmt::format("{:.0f}", tick), x(tick), bottom - 12, 1, 2);
    }
    text("more time a step, %", (left + right) / 2.0, 18, 1, 0);
    text("more bytes a cell", width - 20, top + 22, 2, 0);
    for (std::size_t g = 0; g < grids.size(); ++g) {
      const double at = left + 260.0 * static_cast<double>(g);
      fill(colour(scale, g), at, top + 24, 34, 24);
      text(fmt::format("{}²", grids[g]), at + 46, top + 36, 0, 1);
    }
    const double thick = (row - 24.0) / static_cast<double>(grids.size());
    for (std::size_t k = 0; k < prices.size(); ++k) {
      const double middle = top - row * (static_cast<double>(k) + 0.5);
      text(prices[k].name, left - 24, middle, 2, 1);
      text(fmt::format("{:.0f}", prices[k].bytes), width - 20, middle, 2, 1);
      for (std::size_t g = 0; g < grids.size(); ++g) {
        const double value = std::clamp(prices[k].percent[g], least, most);
        const double low =
            middle + thick * (static_cast<double>(grids.size()) / 2 - static_cast<double>(g) - 1);
        fill(colour(scale, g), std::min(x(0), x(value)), low, std::abs(x(value) - x(0)) + 1, thick - 2);
      }
    }
    return true;
  }

 private:
  double x(double percent) const { return left + (right - left) * (percent - least) / (most - least); }
  Colour colour(const ColourScale& scale, std::size_t grid) const {
    const auto c = scale.colour_at(0.2 + 0.5 * static_cast<double>(grid) /
                                             std::max<double>(1, static_cast<double>(grids.size()) - 1));
    return {c[0], c[1], c[2]};
  }
  void line(double x0, double y0, double x1, double y1, int grey) {
    c_->GetPen()->SetColor(static_cast<unsigned char>(grey), static_cast<unsigned char>(grey),
                           static_cast<unsigned char>(grey));
    c_->GetPen()->SetWidth(2);
    c_->GetPen()->SetLineType(vtkPen::SOLID_LINE);
    c_->DrawLine(float(x0), float(y0), float(x1), float(y1));
  }
  void fill(const Colour& colour, double at_x, double at_y, double wide, double high) {
    c_->GetPen()->SetLineType(vtkPen::NO_PEN);
    c_->GetBrush()->SetColor(colour[0], colour[1], colour[2]);
    c_->DrawRect(float(at_x), float(at_y), float(wide), float(high));
  }
  /// across, up: 0 begins at the place, 1 is centred, 2 ends there.
  void text(const std::string& what, double at_x, double at_y, int across, int up) {
    vtkNew<vtkTextProperty> property;
    style_text(property, font);
    property->SetJustification(across);
    property->SetVerticalJustification(up);
    c_->ApplyTextProp(property);
    c_->DrawString(float(std::lround(at_x)), float(std::lround(at_y)), what);
  }

  vtkContext2D* c_ = nullptr;
};
vtkStandardNewMacro(Chart);

}  // namespace

void draw_prices(const std::vector<ModulePrice>& prices, const std::vector<int>& grids,
                 const std::filesystem::path& path) {
  vtkNew<Chart> chart;
  chart->prices = prices;
  chart->grids = grids;
  chart->height = foot + head + row * static_cast<int>(prices.size());
  for (const ModulePrice& p : prices)
    for (double percent : p.percent) {
      chart->most = std::max(chart->most, 1.05 * percent);
      chart->least = std::min(chart->least, 1.05 * percent);
    }
  draw_png(*chart, width, chart->height, path);
}

}  // namespace hourglass::perf
