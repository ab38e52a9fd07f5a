#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/chart_axes.hpp"
#include "io/html.hpp"
#include "io/json.hpp"

namespace hourglass {
namespace {

// Sizes in units of the picture, which is shown about as large.
constexpr double width = 560, height = 350, top = 12, right = 18, foot = 50, letter = 8.2;
constexpr std::size_t most_points = 800;  ///< of a line; more are thinned out

std::string point(double x, double y) { return fmt::format("{:.1f} {:.1f}", x, y); }

/// Numbers of the points of a line that are drawn: all, or of each of some stretches the first, the lowest and the
/// highest, and the last of all.
std::vector<std::size_t> thinned(const std::vector<double>& y) {
  std::vector<std::size_t> kept;
  const std::size_t n = y.size(), stretch = n <= most_points ? 1 : (3 * n + most_points - 1) / most_points;
  const auto below = [](double a, double b) { return a < b || (std::isnan(b) && !std::isnan(a)); };
  const auto above = [](double a, double b) { return a < b || (std::isnan(a) && !std::isnan(b)); };
  for (std::size_t k = 0; k < n; k += stretch) {
    const auto begin = y.begin() + static_cast<long>(k),
               end = y.begin() + static_cast<long>(std::min(k + stretch, n));
    std::array of{k, static_cast<std::size_t>(std::min_element(begin, end, below) - y.begin()),
                  static_cast<std::size_t>(std::max_element(begin, end, above) - y.begin())};
    std::ranges::sort(of);
    kept.insert(kept.end(), of.begin(), std::unique(of.begin(), of.end()));
  }
  if (n > 0 && kept.back() != n - 1) kept.push_back(n - 1);
  return kept;
}

class SvgChart {
 public:
  SvgChart(const Chart& chart, std::pair<Scale, Scale> scales)
      : c_(chart), x_(scales.first), y_(scales.second), y_ticks_(ticks_of(y_.lo, y_.hi, y_.log, 6)) {
    std::size_t widest = 0;
    for (const Tick& t : y_ticks_) widest = std::max(widest, letters(t.label));
    left_ = 30 + letter * static_cast<double>(widest) + 8;
    x_ticks_ = ticks_of(x_.lo, x_.hi, x_.log, 6);
  }

  std::string figure() const {
    return fmt::format(
        "<figure class=\"chart\">\n<figcaption>{}</figcaption>\n{}<svg viewBox=\"0 0 {} {}\" role=\"img\" "
        "aria-label=\"{}\">\n{}</svg>\n<script type=\"application/json\">{}</script>\n</figure>\n",
        html_text(c_.title), legend(), width, height,
        html_text(fmt::format("{}: {} over {}", c_.title, c_.y.title, c_.x.title)), axes() + drawn(), data());
  }

 private:
  /// Of UTF-8.
  static std::size_t letters(const std::string& s) {
    return static_cast<std::size_t>(std::ranges::count_if(s, [](char c) { return (c & 0xc0) != 0x80; }));
  }
  double px(double x) const { return left_ + (width - left_ - right) * x_(x); }
  double py(double y) const { return height - foot - (height - foot - top) * y_(y); }
  bool can_show(double x, double y) const { return x_.can_show(x) && y_.can_show(y); }
  static std::string look(const Series& s) {
    return fmt::format("{}{}", s.greyed ? "grey" : fmt::format("c{}", s.colour % palette.size()),
                       s.dashed ? " dash" : "");
  }

  std::string axes() const {
    std::string out;
    const double bottom = height - foot, end = width - right;
    for (const Tick& t : x_ticks_) {
      const double x = px(t.value);
      if (t.label.empty()) continue;
      out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {}V{}\"/>", x, top, bottom + 5);
      out += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                         std::min(x, width - 0.5 * letter * static_cast<double>(letters(t.label))),
                         bottom + 20, t.label);
    }
    for (const Tick& t : y_ticks_) {
      const double y = py(t.value);
      if (t.label.empty()) continue;
      out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{}\"/>", left_ - 5, y, end);
      out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left_ - 8, y + 5,
                         t.label);
    }
    out += fmt::format("<path class=\"axis\" d=\"M{:.1f} {}V{}H{}\"/>\n", left_, top, bottom, end);
    out += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", 0.5 * (left_ + end),
                       height - 8, html_text(c_.x.title));
    const bool squeezed = letter * static_cast<double>(letters(c_.y.title)) > bottom - top;
    out += fmt::format(
        "<text transform=\"translate(16 {:.1f}) rotate(-90)\" text-anchor=\"middle\"{}>{}</text>\n",
        0.5 * (top + bottom),
        squeezed ? fmt::format(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", bottom - top) : "",
        html_text(c_.y.title));
    for (const ReferenceLine& l : c_.lines) {
      const bool vertical = l.way == ReferenceLine::Way::vertical;
      const Scale& scale = vertical ? x_ : y_;
      if (!scale.can_show(l.at) || scale(l.at) < 0 || scale(l.at) > 1) continue;
      out += vertical
                 ? fmt::format("<path class=\"mark dash\" d=\"M{:.1f} {}V{}\"/>", px(l.at), top, bottom)
                 : fmt::format("<path class=\"mark dash\" d=\"M{:.1f} {:.1f}H{}\"/>", left_, py(l.at), end);
    }
    return out;
  }

  /// A path through points, with gaps where one cannot be shown.
  std::string path_of(const Series& s, const std::vector<double>& y) const {
    std::string d;
    bool on = false;
    for (const std::size_t k : thinned(y)) {
      const bool shown = k < s.x.size() && can_show(s.x[k], y[k]);
      if (shown) d += (on ? 'L' : 'M') + point(px(s.x[k]), py(y[k]));
      on = shown;
    }
    return d;
  }

  std::string drawn() const {
    // Nested, so that what lies beyond the axes is cut off.
    std::string out = fmt::format(
        "<svg x=\"{0:.1f}\" y=\"{1}\" width=\"{2:.1f}\" height=\"{3}\" viewBox=\"{0:.1f} {1} {2:.1f} "
        "{3}\">\n",
        left_, top - 4, width - left_ - right + 4, height - foot - top + 8);
    for (const bool greyed : {true, false})
      for (const Series& s : c_.series) {
        if (s.greyed != greyed) continue;
        if (!s.lower.empty()) out += band(s);
        if (s.line)
          if (const std::string d = path_of(s, s.y); !d.empty())
            out += fmt::format("<path class=\"line {}\" d=\"{}\"/>\n", look(s), d);
        for (std::size_t k = 0; k < s.error.size(); ++k)
          if (can_show(s.x[k], s.y[k]) && s.error[k] > 0) {
            const double below = s.y[k] - s.error[k];
            out += fmt::format("<path class=\"line thin {}\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", look(s),
                               px(s.x[k]), py(s.y[k] + s.error[k]), y_.can_show(below) ? py(below) : height);
          }
        for (std::size_t k = 0; s.mark != Mark::none && k < s.x.size(); ++k)
          if (can_show(s.x[k], s.y[k])) out += mark(s, px(s.x[k]), py(s.y[k]));
      }
    return out + "</svg>\n<circle class=\"here\" r=\"5\" visibility=\"hidden\"/>\n";
  }

  std::string band(const Series& s) const {
    std::string there, back;
    for (std::size_t k = 0; k < s.x.size(); ++k)
      if (can_show(s.x[k], s.upper[k])) {
        there += (there.empty() ? 'M' : 'L') + point(px(s.x[k]), py(s.upper[k]));
        back = 'L' + point(px(s.x[k]), y_.can_show(s.lower[k]) ? py(s.lower[k]) : height - foot) + back;
      }
    return there.empty() ? "" : fmt::format("<path class=\"band {}\" d=\"{}{}Z\"/>\n", look(s), there, back);
  }

  static std::string mark(const Series& s, double x, double y) {
    const std::string d = s.mark == Mark::square     ? "m-4-4h8v8h-8z"
                          : s.mark == Mark::diamond  ? "m0-6l6 6l-6 6l-6-6z"
                          : s.mark == Mark::triangle ? "m0-6l5.5 9.5h-11z"
                                                     : "m-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0-9 0z";
    return fmt::format("<path class=\"{} {}\" d=\"M{}{}\"/>\n", s.mark == Mark::ring ? "line" : "dot",
                       look(s), point(x, y), d);
  }

  std::string legend() const {
    std::string out;
    for (const Series& s : c_.series) {
      if (s.name.empty()) continue;
      out += "<li><svg viewBox=\"0 0 34 14\" aria-hidden=\"true\">";
      if (!s.lower.empty()) out += fmt::format("<path class=\"band {}\" d=\"M2 2H32V12H2Z\"/>", look(s));
      if (s.line) out += fmt::format("<path class=\"line {}\" d=\"M2 7H32\"/>", look(s));
      if (s.mark != Mark::none) out += mark(s, 17, 7);
      out += fmt::format("</svg>{}</li>", html_text(s.name));
    }
    return out.empty() ? out : fmt::format("<ul class=\"legend\">{}</ul>\n", out);
  }

  /// What a reader sees beside the pointer: places in the picture, values.
  std::string data() const {
    std::vector<std::string> series;
    for (const Series& s : c_.series) {
      std::vector<std::string> points;
      for (const std::size_t k : thinned(s.y))
        if (k < s.x.size() && can_show(s.x[k], s.y[k]))
          points.push_back(
              fmt::format("[{:.1f},{:.1f},{:.6g},{:.6g}]", px(s.x[k]), py(s.y[k]), s.x[k], s.y[k]));
      series.push_back(fmt::format("{{\"name\":{},\"points\":{}}}", json_string(s.name), json_array(points)));
    }
    const std::string json = fmt::format("{{\"x\":{},\"y\":{},\"series\":{}}}", json_string(c_.x.title),
                                         json_string(c_.y.title), json_array(series));
    std::string safe;  // "</script>" of a name must not end the script
    for (const char c : json) safe += c == '<' ? "\\u003c" : std::string(1, c);
    return safe;
  }

  const Chart& c_;
  Scale x_, y_;
  std::vector<Tick> x_ticks_, y_ticks_;
  double left_ = 0;
};

}  // namespace

std::string svg_figure(const Chart& chart) { return SvgChart(chart, scales_of(chart)).figure(); }

}  // namespace hourglass
