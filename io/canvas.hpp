#pragma once
// A picture under way, in pixels from the lower left corner: lines and areas with smooth edges, and text on top. For charts;
// pictures of fields paint their own (io/render).
#include <filesystem>
#include <string>
#include <vector>

#include "io/offscreen.hpp"
#include "io/scales.hpp"
#include "kernels/polygon.hpp"

namespace hourglass {

inline constexpr Colour ink{40, 40, 40}, faint{225, 225, 225}, blank{255, 255, 255};

struct Rectangle {
  double x = 0, y = 0, w = 0, h = 0;
  bool holds(double at_x, double at_y) const {
    return at_x >= x && at_x <= x + w && at_y >= y && at_y <= y + h;
  }
};

class Canvas {
 public:
  Canvas(int width, int height);  ///< white

  /// What lines and areas are painted on from here on: the whole canvas at first.
  void clip(const Rectangle& to) { clip_ = to; }
  void unclip() { clip_ = {0, 0, double(width_), double(height_)}; }

  void line(const Polygon& points, const Colour& colour, double thickness = 2, bool dashed = false);
  void area(const Polygon& outline, const Colour& colour, double opacity = 1);
  void area(const Rectangle& r, const Colour& colour, double opacity = 1);
  void disc(double x, double y, double diameter, const Colour& colour) {
    line({{x, y}, {x, y}}, colour, diameter);
  }
  /// A pixel; not clipped, must be on the canvas.
  void set(int a, int b, const Colour& colour) { pixels_[std::size_t(b) * width_ + a] = colour; }

  void text(const std::string& what, double x, double y, Align across = Align::begin, Align up = Align::begin,
            int size = tick_font) {
    texts_.push_back({what, x, y, across, up, size, false});
  }
  /// Reads upwards, its middle at height y, its left edge at x.
  void upright(const std::string& what, double x, double y, int size = label_font) {
    texts_.push_back({what, x, y, Align::begin, Align::middle, size, true});
  }

  /// Throws what draw_png does.
  void write(const std::filesystem::path& path) const;

 private:
  friend class CanvasItem;
  struct Text {
    std::string what;
    double x, y;
    Align across, up;
    int size;
    bool upright;
  };
  /// Paints share(a, b) of the pixels of a box of w x h at (x, y).
  template <class Share>
  void paint(int x, int y, int w, int h, const Colour& colour, Share&& share);
  struct Box {
    int x, y, w, h;
  };
  /// The pixels of the clip that lie as near as `reach` to the points.
  Box box_of(const Polygon& points, double reach) const;

  int width_, height_;
  Rectangle clip_;
  std::vector<Colour> pixels_;
  std::vector<Text> texts_;
};

}  // namespace hourglass
