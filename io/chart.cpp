#include "io/chart.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "io/canvas.hpp"
#include "io/chart_axes.hpp"

namespace hourglass {
namespace {

// Sizes in pixels.
constexpr int margin = 30, gap = 12, tick = 10, row = 42, sample = 64, bar_width = 32;
constexpr double mark_radius = 9;
constexpr Colour grey{178, 178, 178}, no_value{238, 238, 238};

int widest(const std::vector<Tick>& ticks) {
  int w = 0;
  for (const Tick& t : ticks) w = std::max(w, text_width(t.label, tick_font));
  return w;
}

const Colour& colour_of(const Series& s) { return s.greyed ? grey : palette[s.colour % palette.size()]; }

/// `rim`: of white around it.
void paint_mark(Canvas& canvas, Mark mark, double x, double y, const Colour& colour, double rim = 2) {
  const auto shape = [&](double r, const Colour& with) {
    switch (mark) {
      case Mark::none:
        break;
      case Mark::disc:
      case Mark::ring:
        canvas.disc(x, y, 2 * r, with);
        break;
      case Mark::square:
        canvas.area(Rectangle{x - 0.88 * r, y - 0.88 * r, 1.76 * r, 1.76 * r}, with);
        break;
      case Mark::diamond:
        canvas.area(Polygon{{x - 1.25 * r, y}, {x, y - 1.25 * r}, {x + 1.25 * r, y}, {x, y + 1.25 * r}},
                    with);
        break;
      case Mark::triangle:
        canvas.area(Polygon{{x - 1.15 * r, y - 0.75 * r}, {x + 1.15 * r, y - 0.75 * r}, {x, y + 1.2 * r}},
                    with);
        break;
    }
  };
  shape(mark_radius + rim, blank);
  shape(mark_radius, colour);
  if (mark == Mark::ring) canvas.disc(x, y, 2 * mark_radius - 6, blank);
}

/// The axes with all that stands around them, and where values lie.
class Plot {
 public:
  Plot(std::string title, const Axis& x_axis, const Axis& y_axis, Scale x, Scale y,
       const std::vector<Series>& series, const std::vector<ReferenceLine>& lines, int width, int height,
       int aside, std::string contour_name = {})
      : title_(std::move(title)), contour_name_(std::move(contour_name)), x_title_(x_axis.title),
        y_title_(y_axis.title), x_(x), y_(y), x_ticks_(ticks_of(x.lo, x.hi, x.log, std::max(2, width / 110))),
        y_ticks_(ticks_of(y.lo, y.hi, y.log, std::max(2, height / 70))), series_(series), lines_(lines) {
    int legend = 0;
    for (const Series& s : series) legend = std::max(legend, text_width(s.name, tick_font));
    legend = std::max(legend, text_width(contour_name_, tick_font));
    const int entries = static_cast<int>(std::count_if(series.begin(), series.end(),
                                                       [](const Series& s) { return !s.name.empty(); })) +
                        !contour_name_.empty();
    plot_ = {double(margin + label_font + gap + widest(y_ticks_) + gap + tick),
             double(margin + label_font + gap + tick_font + gap + tick),
             double(std::max(width, text_width(x_title_, label_font))),
             double(std::max({height, entries * row, text_width(y_title_, label_font)}))};
    const int line_labels = place_line_labels();
    aside_ = plot_.x + plot_.w + (line_labels > 0 ? gap + line_labels : 0) + margin;
    legend_ = aside_ + aside;
    double right = legend_ + (legend > 0 ? sample + gap + legend + margin : 0);
    right = std::max(right, plot_.x + plot_.w + widest(x_ticks_) / 2.0 + margin);
    top_ = plot_.y + plot_.h + gap + std::max(rows_ * (tick_font + gap), tick_font / 2);
    const double title_end = plot_.x + text_width(title_, label_font) + margin;
    width_ = static_cast<int>(std::max(right, title_end));
    height_ = static_cast<int>(top_ + (title_.empty() ? 0 : label_font + gap) + margin);
  }

  Canvas canvas() const { return {width_, height_}; }
  const Rectangle& area() const { return plot_; }
  double aside() const { return aside_; }  ///< where what stands between plot and legend begins
  double px(double x) const { return plot_.x + plot_.w * x_(x); }
  double py(double y) const { return plot_.y + plot_.h * y_(y); }
  bool can_show(double x, double y) const { return x_.can_show(x) && y_.can_show(y); }

  void paint_grid(Canvas& canvas) const {
    for (const Tick& t : x_ticks_)
      if (!t.label.empty()) canvas.line({{px(t.value), plot_.y}, {px(t.value), plot_.y + plot_.h}}, faint);
    for (const Tick& t : y_ticks_)
      if (!t.label.empty()) canvas.line({{plot_.x, py(t.value)}, {plot_.x + plot_.w, py(t.value)}}, faint);
  }

  void paint_axes(Canvas& canvas) const {
    for (const Tick& t : x_ticks_) {
      canvas.line({{px(t.value), plot_.y}, {px(t.value), plot_.y - (t.label.empty() ? tick / 2.0 : tick)}},
                  ink);
      canvas.text(t.label, px(t.value), plot_.y - tick - gap, Align::middle, Align::end);
    }
    for (const Tick& t : y_ticks_) {
      canvas.line({{plot_.x, py(t.value)}, {plot_.x - (t.label.empty() ? tick / 2.0 : tick), py(t.value)}},
                  ink);
      canvas.text(t.label, plot_.x - tick - gap, py(t.value), Align::end, Align::middle);
    }
    const double right = plot_.x + plot_.w, up = plot_.y + plot_.h;
    canvas.line({{plot_.x, up}, {plot_.x, plot_.y}, {right, plot_.y}}, ink);
    canvas.text(x_title_, plot_.x + plot_.w / 2, margin, Align::middle, Align::begin, label_font);
    canvas.upright(y_title_, margin, plot_.y + plot_.h / 2);
    canvas.text(title_, plot_.x, top_, Align::begin, Align::begin, label_font);
  }

  void paint_lines(Canvas& canvas) const {
    for (const LineLabel& l : labels_) {
      if (l.line->way == ReferenceLine::Way::vertical)
        canvas.line({{l.at, plot_.y}, {l.at, plot_.y + plot_.h}}, ink, 2, true);
      else
        canvas.line({{plot_.x, l.at}, {plot_.x + plot_.w, l.at}}, ink, 2, true);
      if (l.line->way == ReferenceLine::Way::vertical)
        canvas.text(l.line->label, l.text, plot_.y + plot_.h + gap + l.row * (tick_font + gap), Align::middle,
                    Align::begin);
      else
        canvas.text(l.line->label, plot_.x + plot_.w + gap, l.text, Align::begin, Align::middle);
    }
  }

  /// `rim`: of white beside lines, to be seen on colours.
  void paint_series(Canvas& canvas, double rim = 0) const {
    for (const bool greyed : {true, false})
      for (const Series& s : series_)
        if (s.greyed == greyed) paint(canvas, s, rim);
    paint_labels(canvas);
  }

  void paint_legend(Canvas& canvas, double rim = 0) const {
    double y = plot_.y + plot_.h - row / 2.0;
    if (!contour_name_.empty()) {
      canvas.line({{legend_, y}, {legend_ + sample, y}}, ink, 3);
      canvas.text(contour_name_, legend_ + sample + gap, y, Align::begin, Align::middle);
      y -= row;
    }
    for (const Series& s : series_) {
      if (s.name.empty()) continue;
      const double middle = legend_ + sample / 2.0;
      if (!s.lower.empty()) canvas.area(Rectangle{legend_, y - 10, sample, 20}, colour_of(s), 0.25);
      if (s.line) canvas.line({{legend_, y}, {legend_ + sample, y}}, colour_of(s), 4, s.dashed);
      if (!s.error.empty()) paint_bar(canvas, middle, y - 17, y + 17, colour_of(s));
      paint_mark(canvas, s.mark, middle, y, colour_of(s), rim);
      canvas.text(s.name, legend_ + sample + gap, y, Align::begin, Align::middle);
      y -= row;
    }
  }

 private:
  struct LineLabel {
    const ReferenceLine* line;
    double at;    ///< of the line
    double text;  ///< of its label along the side where it stands
    int row = 0;  ///< above the plot, from below
  };

  /// Labels beside each other do not overlap; returns the width of those at the right.
  int place_line_labels() {
    int w = 0;
    for (const ReferenceLine& l : lines_) {
      const bool vertical = l.way == ReferenceLine::Way::vertical;
      const Scale& scale = vertical ? x_ : y_;
      if (!scale.can_show(l.at) || scale(l.at) < 0 || scale(l.at) > 1) continue;
      const double at = vertical ? px(l.at) : py(l.at);
      labels_.push_back({&l, at, at});
      if (!vertical) w = std::max(w, text_width(l.label, tick_font));
    }
    std::stable_sort(labels_.begin(), labels_.end(),
                     [](const auto& a, const auto& b) { return a.at < b.at; });
    std::vector<double> ends;  // of the rows
    LineLabel* below = nullptr;
    for (LineLabel& l : labels_) {
      if (l.line->way == ReferenceLine::Way::horizontal) {
        if (below) l.text = std::max(l.text, below->text + tick_font + 4);
        below = &l;
        continue;
      }
      const double half = text_width(l.line->label, tick_font) / 2.0;
      l.text = std::max(l.text, margin + half);
      while (l.row < std::ssize(ends) && ends[l.row] > l.text - half - gap) ++l.row;
      if (l.row == std::ssize(ends)) ends.push_back(0);
      ends[l.row] = l.text + half;
      if (!l.line->label.empty()) rows_ = std::max(rows_, l.row + 1);
    }
    return w;
  }

  /// The stretches of points that can be shown, as pixels, of one row of values over x.
  std::vector<Polygon> stretches(const Series& s, const std::vector<double>& y) const {
    std::vector<Polygon> out(1);
    for (std::size_t k = 0; k < std::min(s.x.size(), y.size()); ++k) {
      if (can_show(s.x[k], y[k]))
        out.back().push_back({px(s.x[k]), py(y[k])});
      else if (!out.back().empty())
        out.emplace_back();
    }
    return out;
  }

  void paint_bar(Canvas& canvas, double x, double from, double to, const Colour& colour) const {
    canvas.line({{x, from}, {x, to}}, colour);
    for (const double y : {from, to}) canvas.line({{x - 6, y}, {x + 6, y}}, colour);
  }

  void paint(Canvas& canvas, const Series& s, double rim) const {
    const Colour& colour = colour_of(s);
    canvas.clip(plot_);
    if (!s.lower.empty()) {
      Polygon band;
      for (std::size_t k = 0; k < s.x.size(); ++k)
        if (can_show(s.x[k], s.upper[k])) band.push_back({px(s.x[k]), py(s.upper[k])});
      for (std::size_t k = s.x.size(); k-- > 0;)
        if (can_show(s.x[k], s.upper[k]))
          band.push_back({px(s.x[k]), can_show(s.x[k], s.lower[k]) ? py(s.lower[k]) : plot_.y});
      canvas.area(band, colour, 0.25);
    }
    if (s.line)
      for (const Polygon& points : stretches(s, s.y)) {
        if (rim > 0) canvas.line(points, blank, 4 + 2 * rim);
        canvas.line(points, colour, 4, s.dashed);
      }
    for (std::size_t k = 0; k < s.error.size(); ++k) {
      if (!can_show(s.x[k], s.y[k]) || !(s.error[k] > 0)) continue;
      const double from = s.y[k] - s.error[k];
      paint_bar(canvas, px(s.x[k]), y_.can_show(from) ? py(from) : plot_.y - 2 * tick,
                py(s.y[k] + s.error[k]), colour);
    }
    canvas.unclip();
    for (std::size_t k = 0; k < s.x.size(); ++k)
      if (shown(s, k)) paint_mark(canvas, s.mark, px(s.x[k]), py(s.y[k]), colour);
  }

  bool shown(const Series& s, std::size_t k) const {
    const Rectangle around{plot_.x - 1, plot_.y - 1, plot_.w + 2, plot_.h + 2};
    return can_show(s.x[k], s.y[k]) && around.holds(px(s.x[k]), py(s.y[k]));
  }

  static double common(const Rectangle& a, const Rectangle& b) {
    return std::max(0.0, std::min(a.x + a.w, b.x + b.w) - std::max(a.x, b.x)) *
           std::max(0.0, std::min(a.y + a.h, b.y + b.h) - std::max(a.y, b.y));
  }

  /// Each label goes to the place around its point where it hides least.
  void paint_labels(Canvas& canvas) const {
    std::vector<Rectangle> taken;
    for (const Series& s : series_)
      for (std::size_t k = 0; k < s.x.size(); ++k)
        if (shown(s, k) && (s.mark != Mark::none || k < s.labels.size()))
          taken.push_back(
              {px(s.x[k]) - mark_radius, py(s.y[k]) - mark_radius, 2 * mark_radius, 2 * mark_radius});
    for (const LineLabel& l : labels_) {
      if (l.line->way == ReferenceLine::Way::vertical)
        taken.push_back({l.at - 2, plot_.y, 4, plot_.h});
      else
        taken.push_back({plot_.x, l.at - 2, plot_.w, 4});
    }
    for (const Series& s : series_)
      if (s.line)
        for (const Polygon& points : stretches(s, s.y))
          for (std::size_t k = 1; k < points.size(); ++k) {
            const double length =
                std::hypot(points[k][0] - points[k - 1][0], points[k][1] - points[k - 1][1]);
            const int pieces = static_cast<int>(std::min(length / 8, 200.0)) + 1;
            for (int p = 0; p < pieces; ++p) {
              const double f = (p + 0.5) / pieces;
              taken.push_back({points[k - 1][0] + f * (points[k][0] - points[k - 1][0]) - 3,
                               points[k - 1][1] + f * (points[k][1] - points[k - 1][1]) - 3, 6, 6});
            }
          }
    for (const Series& s : series_)
      for (std::size_t k = 0; k < std::min(s.labels.size(), s.x.size()); ++k)
        if (!s.labels[k].empty() && shown(s, k)) place(canvas, taken, s.labels[k], px(s.x[k]), py(s.y[k]));
  }

  void place(Canvas& canvas, std::vector<Rectangle>& taken, const std::string& what, double x,
             double y) const {
    const double w = text_width(what, tick_font) + 8, h = tick_font + 6;
    Rectangle best;
    double least = HUGE_VAL;
    for (const double away : {mark_radius + 4, mark_radius + 16, mark_radius + 34})
      for (const auto& [sx, sy] :
           {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
        const Rectangle here{x + sx * away -
                                 (sx < 0    ? w
                                  : sx == 0 ? w / 2
                                            : 0),
                             y + sy * away -
                                 (sy < 0    ? h
                                  : sy == 0 ? h / 2
                                            : 0),
                             w, h};
        double cost = 10 * (w * h - common(here, plot_)) + away;
        for (const Rectangle& r : taken) cost += common(here, r);
        if (cost < least) {
          least = cost;
          best = here;
        }
      }
    canvas.area(best, blank, 0.75);
    canvas.text(what, best.x + 4, best.y + h / 2, Align::begin, Align::middle);
    taken.push_back(best);
  }

  std::string title_, contour_name_, x_title_, y_title_;
  Scale x_, y_;
  std::vector<Tick> x_ticks_, y_ticks_;
  const std::vector<Series>& series_;
  const std::vector<ReferenceLine>& lines_;
  std::vector<LineLabel> labels_;
  Rectangle plot_;
  double aside_ = 0, legend_ = 0, top_ = 0;
  int rows_ = 0, width_ = 0, height_ = 0;
};

/// Borders between cells around places, ends included, halfway on the scale of the axis.
std::vector<double> borders(const std::vector<double>& at, bool log) {
  const auto to = [&](double v) { return log ? std::log(v) : v; };
  const auto back = [&](double v) { return log ? std::exp(v) : v; };
  if (at.size() == 1) return log ? std::vector{at[0] / 2, at[0] * 2} : std::vector{at[0] - 0.5, at[0] + 0.5};
  std::vector<double> out;
  for (std::size_t k = 0; k <= at.size(); ++k) {
    const std::size_t a = k == 0 ? 0 : k == at.size() ? k - 2 : k - 1;
    const double f = k == 0 ? -0.5 : k == at.size() ? 1.5 : 0.5;
    out.push_back(back(to(at[a]) + f * (to(at[a + 1]) - to(at[a]))));
  }
  return out;
}

/// Which cell each of `pixels` lies in; -1: none.
std::vector<int> cells_along(const std::vector<double>& at, const Scale& scale, int pixels) {
  std::vector<double> ends;
  for (const double b : borders(at, scale.log)) ends.push_back(scale(b));
  std::vector<int> out;
  for (int p = 0; p < pixels; ++p) {
    const auto above = std::upper_bound(ends.begin(), ends.end(), (p + 0.5) / pixels) - ends.begin();
    out.push_back(above > 0 && above < std::ssize(ends) ? static_cast<int>(above) - 1 : -1);
  }
  return out;
}

/// The pieces of the line where values at the places cross a level (marching squares).
std::vector<Polygon> contour_of(const HeatMap& map, const Plot& plot, double level) {
  std::vector<Polygon> pieces;
  const std::size_t nx = map.at_x.size();
  const auto value = [&](std::size_t i, std::size_t j) {
    const double v = map.values[j * nx + i];
    return map.value.log ? std::log(v / level) : v - level;
  };
  for (std::size_t j = 0; j + 1 < map.at_y.size(); ++j)
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      const std::array<std::array<std::size_t, 2>, 4> corner{
          {{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
      Polygon crossings;
      for (int k = 0; k < 4; ++k) {
        const auto &a = corner[k], &b = corner[(k + 1) % 4];
        const double va = value(a[0], a[1]), vb = value(b[0], b[1]);
        if (!std::isfinite(va) || !std::isfinite(vb) || (va > 0) == (vb > 0)) continue;
        const double f = va / (va - vb);
        const std::array pa{plot.px(map.at_x[a[0]]), plot.py(map.at_y[a[1]])},
            pb{plot.px(map.at_x[b[0]]), plot.py(map.at_y[b[1]])};
        crossings.push_back({pa[0] + f * (pb[0] - pa[0]), pa[1] + f * (pb[1] - pa[1])});
      }
      for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
        pieces.push_back({crossings[k], crossings[k + 1]});
    }
  return pieces;
}

std::array<double, 2> value_range(const HeatMap& map) {
  if (map.value.range) return *map.value.range;
  Extremes e;
  for (const double v : map.values) e.add(v, map.value.log);
  if (map.colours == ColourMap::signs && e.lo <= e.hi) {
    const double most = std::max({std::abs(e.lo), std::abs(e.hi), 1e-300});
    return {-most, most};
  }
  if (map.value.log && e.lo < e.hi) return {e.lo, e.hi};
  return nice_range(e.lo, e.hi, map.value.log);
}

}  // namespace

void draw_chart(const Chart& chart, const std::filesystem::path& path) {
  const auto [x, y] = scales_of(chart);
  const Plot plot(chart.title, chart.x, chart.y, x, y, chart.series, chart.lines, chart.width, chart.height,
                  0);
  Canvas canvas = plot.canvas();
  plot.paint_grid(canvas);
  plot.paint_lines(canvas);
  plot.paint_axes(canvas);
  plot.paint_series(canvas);
  plot.paint_legend(canvas);
  canvas.write(path);
}

void draw_heat_map(const HeatMap& map, const std::filesystem::path& path) {
  if (map.at_x.empty() || map.at_y.empty() || map.values.size() != map.at_x.size() * map.at_y.size())
    throw std::invalid_argument("a heat map needs one value for each place");
  const auto range = [](const Axis& axis, const std::vector<double>& at) {
    const std::vector<double> ends = borders(at, axis.log);
    return axis.range.value_or(std::array{ends.front(), ends.back()});
  };
  const Scale x(map.x, range(map.x, map.at_x)), y(map.y, range(map.y, map.at_y));
  const ColourScale colours(value_range(map), map.value.log, map.colours);
  const std::vector<Tick> bar_ticks = ticks_of(colours.lo(), colours.hi(), colours.log(), map.height / 70);
  const int bar = bar_width + tick + gap + widest(bar_ticks) + 2 * gap + label_font + margin;
  const std::vector<ReferenceLine> no_lines;
  const Plot plot(map.title, map.x, map.y, x, y, map.over, no_lines, map.width,
                  std::max(map.height, text_width(map.value.title, label_font)), bar, map.contour_name);
  Canvas canvas = plot.canvas();

  const Rectangle& area = plot.area();
  const int w = static_cast<int>(area.w), h = static_cast<int>(area.h), x0 = static_cast<int>(area.x),
            y0 = static_cast<int>(area.y);
  const std::vector<int> columns = cells_along(map.at_x, x, w), rows = cells_along(map.at_y, y, h);
  for (int b = 0; b < h; ++b)
    for (int a = 0; a < w; ++a) {
      const double v =
          columns[a] < 0 || rows[b] < 0 ? NAN : map.values[rows[b] * map.at_x.size() + columns[a]];
      canvas.set(x0 + a, y0 + b, std::isnan(v) ? no_value : colours.colour_of(v));
    }
  canvas.clip(area);
  std::vector<Polygon> pieces;
  for (const double level : map.contours)
    for (Polygon& piece : contour_of(map, plot, level)) pieces.push_back(std::move(piece));
  for (const Polygon& piece : pieces) canvas.line(piece, blank, 7);
  for (const Polygon& piece : pieces) canvas.line(piece, ink, 3);
  canvas.unclip();

  const double at = plot.aside();
  for (int b = 0; b < h; ++b)
    for (int a = 0; a < bar_width; ++a) canvas.set(int(at) + a, y0 + b, colours.colour_at((b + 0.5) / h));
  canvas.line(
      {{at, area.y}, {at + bar_width, area.y}, {at + bar_width, area.y + h}, {at, area.y + h}, {at, area.y}},
      ink);
  for (const Tick& t : bar_ticks) {
    const double level = area.y + h * colours.position(t.value), right = at + bar_width;
    canvas.line({{right, level}, {right + (t.label.empty() ? tick / 2.0 : tick), level}}, ink);
    canvas.text(t.label, right + tick + gap, level, Align::begin, Align::middle);
  }
  canvas.upright(map.value.title, at + bar_width + tick + gap + widest(bar_ticks) + 2 * gap,
                 area.y + h / 2.0);
  plot.paint_axes(canvas);
  plot.paint_series(canvas, 2);
  plot.paint_legend(canvas);
  canvas.write(path);
}

}  // namespace hourglass
