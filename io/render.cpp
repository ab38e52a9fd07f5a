#include "io/render.hpp"

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "io/offscreen.hpp"
#include "io/raster.hpp"
#include "io/streamlines.hpp"

namespace hourglass {
namespace {

// Sizes in pixels.
constexpr int full_width = 1400, tall_height = 1300, least_bar = 420;
constexpr int margin = 26, wall = 6, tick = 10, gap = 10, bar_width = 32;
constexpr int widest_spacing = 42, closest_spacing = 24,
              rows_of_arrows = 7;  // closer where there is little room
constexpr double arrow_decades = 3, streamline_decades = 4;
constexpr int key_width = 52;     // of an overlay's sign in the legend
constexpr double solid_line = 2;  // around solids

constexpr Colour black{0, 0, 0}, white{255, 255, 255}, dark{40, 40, 40}, grey{150, 150, 150},
    air{238, 238, 238}, solid{178, 178, 178}, sample{49, 104, 142};  // sample: the ground of a legend's sign

// ---- text -------------------------------------------------------------------------------------------------

int widest(const std::vector<Tick>& ticks) {
  int w = 0;
  for (const Tick& t : ticks) w = std::max(w, text_width(t.label, tick_font));
  return w;
}

// ---- arrows and what lies under them ----------------------------------------------------------------------

/// Bilinear between cell centres, level beyond the outermost ones; x, y in cells.
double interpolate(const CellField& f, double x, double y) {
  const double a = std::clamp(x - 0.5, 0.0, f.nx() - 1.0), b = std::clamp(y - 0.5, 0.0, f.ny() - 1.0);
  const int i = std::min(static_cast<int>(a), std::max(f.nx() - 2, 0)), i1 = std::min(i + 1, f.nx() - 1);
  const int j = std::min(static_cast<int>(b), std::max(f.ny() - 2, 0)), j1 = std::min(j + 1, f.ny() - 1);
  const double s = a - i, t = b - j;
  return (1 - t) * ((1 - s) * f(i, j) + s * f(i1, j)) + t * ((1 - s) * f(i, j1) + s * f(i1, j1));
}

/// Values of known cells carried on into their neighbours, as far as so many cells.
template <class Known>
CellField carried_on(CellField field, Known&& known, int cells) {
  const Patch p = field.patch();
  std::vector<char> has(p.cells());
  for (int j = 0; j < p.ny; ++j) {
    for (int i = 0; i < p.nx; ++i) has[std::size_t(j) * p.nx + i] = known(i, j);
  }
  for (std::vector<char> had; cells > 0 && had != has; --cells) {
    had = has;
    for (int j = 0; j < p.ny; ++j) {
      for (int i = 0; i < p.nx; ++i) {
        if (had[std::size_t(j) * p.nx + i]) continue;
        double sum = 0;
        int n = 0;
        for (int b = std::max(j - 1, 0); b <= std::min(j + 1, p.ny - 1); ++b) {
          for (int a = std::max(i - 1, 0); a <= std::min(i + 1, p.nx - 1); ++a) {
            if (!had[std::size_t(b) * p.nx + a]) continue;
            sum += field(a, b);
            ++n;
          }
        }
        if (n == 0) continue;
        field(i, j) = sum / n;
        has[std::size_t(j) * p.nx + i] = true;
      }
    }
  }
  return field;
}

/// What solids cover, with the pixels of the cover as large as the picture's cells over `scale`.
Cover cover_of(const Picture& picture, int width, int height, double scale) {
  const Patch& p = picture.values.patch();
  Cover cover(width, height);
  for (Polygon outline : picture.solids) {
    for (auto& corner : outline)
      corner = {(corner[0] - p.x0) / p.h * scale, (corner[1] - p.y0) / p.h * scale};
    cover.add(outline);
  }
  return cover;
}

/// What of a picture is drawn where. Solids have no values of their own: those around are carried on into them, so that
/// lines run smoothly up to their outlines, whether the cells that these cut hold shares of the cell or of what is open.
/// So are those of the grains into the air, so that the smooth surface cuts through coloured cells only.
struct Ground {
  Cover solids;  ///< by cell
  CellField grains, values, velocity_x, velocity_y;

  explicit Ground(const Picture& picture)
      : solids(cover_of(picture, picture.values.nx(), picture.values.ny(), 1)),
        grains(carried_on(
            picture.grains, [&](int i, int j) { return solids.none(i, j); }, 4)) {
    const auto in_grains = [&](int i, int j) { return !solids.all(i, j) && grains(i, j) >= 0.5; };
    if (picture.show_air) {
      values = carried_on(
          picture.values, [&](int i, int j) { return solids.none(i, j); }, 4);
    } else {
      values = carried_on(picture.values, in_grains, 2);
    }
    if (!picture.velocity_x.allocated()) return;
    velocity_x = carried_on(picture.velocity_x, in_grains, 2);
    velocity_y = carried_on(picture.velocity_y, in_grains, 2);
  }
  /// Grains, and no solid; x, y in cells.
  bool flows(double x, double y) const { return !solids.holds(x, y) && interpolate(grains, x, y) >= 0.5; }
  Point velocity(double x, double y) const {
    return {interpolate(velocity_x, x, y), interpolate(velocity_y, x, y)};
  }
};

bool has(const Picture& picture, Overlay overlay) {
  return picture.velocity_x.allocated() &&
         std::find(picture.overlays.begin(), picture.overlays.end(), overlay) != picture.overlays.end();
}

struct Arrow {
  double x, y, dx, dy;  ///< middle and extent, in cells
  double speed;
};

/// Evenly spread over the domain, where they lie in grains.
std::vector<Arrow> arrows_of(const Picture& picture, const Ground& ground, double cell_pixels) {
  std::vector<Arrow> arrows;
  if (!picture.velocity_x.allocated() || has(picture, Overlay::streamlines)) return arrows;
  const Patch& p = picture.values.patch();
  const double wanted = std::clamp<double>(std::min(p.nx, p.ny) * cell_pixels / rows_of_arrows,
                                           closest_spacing, widest_spacing) /
                        cell_pixels;
  const int across = std::max(1, static_cast<int>(p.nx / wanted)),
            up = std::max(1, static_cast<int>(p.ny / wanted));
  double fastest = 0;
  for (int b = 0; b < up; ++b) {
    for (int a = 0; a < across; ++a) {
      const double x = (a + 0.5) * p.nx / across, y = (b + 0.5) * p.ny / up;
      const auto [u, v] = ground.velocity(x, y);
      const double speed = std::hypot(u, v);
      if (!ground.flows(x, y) || !std::isfinite(speed)) continue;
      arrows.push_back({x, y, u, v, speed});
      fastest = std::max(fastest, speed);
    }
  }
  const double least = fastest * std::pow(10.0, -arrow_decades);
  const double longest = std::min(double(p.nx) / across, double(p.ny) / up);
  std::erase_if(arrows, [&](const Arrow& a) { return !(a.speed > least); });
  for (Arrow& arrow : arrows) {
    const double decades = std::log10(arrow.speed / least) / arrow_decades;
    const double stretch = longest * (0.25 + 0.7 * decades) / arrow.speed;
    arrow.dx *= stretch;
    arrow.dy *= stretch;
  }
  std::erase_if(arrows, [&](const Arrow& a) {
    return !ground.flows(a.x - a.dx / 2, a.y - a.dy / 2) || !ground.flows(a.x + a.dx / 2, a.y + a.dy / 2);
  });
  return arrows;
}

std::string arrow_note(const std::vector<Arrow>& arrows, const std::string& unit) {
  double fastest = 0;
  for (const Arrow& a : arrows) fastest = std::max(fastest, a.speed);
  if (fastest == 0) return "";
  const auto text = [](double speed) { return number_text(speed, 2); };
  return fmt::format("arrows, log length: {} to {} {}", text(fastest * std::pow(10.0, -arrow_decades)),
                     text(fastest), unit);
}

// ---- values -----------------------------------------------------------------------------------------------

template <class F>
void for_each_shown(const Picture& picture, F&& f) {
  const Cover solids = cover_of(picture, picture.values.nx(), picture.values.ny(), 1);
  for (int j = 0; j < picture.values.ny(); ++j) {
    for (int i = 0; i < picture.values.nx(); ++i) {
      const bool shown = !solids.all(i, j) && (picture.show_air || picture.grains(i, j) >= 0.5);
      if (shown && std::isfinite(picture.values(i, j))) f(picture.values(i, j));
    }
  }
}

// ---- layout -----------------------------------------------------------------------------------------------

/// A text above the domain.
struct Note {
  std::string text;
  int size = tick_font;          ///< of the font
  std::optional<Overlay> key{};  ///< whose sign stands before it
  int x = 0, y = 0;              ///< its lower left corner

  int width() const { return text_width(text, size) + (key ? key_width + gap : 0); }
};

/// Time, arrows, overlays, and what the colours leave out.
std::vector<Note> notes_of(const Picture& picture, const Ground& ground, double cell_pixels,
                           bool out_of_range) {
  std::vector<Note> notes;
  notes.push_back(
      {picture.time ? fmt::format("t = {} {}", number_text(*picture.time, 4), picture.time_unit) : "steady",
       label_font});
  if (auto note = arrow_note(arrows_of(picture, ground, cell_pixels), picture.velocity_unit); !note.empty())
    notes.push_back({note});
  if (has(picture, Overlay::quasi_static)) {
    notes.push_back({fmt::format("quasi-static: speed < {} {}", number_text(picture.slow_speed, 3),
                                 picture.velocity_unit),
                     tick_font, Overlay::quasi_static});
  }
  if (has(picture, Overlay::streamlines)) notes.push_back({"streamlines", tick_font, Overlay::streamlines});
  if (picture.tails > 0 && out_of_range) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for_each_shown(picture, [&](double value) {
      lo = std::min(lo, value);
      hi = std::max(hi, value);
    });
    notes.push_back({fmt::format("full range: {} to {}", number_text(lo, 3), number_text(hi, 3))});
  }
  return notes;
}

/// Puts notes into rows from the top, `width` wide; returns the height of all.
int arrange(std::vector<Note>& notes, int width) {
  constexpr int row_height = label_font + gap + gap / 2;
  std::vector<int> row_of, ends{0}, members{0};
  for (Note& note : notes) {
    const int start = members.back() == 0 ? 0 : ends.back() + 2 * margin;
    if (start > 0 && start + note.width() > width) {
      ends.push_back(0);
      members.push_back(0);
    }
    note.x = members.back() == 0 ? 0 : start;
    ends.back() = note.x + note.width();
    row_of.push_back(static_cast<int>(members.size()) - 1);
    ++members.back();
  }
  const int rows = static_cast<int>(members.size());
  std::vector<int> placed(rows, 0);
  for (std::size_t k = 0; k < notes.size(); ++k) {  // spread over the width
    const int row = row_of[k], n = members[row];
    if (n > 1) notes[k].x += (width - ends[row]) * placed[row]++ / (n - 1);
    notes[k].y = (rows - 1 - row) * row_height;
  }
  return rows * row_height;
}

/// Where everything goes, in pixels from the lower left corner.
struct Layout {
  int width = 0, height = 0;
  int x = 0, y = 0, w = 0, h = 0;    ///< the domain
  double cell = 1;                   ///< pixels to a cell
  bool bar_below = false;            ///< the domain is too low for a colour bar at its side
  bool under = false, over = false;  ///< there are values beyond the range
  int bar_x = 0, bar_y = 0, bar_w = 0, bar_h = 0;
  std::vector<Tick> x_ticks, y_ticks, bar_ticks;
  std::string bar_title;
  std::vector<Note> notes;               ///< above the domain
  std::shared_ptr<const Ground> ground;  ///< of the picture
};

Layout layout_of(const Picture& picture, const ColourScale& scale) {
  const Patch& p = picture.values.patch();
  Layout l;
  l.ground = std::make_shared<const Ground>(picture);
  l.bar_title = picture.unit.empty() ? picture.title : fmt::format("{} [{}]", picture.title, picture.unit);

  for_each_shown(picture, [&](double value) {
    l.under |=
        value < scale.lo() - 1e-6 * (scale.hi() - scale.lo()) || (scale.log() && value < 0.999 * scale.lo());
    l.over |= value > scale.hi() + 1e-6 * (scale.hi() - scale.lo());
  });

  // The margins depend on the labels, these on the ticks, these on the size of the domain, and this on the
  // margins: the second turn settles it.
  l.w = full_width - 300;
  l.h = static_cast<int>(std::min<double>(tall_height, l.w * double(p.ny) / p.nx));
  const int tick_line = tick + gap + tick_font, label_line = gap + label_font;
  const int axis = wall + tick_line + label_line;  // height of the x axis with its labels
  int right = 0;
  for (int turn = 0; turn < 2; ++turn) {
    l.bar_below = l.h < least_bar;
    l.x_ticks = linear_ticks(p.x0, p.x0 + p.nx * p.h, std::clamp(l.w / 80, 2, 8));
    if (picture.axial) {
      for (Tick& t : l.x_ticks) t.label = number_text(std::abs(t.value));
    }
    l.y_ticks = linear_ticks(p.y0, p.y0 + p.ny * p.h, std::clamp(l.h / 60, 2, 8));
    const int most = std::clamp(l.bar_below ? l.w / 150 : l.h / 80, 2, 6);
    l.bar_ticks =
        scale.log() ? log_ticks(scale.lo(), scale.hi()) : linear_ticks(scale.lo(), scale.hi(), most);
    l.x = margin + label_line + gap + widest(l.y_ticks) + gap + tick + wall;
    l.y = margin + axis;
    right = margin + wall;
    if (l.bar_below) {
      l.y += margin + bar_width + tick_line + label_line;
      right += widest(l.x_ticks) / 2;
    } else {
      right += margin + bar_width + tick + gap + widest(l.bar_ticks) + gap + label_line;
    }
    l.cell = std::min(double(full_width - l.x - right) / p.nx, double(tall_height) / p.ny);
    l.w = static_cast<int>(std::lround(p.nx * l.cell));
    l.h = static_cast<int>(std::lround(p.ny * l.cell));
  }
  l.bar_x = l.bar_below ? l.x : l.x + l.w + wall + margin;
  l.bar_y = l.bar_below ? margin + label_line + tick_line : l.y;
  l.bar_w = l.bar_below ? l.w : bar_width;
  l.bar_h = l.bar_below ? bar_width : l.h;

  l.notes = notes_of(picture, *l.ground, l.cell, l.under || l.over);
  int header = l.w;
  for (const Note& note : l.notes) header = std::max(header, note.width());
  const int header_height = arrange(l.notes, header);
  l.width = std::max(l.x + l.w + right, header + 2 * margin);
  l.height = std::max(l.y + l.h + wall + header_height + margin, picture.least_size[1]);
  for (Note& note : l.notes) {
    note.x += std::max(margin, std::min(l.x, l.width - margin - header));
    note.y += l.height - margin - header_height + gap;  // from the top, for videos
  }
  l.width = std::max(l.width, picture.least_size[0]);
  return l;
}

// ---- the field as an image --------------------------------------------------------------------------------

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

/// A picture of w x h pixels, each painted by paint(pixel, a, b).
template <class Paint>
vtkNew<vtkImageData> image_of(int w, int h, Paint&& paint) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(w, h, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int b = 0; b < h; ++b) {
    for (int a = 0; a < w; ++a, pixel += 4) {
      paint(pixel, a, b);
      pixel[3] = 255;
    }
  }
  return image;
}

void set(unsigned char* pixel, const Colour& colour) { std::copy(colour.begin(), colour.end(), pixel); }

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

/// Every cell in its colour, air blank, the overlays, the free surface as a black line, the arrows, and the solids.
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

// ---- painting ---------------------------------------------------------------------------------------------

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
    context->DrawImage(float(x), float(y - image->GetDimensions()[1] / 2), image);
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
        context->DrawLine(float(across + wall / 2), float(begin), float(across + wall / 2), float(end));
      } else {
        rectangle(context, white, begin, across, end - begin, wall);
        pen(context, grey, 2, vtkPen::DASH_LINE);
        context->DrawLine(float(begin), float(across + wall / 2), float(end), float(across + wall / 2));
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

  static void paint_key(vtkContext2D* context, Overlay overlay, int x, int y) {
    constexpr int h = tick_font;
    WhiteLines line(key_width, h);
    line.add({{0, h / 2.0}, {key_width, h / 2.0}});
    line.add({{24, h / 2.0 + 5}, {35, h / 2.0}, {24, h / 2.0 - 5}});
    const vtkNew<vtkImageData> key = image_of(key_width, h, [&](unsigned char* pixel, int a, int b) {
      set(pixel, sample);
      if (overlay == Overlay::streamlines) {
        line.at(a, b).paint(pixel);
      } else {
        mark_quasi_static(pixel, white, a, b, -1.0 - std::min({a, b, key_width - 1 - a, h - 1 - b}));
      }
    });
    context->DrawImage(float(x), float(y), key);
  }

  void paint_header(vtkContext2D* context) const {
    for (const Note& note : layout->notes) {
      const int shift = note.key ? key_width + gap : 0;
      if (note.key) paint_key(context, *note.key, note.x, note.y);
      draw_text(context, note.text, note.x + shift, note.y, note.size, Align::begin, Align::begin);
    }
  }
};
vtkStandardNewMacro(Painting);

}  // namespace

std::array<double, 2> shown_extremes(const Picture& picture) {
  std::vector<double> shown;
  for_each_shown(picture, [&](double value) {
    if (!picture.log_scale || value > 0) shown.push_back(value);
  });
  if (shown.empty()) return {HUGE_VAL, -HUGE_VAL};
  const auto cut = static_cast<std::ptrdiff_t>(picture.tails * static_cast<double>(shown.size()));
  const auto value_at = [&](std::ptrdiff_t rank) {
    std::nth_element(shown.begin(), shown.begin() + rank, shown.end());
    return shown[rank];
  };
  return {value_at(cut), value_at(std::ssize(shown) - 1 - cut)};
}

namespace {

ColourScale scale_of(const Picture& picture) {
  if (picture.range) return {*picture.range, picture.log_scale, picture.colours};
  const auto [lo, hi] = shown_extremes(picture);
  return {nice_range(lo, hi, picture.log_scale), picture.log_scale, picture.colours};
}

}  // namespace

std::array<int, 2> size_of(const Picture& picture) {
  const Layout layout = layout_of(picture, scale_of(picture));
  return {layout.width, layout.height};
}

namespace {

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
