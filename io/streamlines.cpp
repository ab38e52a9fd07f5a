#include "io/streamlines.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hourglass {
namespace {

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }
Point moved(const Point& p, const Point& e, double by) { return {p[0] + by * e[0], p[1] + by * e[1]}; }

/// The points of all lines so far, in boxes of the spacing.
class Neighbours {
 public:
  Neighbours(const StreamlineField& field, double spacing)
      : spacing_(spacing), across_(static_cast<int>(field.width / spacing) + 1),
        up_(static_cast<int>(field.height / spacing) + 1), boxes_(std::size_t(across_) * up_) {}
  void add(const Polygon& line) {
    for (const Point& p : line) boxes_[std::size_t(row(p)) * across_ + column(p)].push_back(p);
  }
  /// reach: at most the spacing.
  bool within(double reach, const Point& p) const {
    for (int b = std::max(row(p) - 1, 0); b <= std::min(row(p) + 1, up_ - 1); ++b) {
      for (int a = std::max(column(p) - 1, 0); a <= std::min(column(p) + 1, across_ - 1); ++a) {
        for (const Point& q : boxes_[std::size_t(b) * across_ + a])
          if (distance(p, q) < reach) return true;
      }
    }
    return false;
  }

 private:
  int column(const Point& p) const { return std::clamp(static_cast<int>(p[0] / spacing_), 0, across_ - 1); }
  int row(const Point& p) const { return std::clamp(static_cast<int>(p[1] / spacing_), 0, up_ - 1); }

  double spacing_;
  int across_, up_;
  std::vector<Polygon> boxes_;
};

class Tracer {
 public:
  Tracer(const StreamlineField& field, double spacing)
      : field_(field), spacing_(spacing), step_(std::min(0.25, spacing / 8)), near_(field, spacing) {}

  std::vector<Polygon> lines() {
    // From the middle outwards, so that the lines of a symmetric flow are nearly symmetric.
    Polygon seeds;
    for (double y = spacing_ / 2; y < field_.height; y += spacing_) {
      for (double x = field_.width / 2; x < field_.width; x += spacing_) {
        seeds.push_back({x, y});
        seeds.push_back({field_.width - x, y});
      }
    }
    const Point middle{field_.width / 2, field_.height / 2};
    std::stable_sort(seeds.begin(), seeds.end(), [&](const Point& a, const Point& b) {
      return distance(a, middle) < distance(b, middle);
    });
    std::size_t grown = 0;
    for (const Point& seed : seeds) {
      try_from(seed);
      for (; grown < lines_.size(); ++grown) {  // lines grow while we look at them
        const Polygon line = lines_[grown];
        const std::size_t stride = std::max<std::size_t>(1, std::lround(spacing_ / 2 / step_));
        for (std::size_t k = 0; k < line.size(); k += stride) {
          const auto e = direction(line[k]);
          if (!e) continue;
          for (const double side : {1.0, -1.0})
            try_from(moved(line[k], {-(*e)[1], (*e)[0]}, side * spacing_));
        }
      }
    }
    return lines_;
  }

 private:
  bool inside(const Point& p) const {
    return p[0] >= 0 && p[0] <= field_.width && p[1] >= 0 && p[1] <= field_.height && field_.flows(p);
  }
  std::optional<Point> direction(const Point& p) const {
    if (!inside(p)) return {};
    const Point v = field_.velocity(p);
    const double speed = std::hypot(v[0], v[1]);
    if (!(speed > field_.least_speed) || !std::isfinite(speed)) return {};
    return Point{v[0] / speed, v[1] / speed};
  }
  /// A step of the classical Runge-Kutta method along the direction.
  std::optional<Point> next(const Point& p, double by) const {
    const auto a = direction(p);
    if (!a) return {};
    const auto b = direction(moved(p, *a, by / 2));
    if (!b) return {};
    const auto c = direction(moved(p, *b, by / 2));
    if (!c) return {};
    const auto d = direction(moved(p, *c, by));
    if (!d) return {};
    Point sum = p;
    for (int k = 0; k < 2; ++k) sum[k] += by / 6 * ((*a)[k] + 2 * (*b)[k] + 2 * (*c)[k] + (*d)[k]);
    return inside(sum) ? std::optional(sum) : std::nullopt;
  }
  Polygon trace(const Point& seed, double by) const {
    Polygon line;
    const auto most = static_cast<std::size_t>(4 * (field_.width + field_.height) / step_);
    for (auto p = next(seed, by); p && line.size() < most && !near_.within(spacing_ / 2, *p);
         p = next(*p, by)) {
      line.push_back(*p);
      if (line.size() * step_ > spacing_ && distance(*p, seed) < step_) break;  // closed
    }
    return line;
  }
  void try_from(const Point& seed) {
    if (!direction(seed) || near_.within(0.99 * spacing_, seed)) return;
    Polygon line = trace(seed, -step_);
    std::reverse(line.begin(), line.end());
    line.push_back(seed);
    const Polygon rest = trace(seed, step_);
    line.insert(line.end(), rest.begin(), rest.end());
    if (line.size() * step_ < 2 * spacing_) return;
    near_.add(line);
    lines_.push_back(std::move(line));
  }

  const StreamlineField& field_;
  double spacing_, step_;
  Neighbours near_;
  std::vector<Polygon> lines_;
};

}  // namespace

std::vector<Polygon> streamlines(const StreamlineField& field, double spacing) {
  return Tracer(field, spacing).lines();
}

}  // namespace hourglass
