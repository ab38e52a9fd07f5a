#include "io/render_field.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "io/raster.hpp"

namespace hourglass {
namespace {

constexpr double streamline_decades = 4;
constexpr double solid_line = 2;  // pixels, around solids

constexpr Colour black{0, 0, 0}, air{238, 238, 238}, solid{178, 178, 178},
    sample{49, 104, 142};  // the ground of a legend's sign

/// Weights 1 2 1 both ways: without it the contour of volume fractions shows every cell.
CellField smoothed(const CellField& field) {
  CellField out(field.patch());
  const auto at = [&](int i, int j) {
    return field(std::clamp(i, 0, field.nx() - 1), std::clamp(j, 0, field.ny() - 1));
  };
  const auto row = [&](int i, int j) { return 0.25 * at(i - 1, j) + 0.5 * at(i, j) + 0.25 * at(i + 1, j); };
  for (int j = 0; j < field.ny(); ++j) {
    for (int i = 0; i < field.nx(); ++i)
      out(i, j) = 0.25 * row(i, j - 1) + 0.5 * row(i, j) + 0.25 * row(i, j + 1);
  }
  return out;
}

void blend(unsigned char* pixel, const Colour& colour, double share) {
  if (share == 0) return;
  for (int c = 0; c < 3; ++c) {
    pixel[c] = static_cast<unsigned char>(std::lround((1 - share) * pixel[c] + share * colour[c]));
  }
}

/// Signed distance from a contour in pixels, to first order; x, y in cells.
double contour_distance(const CellField& field, double level, double x, double y, double cell_pixels) {
  const int i = std::min(static_cast<int>(x), field.nx() - 1),
            j = std::min(static_cast<int>(y), field.ny() - 1);
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, field.ny() - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, field.nx() - 1); ++a) {
      lo = std::min(lo, field(a, b));
      hi = std::max(hi, field(a, b));
    }
  }
  if (lo > level) return 1e6;  // most of the picture
  if (hi < level) return -1e6;
  const double half = 0.5 / cell_pixels;
  const double slope = std::hypot(interpolate(field, x + half, y) - interpolate(field, x - half, y),
                                  interpolate(field, x, y + half) - interpolate(field, x, y - half));
  return (interpolate(field, x, y) - level) / std::max(slope, 1e-6);
}

/// Black on light colours, white on dark ones.
Colour ink_on(const unsigned char* colour) {
  return 0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2] > 102 ? black : white;
}

/// Drawn here, with smooth edges, rather than by OpenGL, where
/// smooth edges make a picture three times as dear.
void stamp(vtkImageData* image, const Arrow& arrow, double cell_pixels) {
  constexpr double half_shaft = 1.2, head_length = 13, head_slope = 0.36;
  int extent[3];
  image->GetDimensions(extent);
  const auto pixel_at = [&](double x, double y) {
    return static_cast<unsigned char*>(
        image->GetScalarPointer(std::clamp(static_cast<int>(x), 0, extent[0] - 1),
                                std::clamp(static_cast<int>(y), 0, extent[1] - 1), 0));
  };
  const double x = arrow.x * cell_pixels, y = arrow.y * cell_pixels;
  const double length = std::hypot(arrow.dx, arrow.dy) * cell_pixels;
  const double ex = arrow.dx * cell_pixels / length, ey = arrow.dy * cell_pixels / length;
  const double tip = length / 2, neck = tip - std::min(head_length, 0.7 * length), reach = tip + 2;
  const Colour colour = ink_on(pixel_at(x, y));
  for (int b = std::max(0, int(y - reach)); b <= std::min(extent[1] - 1, int(y + reach)); ++b) {
    for (int a = std::max(0, int(x - reach)); a <= std::min(extent[0] - 1, int(x + reach)); ++a) {
      const double dx = a + 0.5 - x, dy = b + 0.5 - y;
      const double along = dx * ex + dy * ey, across = std::abs(dy * ex - dx * ey);
      const double shaft =
          std::max({across - half_shaft, along - neck, -tip - along});  // distances in pixels
      const double head =
          std::max((across + head_slope * (along - tip)) / std::hypot(1, head_slope), neck - along);
      blend(pixel_at(a, b), colour, std::clamp(0.5 - std::min(shaft, head), 0.0, 1.0));
    }
  }
}

/// Share of a pixel that slanting lines cover.
double hatching(int a, int b) {
  constexpr int apart = 20;
  const double across = std::abs((a + b) % apart - apart / 2) / std::sqrt(2.0);
  return std::clamp(1.5 - across, 0.0, 1.0);
}

/// White with a dark rim: to be seen on every colour.
struct WhiteLine {
  static constexpr double width = 2, rim = 2;
  double core = 0, all = 0;  ///< shares of the pixel

  void paint(unsigned char* pixel) const {
    blend(pixel, black, 0.5 * all);
    blend(pixel, white, core);
  }
};

/// Marks grains that hardly move; distance: pixels to their edge, positive outside.
void mark_quasi_static(unsigned char* pixel, const Colour& ink, int a, int b, double distance) {
  const auto within = [&](double reach) { return std::clamp(reach + 0.5 - std::abs(distance), 0.0, 1.0); };
  blend(pixel, ink, 0.5 * std::clamp(0.5 - distance, 0.0, 1.0) * hatching(a, b));
  WhiteLine{within(0.75 * WhiteLine::width), within(0.75 * WhiteLine::width + WhiteLine::rim)}.paint(pixel);
}

/// log10 of speed over the threshold, cut off far from it.
CellField slowness_of(const Picture& picture, const Ground& ground) {
  CellField out(picture.values.patch());
  for (int j = 0; j < out.ny(); ++j) {
    for (int i = 0; i < out.nx(); ++i) {
      const double speed = std::hypot(ground.velocity_x(i, j), ground.velocity_y(i, j));
      out(i, j) = std::clamp(std::log10(speed / picture.slow_speed), -2.0, 2.0);
    }
  }
  return smoothed(out);
}

struct WhiteLines {
  Strokes core, all;

  WhiteLines(int w, int h) : core(w, h), all(w, h) {}
  void add(const Polygon& points) {
    core.add(points, WhiteLine::width);
    all.add(points, WhiteLine::width + 2 * WhiteLine::rim);
  }
  WhiteLine at(int a, int b) const { return {core(a, b), all(a, b)}; }
};

/// Streamlines with arrowheads, in pixels.
WhiteLines streamlines_of(const Picture& picture, const Ground& ground, const Layout& l) {
  constexpr double head = 11, slope = 0.42, heads_apart = 240;
  WhiteLines lines(l.w, l.h);
  const CellField& values = picture.values;
  StreamlineField field{double(values.nx()), double(values.ny()),
                        [&](const Point& p) { return ground.velocity(p[0], p[1]); },
                        [&](const Point& p) { return ground.flows(p[0], p[1]); }, 0};
  double fastest = 0;
  for (int j = 0; j < values.ny(); ++j) {
    for (int i = 0; i < values.nx(); ++i) {
      const double speed = std::hypot(ground.velocity_x(i, j), ground.velocity_y(i, j));
      if (ground.flows(i + 0.5, j + 0.5) && std::isfinite(speed)) fastest = std::max(fastest, speed);
    }
  }
  field.least_speed = fastest * std::pow(10.0, -streamline_decades);
  if (has(picture, Overlay::quasi_static))
    field.least_speed = std::max(field.least_speed, 2 * picture.slow_speed);  // clear of its edge
  for (Polygon points : streamlines(field, widest_spacing / l.cell)) {
    for (auto& p : points) p = {p[0] * l.cell, p[1] * l.cell};
    lines.add(points);
    double run = heads_apart / 2;
    for (std::size_t k = 2; k + 1 < points.size(); ++k) {
      const Point e{points[k][0] - points[k - 2][0], points[k][1] - points[k - 2][1]};
      const double length = std::hypot(e[0], e[1]);
      run += length / 2;
      if (run < heads_apart || k < points.size() / 8) continue;
      run = 0;
      const auto corner = [&](double side) {
        return Point{points[k][0] - head / length * (e[0] - side * slope * e[1]),
                     points[k][1] - head / length * (e[1] + side * slope * e[0])};
      };
      lines.add({corner(1), points[k], corner(-1)});
    }
  }
  return lines;
}

}  // namespace

vtkNew<vtkImageData> field_image(const Picture& picture, const ColourScale& scale, const Layout& l) {
  constexpr double line = 3;
  const Ground& ground = *l.ground;
  const CellField& values = ground.values;
  const CellField share = smoothed(ground.grains);
  const bool marks_slow = has(picture, Overlay::quasi_static);
  const CellField slowness = marks_slow ? slowness_of(picture, ground) : CellField();
  std::optional<WhiteLines> lines;
  if (has(picture, Overlay::streamlines)) lines = streamlines_of(picture, ground, l);
  std::vector<Colour> colours(values.nx());
  int coloured = -1;
  vtkNew<vtkImageData> image = image_of(l.w, l.h, [&](unsigned char* pixel, int a, int b) {
    const double x = (a + 0.5) / l.cell, y = (b + 0.5) / l.cell;
    if (const int j = std::min(static_cast<int>(y), values.ny() - 1); j != coloured) {
      for (int i = 0; i < values.nx(); ++i) colours[i] = scale.colour_of(values(i, j));
      coloured = j;
    }
    const double distance = contour_distance(share, 0.5, x, y, l.cell);
    const double grains = std::clamp(distance + 0.5, 0.0, 1.0);
    set(pixel, air);
    blend(pixel, colours[std::min(static_cast<int>(x), values.nx() - 1)], picture.show_air ? 1 : grains);
    if (distance > 0) {
      if (marks_slow)
        mark_quasi_static(pixel, ink_on(pixel), a, b, contour_distance(slowness, 0, x, y, l.cell));
      if (lines) lines->at(a, b).paint(pixel);
    }
    blend(pixel, black, std::clamp((line + 1) / 2 - std::abs(distance), 0.0, 1.0));
  });
  for (const Arrow& arrow : arrows_of(picture, ground, l.cell)) stamp(image, arrow, l.cell);
  if (picture.solids.empty()) return image;

  // The outlines lie outside, under the filling: no lines where solids overlap or touch.
  const Cover solids = cover_of(picture, l.w, l.h, l.cell);
  Strokes outlines(l.w, l.h);
  const Patch& p = values.patch();
  for (Polygon outline : picture.solids) {
    for (auto& c : outline) c = {(c[0] - p.x0) / p.h * l.cell, (c[1] - p.y0) / p.h * l.cell};
    outlines.add(outline, 2 * solid_line, true);
  }
  auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int b = 0; b < l.h; ++b) {
    for (int a = 0; a < l.w; ++a, pixel += 4) {
      blend(pixel, dark, outlines(a, b));
      blend(pixel, solid, solids(a, b));
    }
  }
  return image;
}

vtkNew<vtkImageData> key_image(Overlay overlay, int width, int height) {
  const double middle = height / 2.0;
  WhiteLines line(width, height);
  line.add({{0, middle}, {double(width), middle}});
  line.add({{24, middle + 5}, {35, middle}, {24, middle - 5}});
  return image_of(width, height, [&](unsigned char* pixel, int a, int b) {
    set(pixel, sample);
    if (overlay == Overlay::streamlines) {
      line.at(a, b).paint(pixel);
    } else {
      mark_quasi_static(pixel, white, a, b, -1.0 - std::min({a, b, width - 1 - a, height - 1 - b}));
    }
  });
}

}  // namespace hourglass
