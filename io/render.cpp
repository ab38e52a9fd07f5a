#include "io/render.hpp"

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>

#include <algorithm>
#include <cmath>

#include "io/offscreen.hpp"
#include "io/render_field.hpp"
#include "io/render_layout.hpp"

namespace hourglass {
namespace {

constexpr Colour grey{150, 150, 150};

class Painting : public vtkContextItem {
 public:
  static Painting* New();
  vtkTypeMacro(Painting, vtkContextItem);

  const Picture* picture = nullptr;
  const ColourScale* scale = nullptr;
  const Layout* layout = nullptr;

  bool Paint(vtkContext2D* context) override {
    paint_field(context);
    paint_walls(context);
    paint_axes(context);
    paint_bar(context);
    paint_header(context);
    return true;
  }

 private:
  static void pen(vtkContext2D* context, const Colour& colour, double width, int type = vtkPen::SOLID_LINE) {
    context->GetPen()->SetColor(colour[0], colour[1], colour[2]);
    context->GetPen()->SetWidth(static_cast<float>(width));
    context->GetPen()->SetLineType(type);
  }
  static void rectangle(vtkContext2D* context, const Colour& colour, double x, double y, double w, double h) {
    pen(context, colour, 0, vtkPen::NO_PEN);
    context->GetBrush()->SetColor(colour[0], colour[1], colour[2]);
    context->DrawRect(float(x), float(y), float(w), float(h));
  }
  /// Reading upwards, its middle at height y, its left edge at x.
  static void upright(vtkContext2D* context, const std::string& what, int x, int y) {
    const auto image = upright_text(what, label_font);
    const int half = image->GetDimensions()[1] / 2;
    context->DrawImage(float(x), float(y - half), image);
  }

  void paint_field(vtkContext2D* context) const {
    const Layout& l = *layout;
    context->DrawImage(float(l.x), float(l.y), field_image(*picture, *scale, l));
  }

  bool open_at(Side side, bool at_end) const {
    const Patch& p = picture->values.patch();
    const bool upright_side = side == Side::left || side == Side::right;
    const double begin = upright_side ? p.y0 : p.x0, end = begin + (upright_side ? p.ny : p.nx) * p.h;
    for (const Opening& o : picture->openings) {
      if (o.side == side && (at_end ? o.end >= end - 0.5 * p.h : o.begin <= begin + 0.5 * p.h)) return true;
    }
    return false;
  }

  void paint_walls(vtkContext2D* context) const {
    const Layout& l = *layout;
    const Patch& p = picture->values.patch();
    rectangle(context, dark, l.x - wall, l.y, wall, l.h);
    rectangle(context, dark, l.x + l.w, l.y, wall, l.h);
    rectangle(context, dark, l.x, l.y - wall, l.w, wall);
    rectangle(context, dark, l.x, l.y + l.h, l.w, wall);
    for (const bool right : {false, true}) {
      for (const bool top : {false, true}) {
        if (open_at(right ? Side::right : Side::left, top) && open_at(top ? Side::top : Side::bottom, right))
          continue;
        rectangle(context, dark, right ? l.x + l.w : l.x - wall, top ? l.y + l.h : l.y - wall, wall, wall);
      }
    }
    for (const Opening& o : picture->openings) {
      const bool upright_side = o.side == Side::left || o.side == Side::right;
      const double origin = upright_side ? p.y0 : p.x0, base = upright_side ? l.y : l.x;
      const double length = (upright_side ? p.ny : p.nx) * p.h, extent = upright_side ? l.h : l.w;
      const auto pixel = [&](double along) {
        return base + std::round(extent * std::clamp((along - origin) / length, 0.0, 1.0));
      };
      const double begin = pixel(o.begin), end = pixel(o.end);
      const double at[] = {double(l.x - wall), double(l.x + l.w), double(l.y - wall),
                           double(l.y + l.h)};  // by Side
      const double across = at[static_cast<int>(o.side)];
      if (upright_side) {
        rectangle(context, white, across, begin, wall, end - begin);
        pen(context, grey, 2, vtkPen::DASH_LINE);
        context->DrawLine(float(across + wall / 2.0), float(begin), float(across + wall / 2.0), float(end));
      } else {
        rectangle(context, white, begin, across, end - begin, wall);
        pen(context, grey, 2, vtkPen::DASH_LINE);
        context->DrawLine(float(begin), float(across + wall / 2.0), float(end), float(across + wall / 2.0));
      }
    }
  }

  void paint_axes(vtkContext2D* context) const {
    const Layout& l = *layout;
    const Patch& p = picture->values.patch();
    const int foot = l.y - wall, side = l.x - wall;
    pen(context, dark, 2);
    for (const Tick& t : l.x_ticks) {
      const double x = l.x + (t.value - p.x0) / p.h * l.cell;
      context->DrawLine(float(x), float(foot), float(x), float(foot - tick));
      draw_text(context, t.label, x, foot - tick - gap, tick_font, Align::middle, Align::end);
    }
    for (const Tick& t : l.y_ticks) {
      const double y = l.y + (t.value - p.y0) / p.h * l.cell;
      context->DrawLine(float(side), float(y), float(side - tick), float(y));
      draw_text(context, t.label, side - tick - gap, y, tick_font, Align::end, Align::middle);
    }
    draw_text(context, fmt::format("{} [{}]", picture->axial ? "r" : "x", picture->length_unit),
              l.x + l.w / 2.0, foot - tick - 2 * gap - tick_font, label_font, Align::middle, Align::end);
    upright(context, fmt::format("y [{}]", picture->length_unit), margin, l.y + l.h / 2);
  }

  /// The pointed end of the colour bar says that values go on beyond it; x, y: the middle of its foot.
  void point(vtkContext2D* context, const Colour& colour, double x, double y, int direction) const {
    const double half = bar_width / 2.0, tip = direction * 0.7 * bar_width;
    float corners[] = {float(x - half), float(y), float(x + half), float(y), float(x), float(y + tip)};
    if (layout->bar_below) {
      const float lying[] = {float(x), float(y - half), float(x), float(y + half), float(x + tip), float(y)};
      std::copy(lying, lying + 6, corners);
    }
    pen(context, colour, 0, vtkPen::NO_PEN);
    context->GetBrush()->SetColor(colour[0], colour[1], colour[2]);
    context->DrawPolygon(corners, 3);
    pen(context, dark, 2);
    float outline[] = {corners[0], corners[1], corners[4], corners[5], corners[2], corners[3]};
    context->DrawPoly(outline, 3);
  }

  void paint_bar(vtkContext2D* context) const {
    const Layout& l = *layout;
    const int x = l.bar_x, y = l.bar_y, w = l.bar_w, h = l.bar_h;
    const vtkNew<vtkImageData> ramp = image_of(w, h, [&](unsigned char* pixel, int a, int b) {
      set(pixel, scale->colour_at(l.bar_below ? (a + 0.5) / w : (b + 0.5) / h));
    });
    context->DrawImage(float(x), float(y), ramp);
    if (l.under)
      point(context, scale->colour_at(0), l.bar_below ? x : x + w / 2.0, l.bar_below ? y + h / 2.0 : y, -1);
    if (l.over)
      point(context, scale->colour_at(1), x + (l.bar_below ? w : w / 2.0), y + (l.bar_below ? h / 2.0 : h),
            1);
    pen(context, dark, 2);
    float outline[] = {float(x),     float(y), float(x + w), float(y), float(x + w),
                       float(y + h), float(x), float(y + h), float(x), float(y)};
    context->DrawPoly(outline, 5);
    for (const Tick& t : l.bar_ticks) {
      const double s = scale->position(t.value), length = t.label.empty() ? tick / 2.0 : tick;
      if (l.bar_below) {
        context->DrawLine(float(x + s * w), float(y), float(x + s * w), float(y - length));
        draw_text(context, t.label, x + s * w, y - tick - gap, tick_font, Align::middle, Align::end);
      } else {
        context->DrawLine(float(x + w), float(y + s * h), float(x + w + length), float(y + s * h));
        draw_text(context, t.label, x + w + tick + gap, y + s * h, tick_font, Align::begin, Align::middle);
      }
    }
    if (l.bar_below) {
      draw_text(context, l.bar_title, l.x + l.w / 2.0, y - tick - 2 * gap - tick_font, label_font,
                Align::middle, Align::end);
    } else {
      upright(context, l.bar_title, x + w + tick + 3 * gap + widest(l.bar_ticks), l.y + l.h / 2);
    }
  }

  void paint_header(vtkContext2D* context) const {
    for (const Note& note : layout->notes) {
      const int shift = note.key ? key_width + gap : 0;
      if (note.key)
        context->DrawImage(float(note.x), float(note.y), key_image(*note.key, key_width, tick_font));
      draw_text(context, note.text, note.x + shift, note.y, note.size, Align::begin, Align::begin);
    }
  }
};
vtkStandardNewMacro(Painting);

ColourScale scale_of(const Picture& picture) {
  if (picture.range) return {*picture.range, picture.log_scale, picture.colours};
  const auto [lo, hi] = shown_extremes(picture);
  return {nice_range(lo, hi, picture.log_scale), picture.log_scale, picture.colours};
}

/// What draws the picture, and its size in pixels.
template <class Draw>
auto painted(const Picture& picture, Draw&& draw) {
  const ColourScale scale = scale_of(picture);
  const Layout layout = layout_of(picture, scale);
  vtkNew<Painting> painting;
  painting->picture = &picture;
  painting->scale = &scale;
  painting->layout = &layout;
  return draw(*painting, layout.width, layout.height);
}

}  // namespace

std::array<double, 2> shown_extremes(const Picture& picture) {
  std::vector<double> shown = shown_values(picture);
  if (picture.log_scale) std::erase_if(shown, [](double value) { return value <= 0; });
  if (shown.empty()) return {HUGE_VAL, -HUGE_VAL};
  const auto cut = static_cast<std::ptrdiff_t>(picture.tails * static_cast<double>(shown.size()));
  const auto value_at = [&](std::ptrdiff_t rank) {
    std::nth_element(shown.begin(), shown.begin() + rank, shown.end());
    return shown[rank];
  };
  return {value_at(cut), value_at(std::ssize(shown) - 1 - cut)};
}

std::array<int, 2> size_of(const Picture& picture) {
  const Layout layout = layout_of(picture, scale_of(picture));
  return {layout.width, layout.height};
}

void render_png(const Picture& picture, const std::filesystem::path& path) {
  painted(picture, [&](Painting& painting, int width, int height) {
    draw_png(painting, width, height, path, Edges::crisp);
  });
}

std::string png_of(const Picture& picture, int halved) {
  return painted(picture, [&](Painting& painting, int width, int height) {
    return png_of(painting, width, height, Edges::crisp, halved);
  });
}

}  // namespace hourglass
