#include "io/canvas.hpp"

#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include <algorithm>
#include <cmath>

#include "io/raster.hpp"

namespace hourglass {
namespace {

Polygon moved(Polygon points, double x, double y) {
  for (auto& p : points) p = {p[0] - x, p[1] - y};
  return points;
}

/// The pieces of a line that dashes show.
std::vector<Polygon> dashes_of(const Polygon& points, double dash, double space) {
  std::vector<Polygon> pieces;
  bool shown = true;
  double left = dash;
  Polygon piece{points.front()};
  for (std::size_t k = 1; k < points.size(); ++k) {
    auto from = points[k - 1];
    for (double length; (length = std::hypot(points[k][0] - from[0], points[k][1] - from[1])) > left;) {
      from = {from[0] + left / length * (points[k][0] - from[0]),
              from[1] + left / length * (points[k][1] - from[1])};
      piece.push_back(from);
      if (shown) pieces.push_back(piece);
      shown = !shown;
      left = shown ? dash : space;
      piece = {from};
    }
    left -= std::hypot(points[k][0] - from[0], points[k][1] - from[1]);
    piece.push_back(points[k]);
  }
  if (shown) pieces.push_back(piece);
  return pieces;
}

}  // namespace

class CanvasItem : public vtkContextItem {
 public:
  static CanvasItem* New();
  vtkTypeMacro(CanvasItem, vtkContextItem);

  const Canvas* canvas = nullptr;

  bool Paint(vtkContext2D* context) override {
    vtkNew<vtkImageData> image;
    image->SetDimensions(canvas->width_, canvas->height_, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* to = static_cast<unsigned char*>(image->GetScalarPointer());
    for (const Colour& colour : canvas->pixels_) to = std::copy(colour.begin(), colour.end(), to);
    context->DrawImage(0, 0, image);
    for (const Canvas::Text& t : canvas->texts_) {
      if (t.what.empty()) continue;
      if (!t.upright) {
        draw_text(context, t.what, t.x, t.y, t.size, t.across, t.up);
        continue;
      }
      const auto turned = upright_text(t.what, t.size);
      const int half = turned->GetDimensions()[1] / 2;
      context->DrawImage(float(std::lround(t.x)), float(std::lround(t.y) - half), turned);
    }
    return true;
  }
};
vtkStandardNewMacro(CanvasItem);

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), pixels_(std::size_t(width) * height, blank) {
  unclip();
}

Canvas::Box Canvas::box_of(const Polygon& points, double reach) const {
  const auto bounds = [&](int axis, double from, double extent) {
    const auto [lo, hi] = std::minmax_element(
        points.begin(), points.end(), [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    const auto within = [&](double at) { return static_cast<int>(std::clamp(at, from, from + extent)); };
    return std::array{within(std::floor((*lo)[axis] - reach)), within(std::ceil((*hi)[axis] + reach))};
  };
  const auto [x0, x1] = bounds(0, clip_.x, clip_.w);
  const auto [y0, y1] = bounds(1, clip_.y, clip_.h);
  return {x0, y0, x1 - x0, y1 - y0};
}

template <class Share>
void Canvas::paint(int x, int y, int w, int h, const Colour& colour, Share&& share) {
  for (int b = 0; b < h; ++b)
    for (int a = 0; a < w; ++a) {
      const double s = share(a, b);
      Colour& pixel = pixels_[std::size_t(y + b) * width_ + x + a];
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<unsigned char>(std::lround((1 - s) * pixel[c] + s * colour[c]));
    }
}

void Canvas::line(const Polygon& points, const Colour& colour, double thickness, bool dashed) {
  if (points.empty()) return;
  const auto [x, y, w, h] = box_of(points, thickness);
  if (w <= 0 || h <= 0) return;
  Strokes strokes(w, h);
  const Polygon shifted = moved(points, x, y);
  if (dashed)
    for (const Polygon& piece : dashes_of(shifted, 4.5 * thickness, 3 * thickness))
      strokes.add(piece, thickness);
  else
    strokes.add(shifted, thickness);
  paint(x, y, w, h, colour, strokes);
}

void Canvas::area(const Polygon& outline, const Colour& colour, double opacity) {
  if (outline.empty()) return;
  const auto [x, y, w, h] = box_of(outline, 1);
  if (w <= 0 || h <= 0) return;
  Cover cover(w, h);
  cover.add(moved(outline, x, y));
  paint(x, y, w, h, colour, [&](int a, int b) { return opacity * cover(a, b); });
}

void Canvas::area(const Rectangle& r, const Colour& colour, double opacity) {
  area(Polygon{{r.x, r.y}, {r.x + r.w, r.y}, {r.x + r.w, r.y + r.h}, {r.x, r.y + r.h}}, colour, opacity);
}

void Canvas::write(const std::filesystem::path& path) const {
  vtkNew<CanvasItem> item;
  item->canvas = this;
  draw_png(*item, width_, height_, path, Edges::crisp);
}

}  // namespace hourglass
