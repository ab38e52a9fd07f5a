// Solids in messages: their sizes, the gaps between them, and by flood fill the ways that they leave to grains.
#include <array>
#include <limits>
#include <optional>

#include "solver/scene_checks.hpp"
#include "solver/solids.hpp"

namespace hourglass {

namespace {

using Point = std::array<double, 2>;

/// The shortest way between two things.
struct Way {
  double length = std::numeric_limits<double>::infinity();
  Point from{}, to{};
};

Way way(const Point& p, const Point& a, const Point& b) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], square = ux * ux + uy * uy;
  const double t = square > 0 ? std::clamp(((p[0] - a[0]) * ux + (p[1] - a[1]) * uy) / square, 0.0, 1.0) : 0;
  const Point foot{a[0] + t * ux, a[1] + t * uy};
  return {std::hypot(p[0] - foot[0], p[1] - foot[1]), p, foot};
}

bool cross_each_other(const Point& a, const Point& b, const Point& c, const Point& d) {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

/// Between two edges.
Way way(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (cross_each_other(a, b, c, d)) {
    const double t = turn(c, d, a) / (turn(c, d, a) - turn(c, d, b));
    const Point at{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
    return {0, at, at};
  }
  const auto less = [](const Way& one, const Way& other) { return one.length < other.length; };
  return std::min({way(a, c, d), way(b, c, d), way(c, a, b), way(d, a, b)}, less);
}

bool contains(const Polygon& polygon, const Point& p) {
  bool inside = false;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
      inside = !inside;
  }
  return inside;
}

/// Between two polygons, also of one corner or two.
Way way(const Polygon& a, const Polygon& b) {
  if (contains(a, b[0]) || contains(b, a[0])) return {0, a[0], b[0]};
  Way shortest;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Way one = way(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()]);
      if (one.length < shortest.length) shortest = one;
    }
  return shortest;
}

/// A solid as all points within `radius` of a polygon: a circle's is its centre, so that distances are exact.
struct Body {
  std::string path;
  Polygon core;
  double radius = 0;
  bool hopper = false;
  Point low{}, high{};  ///< bounding box

  Body(std::string at, Polygon polygon, double r, bool of_hopper)
      : path(std::move(at)), core(std::move(polygon)), radius(r), hopper(of_hopper), low(core[0]),
        high(core[0]) {
    for (const Point& p : core)
      for (int axis = 0; axis < 2; ++axis)
        low[axis] = std::min(low[axis], p[axis] - radius),
        high[axis] = std::max(high[axis], p[axis] + radius);
  }
  Body moved(double x) const {
    Polygon there = core;
    for (Point& p : there) p[0] += x;
    return {path, std::move(there), radius, hopper};
  }
  bool contains_point(const Point& p, double tolerance) const {
    return way(core, {p}).length <= radius + tolerance;
  }
};

/// The gap between two bodies, from surface to surface, if it is below `limit`; not above zero if they overlap.
Way gap(const Body& a, const Body& b, double limit) {
  for (int axis = 0; axis < 2; ++axis)
    if (a.low[axis] > b.high[axis] + limit || b.low[axis] > a.high[axis] + limit) return {};
  Way between = way(a.core, b.core);
  const double length = between.length;
  const auto shorten = [&](Point& end, const Point& other, double by) {
    for (int axis = 0; axis < 2 && length > 0; ++axis) end[axis] += by / length * (other[axis] - end[axis]);
  };
  const Point from = between.from;
  shorten(between.from, between.to, a.radius);
  shorten(between.to, from, b.radius);
  between.length -= a.radius + b.radius;
  return between;
}

/// Least distance of two parallel lines that have the polygon between them, one along an edge.
double narrowest(const Polygon& polygon) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    double low = 0, high = 0;
    for (const Point& p : polygon) low = std::min(low, turn(a, b, p)), high = std::max(high, turn(a, b, p));
    if (a != b) least = std::min(least, (high - low) / std::hypot(b[0] - a[0], b[1] - a[1]));
  }
  return least;
}

/// Where a polygon crosses or touches itself.
std::optional<Point> crossing(const Polygon& p, double tolerance) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    if (way(c, a, b).length <= tolerance || way(a, b, c).length <= tolerance) return c;
    for (std::size_t j = i + 2; j < n && j + 1 < n + i; ++j)
      if (const Way one = way(a, b, p[j], p[(j + 1) % n]); one.length <= tolerance) return one.to;
  }
  return std::nullopt;
}

bool check_insert(const Scene& s, std::size_t k, bool domain_sound, Problems& p) {
  const Insert& insert = s.inserts[k];
  const std::string path = fmt::format("inserts.{}", k);
  const auto finite = [](const Point& a) { return std::isfinite(a[0]) && std::isfinite(a[1]); };
  const bool circle = insert.shape == Shape::circle, square = insert.shape == Shape::square;
  if (insert.shape == Shape::polygon) {
    if (insert.points.size() < 3 || insert.points.size() > 1000) {
      p.error(path + ".points", fmt::format("has {} corners (3 to 1000).", insert.points.size()));
      return false;
    }
    if (!std::all_of(insert.points.begin(), insert.points.end(), finite)) {
      p.error(path + ".points", "has a corner that is not finite.");
      return false;
    }
  } else {
    if (!finite(insert.centre)) p.error(path + ".centre", "is not finite.");
    if (square && insert.height != 0 && insert.height != insert.width)
      p.error(path + ".height",
              fmt::format("{} is not the width, {}. Use shape rectangle.", insert.height, insert.width));
  }
  if (!p.is_sound(path) || !domain_sound) return false;

  const Polygon outline = outline_of(insert);
  const double h = s.width / s.cells_x;
  if (insert.shape == Shape::polygon)
    if (const auto at = crossing(outline, 1e-9 * s.width)) {
      p.error(path + ".points", fmt::format("crosses or touches itself at [{:.6g}, {:.6g}]. Give the corners "
                                            "in order around it, each once.",
                                            (*at)[0], (*at)[1]));
      return false;
    }
  const double across = circle ? insert.width : narrowest(outline);
  if (across < (2 - edge_tolerance) * h)
    p.error(path, fmt::format("is {:.3g} cells across (must be at least 2). Use {}, or make it larger.",
                              across / h, cells_for(s, across, 2, "a finer grid")));
  else if (area(part_in(outline, 0, 0, s.width, s.height)) <= 1e-12 * s.width * s.height)
    p.error(path, fmt::format("lies outside the domain (x 0 to {}, y 0 to {}). Move it inside, or remove it.",
                              s.width, s.height));
  return p.is_sound(path);
}

void check_coverage(const Scene& s, const Body& body, Problems& p) {
  const double tolerance = 1e-9 * s.width;
  for (std::size_t k = 0; k < s.orifices.size(); ++k) {
    const Orifice& o = s.orifices[k];
    if (!p.is_sound(fmt::format("orifices.{}", k)) || (body.hopper && o.wall == Side::bottom)) continue;
    const bool vertical = o.wall == Side::left || o.wall == Side::right;
    const double low = std::max(0.0, o.centre - o.width / 2), high = o.centre + o.width / 2;
    const double across = o.wall == Side::right ? s.width : o.wall == Side::top ? s.height : 0;
    const auto at = [&](double along) { return vertical ? Point{across, along} : Point{along, across}; };
    // A solid may stand at the end of an opening.
    const Polygon opening{at(low + 2 * tolerance), at(high - 2 * tolerance)};
    if (way(body.core, opening).length <= body.radius + tolerance)
      p.error(body.path, fmt::format("covers the opening of orifices.{} ({}, {:.6g} to {:.6g}). Move one of "
                                     "them; they may touch.",
                                     k, side_names[static_cast<int>(o.wall)], low, high));
  }
}

/// Gaps that are there but too thin for the grid.
void check_gaps(const Scene& s, const std::vector<Body>& bodies, Problems& p) {
  const double h = s.width / s.cells_x, least = (2 - edge_tolerance) * h, touching = 1e-9 * s.width;
  const auto report = [&](const Body& body, const Way& between, double size, const std::string& other) {
    if (size <= touching || size >= least) return;
    const Point middle{(between.from[0] + between.to[0]) / 2, (between.from[1] + between.to[1]) / 2};
    for (const Body& b : bodies)
      if (b.contains_point(middle, touching)) return;  // the gap is filled
    p.error(body.path,
            fmt::format("the gap to {} is {:.3g} cells wide (must be at least 2, or closed). Use {}, "
                        "move it away, or let them touch.",
                        other, size / h, cells_for(s, size, 2, "a finer grid")));
  };
  const bool periodic = s.wall(Side::left) == Wall::periodic && s.wall(Side::right) == Wall::periodic;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Body& body = bodies[k];
    if (body.hopper) continue;
    for (std::size_t other = 0; other < bodies.size(); ++other) {
      if (other >= k && !bodies[other].hopper) continue;  // each pair once, at its later insert
      const Way between = gap(body, bodies[other], least);
      report(body, between, between.length, bodies[other].hopper ? "the hopper" : bodies[other].path);
    }
    if (periodic)
      for (std::size_t other = 0; other < bodies.size(); ++other)
        for (const double shift : {-s.width, s.width}) {
          if (other > k || (other == k && shift < 0)) continue;
          const Way between = gap(body, bodies[other].moved(shift), least);
          report(body, between, between.length,
                 other == k ? "itself across the periodic side" : bodies[other].path);
        }
    const std::array<double, 4> to_side{body.low[0], s.width - body.high[0], body.low[1],
                                        s.height - body.high[1]};
    for (std::size_t side = 0; side < 4; ++side) {
      if (s.walls[side] != Wall::no_slip && s.walls[side] != Wall::free_slip) continue;
      const int axis = side < 2 ? 0 : 1;
      const bool high = side % 2 == 1, middle = side == 0 && s.left_is_middle();
      const auto nearest = std::min_element(
          body.core.begin(), body.core.end(),
          [&](const Point& a, const Point& b) { return high ? a[axis] > b[axis] : a[axis] < b[axis]; });
      Way between{to_side[side], *nearest, *nearest};
      between.from[axis] += high ? body.radius : -body.radius;
      between.to[axis] = high ? (axis == 0 ? s.width : s.height) : 0;
      report(body, between, (middle ? 2 : 1) * to_side[side],
             middle ? "its mirror image" : fmt::format("the {} wall", side_names[side]));
    }
  }
}

/// Free cells, joined where nothing solid lies between the centres of neighbours.
class Ways {
 public:
  struct Region {
    bool opening = false;
    bool way_out = false;  ///< an opening that gravity does not keep grains from
    long cells = 0, grains = 0;
    Point inside{};
  };

  explicit Ways(const Scene& scene)
      : s_(scene), patch_(scene.patch()), solid_(patch_.cells()), wall_{solid_, solid_},
        region_(patch_.cells(), -1) {
    for (const Polygon& piece : solids_of(scene))
      for (int axis = 0; axis < 2; ++axis) mark(piece, axis);
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i)
        if (!solid_[at(i, j)] && region_[at(i, j)] < 0) flood(i, j);
    for (std::size_t side = 0; side < 4; ++side)
      if (s_.walls[side] == Wall::open)
        open(static_cast<Side>(side), -1, std::numeric_limits<double>::infinity(),
             leaves_over(s_, static_cast<Side>(side)));
    for (const Orifice& o : s_.orifices) open(o.wall, o.centre - o.width / 2, o.centre + o.width / 2, true);
  }

  /// Whether grains have a way to this orifice.
  bool feeds(const Orifice& o) {
    bool fed = false;
    each_along(o.wall, o.centre - o.width / 2, o.centre + o.width / 2,
               [&](Region& r) { fed |= r.grains > 0; });
    return fed;
  }
  const std::vector<Region>& regions() const { return regions_; }
  double cell_area() const { return patch_.h * patch_.h; }

 private:
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * patch_.nx + i; }

  /// What a convex polygon covers of the lines through cell centres along one axis.
  void mark(const Polygon& piece, int axis) {
    const double h = patch_.h, tolerance = 1e-9 * s_.width;
    const int lines = axis == 0 ? patch_.ny : patch_.nx, cells = axis == 0 ? patch_.nx : patch_.ny;
    std::vector<Point> covered(
        lines, {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()});
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const Point *a = &piece[k], *b = &piece[(k + 1) % piece.size()];
      const int across = 1 - axis;
      if ((*a)[across] > (*b)[across]) std::swap(a, b);
      const double rise = (*b)[across] - (*a)[across];
      const int first = first_centre((*a)[across] - tolerance, lines),
                last = last_centre((*b)[across] + tolerance, lines);
      for (int line = first; line <= last; ++line) {
        const double t = rise > 0 ? std::clamp(((line + 0.5) * h - (*a)[across]) / rise, 0.0, 1.0) : 0;
        const double x = (*a)[axis] + t * ((*b)[axis] - (*a)[axis]), other = rise > 0 ? x : (*b)[axis];
        covered[line] = {std::min({covered[line][0], x, other}), std::max({covered[line][1], x, other})};
      }
    }
    for (int line = 0; line < lines; ++line) {
      if (covered[line][0] > covered[line][1]) continue;
      const double low = covered[line][0] - tolerance, high = covered[line][1] + tolerance;
      const auto cell = [&](int k) { return axis == 0 ? at(k, line) : at(line, k); };
      for (int k = first_centre(low, cells); k <= last_centre(high, cells); ++k) solid_[cell(k)] = 1;
      for (int k = first_centre(low - h, cells); k <= last_centre(high, cells); ++k) wall_[axis][cell(k)] = 1;
    }
  }
  /// The first and the last cell whose centre lies at or beyond, at or before x.
  int first_centre(double x, int n) const {
    return static_cast<int>(std::ceil(std::clamp(x / patch_.h - 0.5, 0.0, static_cast<double>(n))));
  }
  int last_centre(double x, int n) const {
    return static_cast<int>(std::floor(std::clamp(x / patch_.h - 0.5, -1.0, n - 1.0)));
  }

  void flood(int i0, int j0) {
    const int number = static_cast<int>(regions_.size());
    Region region;
    region.inside = {patch_.x_centre(i0), patch_.y_centre(j0)};
    const bool periodic = s_.wall(Side::left) == Wall::periodic;
    std::vector<std::array<int, 2>> front{{i0, j0}};
    region_[at(i0, j0)] = number;
    const auto enter = [&](int i, int j, bool blocked) {
      if (blocked || solid_[at(i, j)] || region_[at(i, j)] >= 0) return;
      region_[at(i, j)] = number;
      front.push_back({i, j});
    };
    while (!front.empty()) {
      const auto [i, j] = front.back();
      front.pop_back();
      ++region.cells;
      const double y = patch_.y_centre(j);
      region.grains += painted(s_, patch_.x_centre(i), y) >= 0 || (s_.feed && y < s_.feed->level);
      if (i + 1 < patch_.nx) enter(i + 1, j, wall_[0][at(i, j)]);
      if (i > 0) enter(i - 1, j, wall_[0][at(i - 1, j)]);
      if (j + 1 < patch_.ny) enter(i, j + 1, wall_[1][at(i, j)]);
      if (j > 0) enter(i, j - 1, wall_[1][at(i, j - 1)]);
      if (periodic && i == 0) enter(patch_.nx - 1, j, false);
      if (periodic && i + 1 == patch_.nx) enter(0, j, false);
    }
    regions_.push_back(region);
  }

  template <class Visit>
  void each_along(Side side, double from, double to, Visit&& visit) {
    const bool vertical = side == Side::left || side == Side::right;
    const int n = vertical ? patch_.ny : patch_.nx;
    const int row = side == Side::right ? patch_.nx - 1 : side == Side::top ? patch_.ny - 1 : 0;
    for (int k = first_centre(from, n); k <= last_centre(to, n); ++k) {
      const int region = region_[vertical ? at(row, k) : at(k, row)];
      if (region >= 0) visit(regions_[region]);
    }
  }
  void open(Side side, double from, double to, bool way_out) {
    each_along(side, from, to, [&](Region& r) { r.opening = true, r.way_out |= way_out; });
  }

  const Scene& s_;
  Patch patch_;
  std::vector<char> solid_;                // by cell
  std::array<std::vector<char>, 2> wall_;  // between a cell and the next one along x, along y
  std::vector<int> region_;                // by cell; -1: solid
  std::vector<Region> regions_;
};

void check_ways(const Scene& s, Problems& p) {
  Ways ways(s);
  const char* cause = s.inserts.empty() ? "hopper" : "inserts";
  const auto larger = [](const Ways::Region& a, const Ways::Region& b) { return a.cells < b.cells; };
  const auto largest = std::max_element(ways.regions().begin(), ways.regions().end(), larger);
  bool opening = false, way_out = false, opened = false, led_out = false;
  long grains = 0, kept = 0, cut_off = 0;  // cells
  const Ways::Region* pocket = nullptr;
  for (const Ways::Region& r : ways.regions()) {
    opening |= r.opening, way_out |= r.way_out;
    opened |= r.opening && r.grains > 0, led_out |= r.way_out && r.grains > 0;
    grains += r.grains;
  }
  if (grains == 0) {
    p.error("fill", "all of its grains lie inside of solids. Move it, or the solids.");
    return;
  }
  bool starved = false;
  for (std::size_t k = 0; k < s.orifices.size(); ++k)
    if (!ways.feeds(s.orifices[k])) {
      p.error(
          fmt::format("orifices.{}", k),
          "is cut off from all grains by solids (a way at least 2 cells wide has to lead to it). Move the "
          "solids apart.");
      starved = true;
    }
  if (starved) return;
  if ((opening && !opened) || (way_out && !led_out)) {
    p.error(cause,
            "close the silo: grains have no way to an orifice or an open side (at least 2 cells wide). "
            "Move the solids apart.");
    return;
  }
  for (const Ways::Region& r : ways.regions()) {
    if (r.cells < 4) continue;  // the end of a wedge
    if (opening ? r.opening : &r == &*largest) {
      if (!r.way_out) kept += r.grains;
    } else {
      cut_off += r.cells;
      if (!pocket || larger(*pocket, r)) pocket = &r;
    }
  }
  if (way_out && kept > 0)
    p.warn(cause, fmt::format("{:.0f} % of the grains have no way out: solids are between them and every {}.",
                              100.0 * kept / grains, s.orifices.empty() ? "open side" : "orifice"));
  if (pocket)
    p.warn(cause,
           fmt::format("an area of {:.4g} about [{:.4g}, {:.4g}] is cut off from {} and treated as solid.",
                       cut_off * ways.cell_area(), pocket->inside[0], pocket->inside[1],
                       opening ? "every opening" : "the rest of the domain"));
}

}  // namespace

void check_solids(const Scene& s, bool domain_sound, Problems& p) {
  std::vector<Body> bodies;
  bool sound = domain_sound && p.is_sound("domain");
  for (std::size_t k = 0; k < s.inserts.size(); ++k) {
    if (!check_insert(s, k, domain_sound, p)) {
      sound = false;
      continue;
    }
    const Insert& insert = s.inserts[k];
    const bool circle = insert.shape == Shape::circle;
    bodies.emplace_back(fmt::format("inserts.{}", k), circle ? Polygon{insert.centre} : outline_of(insert),
                        circle ? insert.width / 2 : 0, false);
  }
  if (domain_sound && p.is_sound("hopper"))
    for (Polygon& wall : hopper_walls(s)) bodies.emplace_back("hopper", std::move(wall), 0, true);
  if (bodies.empty()) return;
  for (const Body& body : bodies) check_coverage(s, body, p);
  check_gaps(s, bodies, p);
  for (const char* path : {"inserts", "hopper", "orifices", "fill", "walls", "feed", "materials"})
    sound &= p.is_sound(path);
  if (sound) check_ways(s, p);
}

}  // namespace hourglass
