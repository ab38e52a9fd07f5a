#include "solver/scene.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "kernels/polygon.hpp"
#include "solver/scene_checks.hpp"
#include "solver/simulation.hpp"

namespace hourglass {

Patch Scene::patch() const {
  const double h = width / cells_x;
  return {cells_x, static_cast<int>(std::lround(height / h)), h, 0, 0};
}

Scales scales(const Scene& scene) {
  const Material grain = scene.materials.empty() ? Material{} : scene.materials.front();
  const double d = grain.diameter, rho = grain.density;
  const double g = scene.g();
  const double time = std::sqrt(d / g);
  return {d, time, rho, rho * std::sqrt(g * d * d * d), d / time};
}

Grain grain_of(const Material& m) { return {m.mu_s, m.delta_mu, m.I_0, m.diameter, m.density, m.cohesion}; }

std::optional<std::array<double, 2>> well_posed_range(const Material& m) {
  const Grain grain = grain_of(m);
  const auto is_well_posed = [&](double log_I) { return well_posedness(std::exp(log_I), grain) <= 0; };
  const auto edge = [&](double outside, double inside) {  // by bisection
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (outside + inside);
      (is_well_posed(middle) ? inside : outside) = middle;
    }
    return std::exp(inside);
  };
  const double first = std::log(1e-9 * m.I_0), last = std::log(1e6 * m.I_0);
  const int points = 4000;
  const auto log_I = [&](int k) { return first + (last - first) * k / points; };
  int low = 0, high = points;
  while (low <= points && !is_well_posed(log_I(low))) ++low;
  if (low > points) return std::nullopt;
  while (!is_well_posed(log_I(high))) --high;
  return std::array{low == 0 ? 0.0 : edge(log_I(low - 1), log_I(low)),
                    high == points ? INFINITY : edge(log_I(high + 1), log_I(high))};
}

std::optional<RegularisedFriction> regularised_friction(const Material& m, const Rheology& rheology) {
  const auto range = well_posed_range(m);
  if (!range || (*range)[0] <= 0) return std::nullopt;
  RegularisedFriction r{(*range)[0], 0, rheology.alpha, rheology.mu_inf};
  const double mu = r.mu_beyond(r.I_1, grain_of(m));
  r.log_A = std::log(r.I_1) + r.alpha / (mu * mu);
  return r;
}

namespace {

constexpr double bytes_per_cell = 600;    // of everything that a run allocates, about
constexpr long coarsest_cells = 32 * 32;  // the multigrid solves its coarsest level directly

/// The multigrid's coarsest grid (solver/multigrid.hpp).
std::array<int, 2> coarsest(int nx, int ny) {
  while (nx % 2 == 0 && ny % 2 == 0 && nx >= 4 && ny >= 4) nx /= 2, ny /= 2;
  return {nx, ny};
}

bool is_whole(double x) { return std::abs(x - std::round(x)) <= edge_tolerance; }

bool coarsens(int nx, int ny) {
  const auto [cx, cy] = coarsest(nx, ny);
  return static_cast<long>(cx) * cy <= coarsest_cells;
}

/// The first count that suits from `start` on, in steps of +1 or -1; 0 if there is none near.
int nearest_count(const Scene& s, int start, int step) {
  for (int n = start; n >= 2 && std::abs(n - start) < 4096; n += step)
    if (suits(s, n)) return n;
  return 0;
}

/// The cure for a grid that does not come out: counts next to the present one, else heights.
std::string better_grid(const Scene& s, double cells_y) {
  std::string cure;
  const auto offer = [&](const std::string& word) { cure += (cure.empty() ? "Use " : " or ") + word; };
  for (const int step : {-1, +1})
    if (const int n = nearest_count(s, s.cells_x + step, step)) offer(fmt::format("cells_x {}", n));
  for (const int step : {-1, +1}) {
    int ny = static_cast<int>(step < 0 ? std::floor(cells_y) : std::ceil(cells_y));
    while (ny > 1 && std::abs(ny - cells_y) < 0.1 * cells_y + 1 && !coarsens(s.cells_x, ny)) ny += step;
    if (ny > 1 && coarsens(s.cells_x, ny)) offer(fmt::format("height {:.12g}", ny * s.width / s.cells_x));
  }
  return cure.empty() ? "Choose a height with a simple ratio to the width." : cure + ".";
}

/// Whether the grid is sound enough for checks that need cells.
bool check_domain(const Scene& s, Problems& p) {
  for (const double g : s.gravity)
    if (!std::isfinite(g)) p.error("gravity", fmt::format("{} is not finite.", g));
  if (!p.is_sound("domain") || !p.is_sound("grid")) return false;

  const double h = s.width / s.cells_x, cells_y = s.height / h;
  const double bytes = bytes_per_cell * s.cells_x * cells_y;
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  if (bytes > memory) {
    const int fitting = static_cast<int>(std::min(1e6, s.cells_x * std::sqrt(memory / bytes)));
    const int best = nearest_count(s, fitting, -1);
    p.error(
        "grid.cells_x",
        fmt::format("{} x {:.0f} cells need about {:.3g} GB ({} bytes a cell); this machine has "
                    "{:.3g} GB. Use cells_x <= {}.",
                    s.cells_x, cells_y, bytes * 1e-9, bytes_per_cell, memory * 1e-9, best ? best : fitting));
    return false;
  }
  if (!is_whole(cells_y) || cells_y < 1.5) {
    p.error("domain.height",
            fmt::format(
                "{} is {:.6g} cells of side {:.6g} (the height must come out whole, at least 2 cells). {}",
                s.height, cells_y, h, better_grid(s, cells_y)));
    return false;
  }
  const int ny = static_cast<int>(std::lround(cells_y));
  if (s.model == Model::mu_I && !coarsens(s.cells_x, ny)) {  // others solve nothing on it
    const auto [cx, cy] = coarsest(s.cells_x, ny);
    p.error(
        "grid.cells_x",
        fmt::format("{} x {} cells can be halved only to {} x {} (multigrid must come down to {} cells or "
                    "fewer). {}",
                    s.cells_x, ny, cx, cy, coarsest_cells, better_grid(s, cells_y)));
  }
  return true;
}

void check_well_posed(const Scene& s, const Material& m, const std::string& path, Problems& p) {
  if (m.delta_mu == 0)
    p.warn(path + ".delta_mu",
           m.mu_s == 0 ? "with mu_s = 0 too these grains have no friction at all."
                       : "0 makes the friction constant: this is Coulomb, without rate dependence.");
  if (m.mu_s == 0 && m.delta_mu == 0) return;
  if (well_posed_range(m)) return;
  const std::string cause = fmt::format(
      "mu(I) with mu_s = {}, delta_mu = {} is ill-posed at every I (Barker et al. "
      "2015): short waves grow with the number of steps.",
      m.mu_s, m.delta_mu);
  p.warn(
      path,
      s.rheology.smoothing_length > 0
          ? fmt::format("{} physics.rheology.smoothing_length = {} is what keeps the run independent of the "
                        "step.",
                        cause, s.rheology.smoothing_length)
          : cause +
                " With physics.rheology.smoothing_length = 0 nothing holds them: static zones, pressures "
                "and patterns will depend on grid and step. Use one grain diameter.");
}

void check_materials(const Scene& s, Problems& p) {
  if (s.materials.empty())
    p.error("materials",
            "there is no material (at least one). "
            "Add e.g. sand: {mu_s: 0.62, delta_mu: 0.48, I_0: 0.6, diameter: 1, density: 1}.");
  for (std::size_t k = 0; k < s.materials.size(); ++k) {
    const Material& m = s.materials[k];
    const std::string path = "materials." + m.name;
    const bool plain = !m.name.empty() && std::all_of(m.name.begin(), m.name.end(), [](unsigned char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!plain || (m.name[0] >= '0' && m.name[0] <= '9') || m.name == "air")
      p.error(path,
              fmt::format("'{}' cannot name a material (letters, digits and _, a letter first; not 'air'). "
                          "Its name heads columns of series.csv.",
                          m.name));
    for (std::size_t other = 0; other < k; ++other)
      if (s.materials[other].name == m.name) p.error(path, "two materials have this name. Rename one.");
    const bool sound =
        p.is_sound(path + ".mu_s") && p.is_sound(path + ".delta_mu") && p.is_sound(path + ".I_0");
    const auto of_module = [&](const char* key, const std::optional<double>& value, bool named,
                               const char* module) {
      if (value && !named)
        p.warn(path + "." + key, fmt::format("is not used: the scene does not name physics.{}.", module));
    };
    of_module("A", m.A, s.nonlocal.has_value(), "nonlocal");
    of_module("phi_g", m.phi_g, s.dilatancy.has_value(), "dilatancy");
    of_module("F", m.F, s.wall_friction.has_value(), "wall_friction");
    if (s.rheology.law == Law::mu_I_regularised && sound) {
      if (!regularised_friction(m, s.rheology))
        p.error(path,
                fmt::format(
                    "law mu_I_regularised has no solution for mu_s = {}, delta_mu = {} (mu(I) must be well "
                    "posed at some I: mu_s below about 0.59). Use law mu_I with smoothing_length, or "
                    "physics.nonlocal.",
                    m.mu_s, m.delta_mu));
    } else if (s.rheology.law == Law::newtonian) {
      p.require(above(0), path + ".viscosity", m.viscosity, "Law newtonian takes it from here.");
    } else {
      if (m.viscosity != 0) p.warn(path + ".viscosity", "is not used: only law newtonian reads it.");
      if (sound && s.model == Model::mu_I) check_well_posed(s, m, path, p);
    }
  }
  if (p.is_sound("air.density") && !s.materials.empty() && s.materials[0].density > 0 &&
      s.air.density >= s.materials[0].density)
    p.warn("air.density",
           fmt::format("{} is not below the grains' density {}.", s.air.density, s.materials[0].density));
}

/// Corners turn one way only, and once around.
bool is_convex(const std::vector<std::array<double, 2>>& points) {
  const std::size_t n = points.size();
  double turned = 0, sense = twice_signed_area(points) > 0 ? 1 : -1;
  for (std::size_t k = 0; k < n; ++k) {
    const auto [ax, ay] = points[k];
    const auto [bx, by] = points[(k + 1) % n];
    const auto [cx, cy] = points[(k + 2) % n];
    const double ux = bx - ax, uy = by - ay, vx = cx - bx, vy = cy - by;
    const double angle = sense * std::atan2(ux * vy - uy * vx, ux * vx + uy * vy);
    if (angle < -1e-9) return false;
    turned += angle;
  }
  return std::abs(turned - 2 * M_PI) < 1e-6;
}

bool contains(const Fill& fill, double x, double y) {
  const double sense = twice_signed_area(fill.points) > 0 ? 1 : -1;
  for (std::size_t k = 0; k < fill.points.size(); ++k) {
    const auto [ax, ay] = fill.points[k];
    const auto [bx, by] = fill.points[(k + 1) % fill.points.size()];
    if (sense * ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) < 0) return false;
  }
  return true;
}

/// Whether any cell's centre ends up painted with grains.
bool has_grains(const Scene& s) {
  const Patch patch = s.patch();
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      if (painted(s, patch.x_centre(i), patch.y_centre(j)) >= 0) return true;
  return false;
}

void check_fill(const Scene& s, bool domain_sound, Problems& p) {
  bool sound = domain_sound, outside = false;
  const int materials = static_cast<int>(s.materials.size());
  for (std::size_t k = 0; k < s.fill.size(); ++k) {
    const Fill& f = s.fill[k];
    const std::string path = fmt::format("fill.{}", k);
    const std::size_t before = p.list.size();
    if (f.material < -1 || f.material >= materials)
      p.error(path + ".material",
              fmt::format("there is no material {} (-1 for air, below {}).", f.material, materials));
    const bool finite = std::all_of(f.points.begin(), f.points.end(),
                                    [](const auto& a) { return std::isfinite(a[0]) && std::isfinite(a[1]); });
    if (f.points.size() < 3 || f.points.size() > 1000)
      p.error(path, fmt::format("has {} corners (3 to 1000).", f.points.size()));
    else if (!finite)
      p.error(path, "has a corner that is not finite.");
    else if (twice_signed_area(f.points) == 0)
      p.error(path, "encloses no area. Move its corners apart.");
    else if (!is_convex(f.points))
      p.error(path, "is not convex, or its corners are not in order around it. Split it into convex fills.");
    sound &= p.list.size() == before;
    if (!sound) continue;
    const auto beyond = [&](int axis, double length) {
      const auto less = [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; };
      const auto [low, high] = std::minmax_element(f.points.begin(), f.points.end(), less);
      return (*high)[axis] <= 0 || (*low)[axis] >= length;
    };
    if (beyond(0, s.width) || beyond(1, s.height)) {
      p.warn(path, fmt::format("lies outside the domain (x 0 to {}, y 0 to {}): it paints nothing.", s.width,
                               s.height));
      outside = true;
    }
  }
  if (s.fill.empty() && !s.start)
    p.error("fill",
            "there is no fill (at least one with grains). Add e.g. - {material: sand, box: {x: [0, 150], "
            "y: [0, 135]}}.");
  else if (sound && materials > 0 && !has_grains(s))
    p.error(
        "fill",
        fmt::format("puts no grains into the domain (x 0 to {}, y 0 to {}). {}", s.width, s.height,
                    outside ? "Move the fills inside." : "Check that air does not paint over all of them."));
}

void check_viscosity(const Scene& s, Problems& p) {
  const Rheology& r = s.rheology;
  const std::string path = "physics.rheology.";
  if (p.is_sound(path + "eta_min") && r.eta_max <= r.eta_min)
    p.error(path + "eta_max",
            fmt::format("{} is not above eta_min = {}. 1.643e6 rho sqrt(g d^3) is the usual cap.", r.eta_max,
                        r.eta_min));
  else if (!std::isfinite(r.eta_max))
    p.error(path + "eta_max", fmt::format("{} is not finite.", r.eta_max));
}

void check_modules(const Scene& s, Problems& p) {
  const bool newtonian = s.rheology.law == Law::newtonian;
  const auto needs_friction = [&](bool named, const char* module) {
    if (named && newtonian)
      p.error(std::string("physics.") + module,
              "needs the friction of grains, which law newtonian has not (laws mu_I, mu_I_regularised). "
              "Remove it, or "
              "use law mu_I.");
  };
  needs_friction(s.nonlocal.has_value(), "nonlocal");
  needs_friction(s.dilatancy.has_value(), "dilatancy");
  if (s.nonlocal) {
    const Nonlocal& n = *s.nonlocal;
    if (n.closure == Closure::kamrin && s.rheology.law == Law::mu_I_regularised)
      p.error("physics.nonlocal.closure",
              "kamrin has a flow rule of its own (thesis, with law mu_I_regularised).");
    for (const Material& m : s.materials)
      if (n.closure == Closure::kamrin && m.delta_mu == 0)
        p.error("materials." + m.name + ".delta_mu", "0 is out of range (closure kamrin needs it above 0).");
  }
  if (s.dilatancy) {
    const Dilatancy& d = *s.dilatancy;
    p.require(d.phi_min > 0 && d.phi_min <= d.phi_max, "physics.dilatancy.phi_min", d.phi_min,
              "above 0, at most phi_max", "0.2 is usual.");
    bool opening = !s.orifices.empty();
    for (const Wall wall : s.walls) opening |= wall == Wall::open;
    if (!opening && d.mode != DilatancyMode::weight)
      p.error("physics.dilatancy",
              "needs an opening: in a closed box nothing makes room for what dilates (an orifice, a "
              "side that is open, or mode weight).");
    if (d.mode == DilatancyMode::weight)
      p.warn("physics.dilatancy.mode",
             "weight lets phi(I) weigh in the density only, as the silo thesis does: the mass of grains "
             "changes where I "
             "does. Mode source conserves it.");
  }
  if (s.wall_friction) {
    const WallFriction& f = *s.wall_friction;
    const std::string path = "physics.wall_friction";
    if (f.F ? f.mu_w || f.gap : !(f.mu_w && f.gap))
      p.error(path,
              "its strength is to be given once: by F = 2 mu_w / gap, or by mu_w and gap. E.g. {F: 0.0167}.");
    for (const double v : f.wall_velocity)
      if (!std::isfinite(v)) p.error(path + ".wall_velocity", fmt::format("{} is not finite.", v));
  }
}

/// Call last: the coarser grids are looked at only where this one is sound.
void check_extrapolation(const Scene& s, Problems& p) {
  const int grids = s.accuracy.extrapolate;
  const std::string path = "accuracy.extrapolate";
  if (!p.is_sound(path) || grids == 0) return;
  if (s.orifices.empty())
    p.warn(path, "is not used: without an orifice there is no discharge to extrapolate.");
  if (s.orifices.empty() || !p.is_sound("")) return;
  double narrowest = s.orifices.front().width;
  for (const Orifice& o : s.orifices) narrowest = std::min(narrowest, o.width);
  for (int k = 1; k <= grids; ++k) {
    const Scene coarse = coarser(s, k);
    const double across = narrowest * coarse.cells_x / s.width;
    std::string what;
    if (coarse.cells_x << k != s.cells_x)
      what = fmt::format("{} cells across cannot be halved.", s.cells_x >> (k - 1));
    for (const Problem& problem : check(coarse))
      if (problem.fatal && what.empty()) what = problem.path + ": " + problem.message;
    if (what.empty() && across < 4 - edge_tolerance)
      what = fmt::format("an orifice {:.3g} cells wide there tells nothing of its discharge (at least 4).",
                         across);
    if (!what.empty()) {
      p.error(path,
              fmt::format("{} needs the scene on {} cells across too: {} Use extrapolate {}, or more cells.",
                          grids, coarse.cells_x, what, k - 1));
      return;
    }
    if (k == grids && across < 8 - edge_tolerance)
      p.warn(
          path,
          fmt::format("the coarsest of its grids has {:.3g} cells across the narrowest orifice; below 8 the "
                      "discharge depends on more than the size of cells, and the error bar tells too little.",
                      across));
  }
}

/// Through an orifice, or over an open side that gravity does not keep them from.
bool grains_can_leave(const Scene& s) {
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top})
    if (leaves_over(s, side)) return true;
  return !s.orifices.empty();
}

void check_time(const Scene& s, Problems& p) {
  const TimeControl& t = s.time;
  const bool leaves = grains_can_leave(s), discharges = !s.orifices.empty();
  const auto needs_way_out = [&](const std::optional<double>& value, const std::string& path, bool possible) {
    if (value && !possible)
      p.warn(path, "never comes true: grains have no way out, or no orifice to discharge through.");
  };
  needs_way_out(s.stop.mass_below, "stop.mass_below", leaves);
  needs_way_out(s.stop.steady_discharge, "stop.steady_discharge", discharges);
  const bool stops = (s.stop.mass_below && leaves) || (s.stop.steady_discharge && discharges);
  if (t.end == 0 && t.max_steps == 0 && !stops)
    p.error("time",
            "nothing ends this run (one of time.end, time.max_steps, stop.mass_below, stop.steady_discharge; "
            "stop needs a way out for grains). Add e.g. time: {end: 164.3}.");
}

void check_output(const Scene& s, Problems& p) {
  if (s.name.empty() || s.name == "." || s.name == ".." || s.name.size() > 100 ||
      std::any_of(s.name.begin(), s.name.end(),
                  [](unsigned char c) { return c == '/' || c < 32 || c == 127; }))
    p.error("name", fmt::format("'{:.40}' cannot name a run folder (1 to 100 characters, no /).", s.name));
  std::string known;
  for (const FieldInfo& info : known_fields()) known += (known.empty() ? "" : ", ") + std::string(info.name);
  for (std::size_t k = 0; k < s.output.fields.size(); ++k) {
    const std::string &name = s.output.fields[k], path = fmt::format("output.fields.{}", k);
    if (std::none_of(known_fields().begin(), known_fields().end(),
                     [&](const FieldInfo& info) { return info.name == name; }))
      p.error(path, fmt::format("there is no field '{:.40}' (allowed: {}).", name, known));
  }
}

void check_feed(const Scene& s, Problems& p) {
  if (!s.feed) return;
  const int materials = static_cast<int>(s.materials.size());
  if (s.feed->material < 0 || s.feed->material >= materials)
    p.error("feed.material", "is not a material (one of the scene's, not air).");
  p.require(s.feed->level > 0 && s.feed->level <= s.height, "feed.level", s.feed->level,
            fmt::format("above 0, at most the height {}", s.height), "Up to there the silo stays filled.");
}

}  // namespace

/// Whether this count gives a whole height and coarsens.
bool suits(const Scene& s, int cells_x) {
  const double cells_y = s.height / (s.width / cells_x);
  if (cells_x < 2 || cells_y < 2 || cells_y > 1e6 || !is_whole(cells_y)) return false;
  return coarsens(cells_x, static_cast<int>(std::lround(cells_y)));
}

Scene coarser(const Scene& scene, int halvings) {
  Scene s = scene;
  s.cells_x >>= halvings;
  s.accuracy.extrapolate = 0;
  return s;
}

DefaultCells default_cells(const Scene& s) {
  DefaultCells chosen;
  for (const Orifice& o : s.orifices)
    if (o.width > 0) chosen.narrowest = chosen.narrowest > 0 ? std::min(chosen.narrowest, o.width) : o.width;
  const int across = s.accuracy.cells_across_orifice;
  const double least = chosen.narrowest > 0 ? across * s.width / chosen.narrowest : 8.0 * across;
  if (!(least > 0 && s.height > 0)) return chosen;
  chosen.fewer = least > most_default_cells;
  const int from = chosen.fewer ? most_default_cells : static_cast<int>(std::ceil(least - 1e-9));
  const int unit = 16, step = chosen.fewer ? -unit : unit;
  for (int n = (from + unit - 1) / unit * unit; n >= unit && n <= most_default_cells; n += step)
    if (suits(s, n)) {
      chosen.cells_x = n;
      return chosen;
    }
  chosen.cells_x = nearest_count(s, from, chosen.fewer ? -1 : +1);
  return chosen;
}

std::string cells_for(const Scene& s, double size, double cells, const char* or_else) {
  const double least = cells * s.width / size;
  if (least > 1e6) return or_else;
  const int n = nearest_count(s, static_cast<int>(std::ceil(least - 1e-9)), +1);
  return fmt::format("cells_x >= {}", n ? n : static_cast<int>(std::ceil(least)));
}

bool leaves_over(const Scene& s, Side side) {
  const std::array<double, 4> outward{-s.gravity[0], s.gravity[0], -s.gravity[1],
                                      s.gravity[1]};  // g along the normal
  return s.wall(side) == Wall::open && outward[static_cast<std::size_t>(side)] >= 0;
}

int painted(const Scene& s, double x, double y) {
  if (s.start) return 0;  // whatever the run holds there
  const auto last =
      std::find_if(s.fill.rbegin(), s.fill.rend(), [&](const Fill& fill) { return contains(fill, x, y); });
  return last == s.fill.rend() ? -1 : last->material;
}

std::vector<Problem> check(const Scene& scene) {
  Problems problems;
  check_ranges(scene, problems);
  check_output(scene, problems);
  const bool domain_sound = check_domain(scene, problems);
  check_materials(scene, problems);
  check_fill(scene, domain_sound, problems);
  check_feed(scene, problems);
  check_openings(scene, domain_sound, problems);
  check_viscosity(scene, problems);
  check_modules(scene, problems);
  if (scene.model == Model::mu_I) {
    check_extrapolation(scene, problems);
    check_solids(scene, domain_sound, problems);
    check_time(scene, problems);
  }
  check_model(scene, problems);
  return problems.list;
}

}  // namespace hourglass
