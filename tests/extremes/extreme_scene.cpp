#include "tests/extremes/extreme_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/extremes/latin_hypercube.hpp"
#include "tests/support/make_scene.hpp"

namespace hourglass {
namespace {

// The axes of the cube.
enum Axis {
  cells,
  height,
  unit_of_length,
  unit_of_gravity,
  unit_of_density,
  mu_s,
  delta_mu,
  I_0,
  eta_max,
  eta_min,
  cohesion,
  law,
  other_mu_s,
  other_delta_mu,
  other_I_0,
  other_density,
  other_diameter,
  material_count,
  air_density,
  air_viscosity,
  air_model,
  grain_size,
  orifice_kind,
  orifice_width,
  orifice_place,
  wall_kind,
  symmetry,
  gravity_kind,
  gravity_angle,
  fill_kind,
  fill_parts,
  insert_kind,
  feed,
  A,
  closure,
  fluidity_wall,
  phi_g,
  phi_min,
  dilatancy_mode,
  relaxation,
  F,
  friction_mode,
  belt,
  dt_max,
  max_steps,
  smoothing,
  cap,
  corner_mean,
  edge,
  precision,
  rounds,
  rotational,
  tolerance,
  start_pressure,
  solid_model,
  axes
};

/// One point of the cube.
class Point {
 public:
  explicit Point(int number) : number_(number) {}
  double share(Axis a) const {
    static const LatinHypercube cube(extreme_scenes, axes, 2026);
    return cube(number_, a);
  }
  double linear(Axis a, double low, double high) const { return low + (high - low) * share(a); }
  double logarithmic(Axis a, double low, double high) const { return low * std::pow(high / low, share(a)); }
  template <class T>
  T one_of(Axis a, std::initializer_list<T> choices) const {
    return *std::next(choices.begin(), static_cast<long>(share(a) * static_cast<double>(choices.size())));
  }
  /// Whether the axis is in its first part; if not, `rest` runs from 0 to 1 over what remains.
  bool absent(Axis a, double part, double& rest) const {
    rest = (share(a) - part) / (1 - part);
    return rest < 0;
  }

 private:
  int number_;
};

enum class Opening { none, floor, two, side, lid };
enum class Walls { silo, slippery, periodic, open_sides, closed, open };
enum class Gravity { down, up, tilted };
enum class Filled { full, heap, layers, checkerboard, air_pockets, slope, crumb, nothing };
enum class Solids { none, two_squares, at_wall, diamond, circle, triangle, hook, hopper };

constexpr std::array opening_names{"none", "floor", "two", "side", "lid"};
constexpr std::array wall_kind_names{"silo", "slippery", "periodic", "open_sides", "closed", "open"};
constexpr std::array gravity_names{"down", "up", "tilted"};
constexpr std::array filled_names{"full",        "heap",  "layers", "checkerboard",
                                  "air_pockets", "slope", "crumb",  "nothing"};
constexpr std::array solids_names{"none",   "two_squares", "at_wall", "diamond",
                                  "circle", "triangle",    "hook",    "hopper"};

struct Kinds {
  explicit Kinds(const Point& p)
      : opening(p.one_of(orifice_kind,
                         {Opening::none, Opening::floor, Opening::floor, Opening::floor, Opening::floor,
                          Opening::floor, Opening::two, Opening::two, Opening::side, Opening::lid})),
        walls(p.one_of(wall_kind,
                       {Walls::silo, Walls::silo, Walls::silo, Walls::silo, Walls::slippery, Walls::periodic,
                        Walls::periodic, Walls::open_sides, Walls::closed, Walls::open})),
        gravity(p.one_of(gravity_kind, {Gravity::down, Gravity::down, Gravity::down, Gravity::tilted,
                                        Gravity::tilted, Gravity::up})),
        filled(
            p.one_of(fill_kind, {Filled::full, Filled::full, Filled::heap, Filled::heap, Filled::heap,
                                 Filled::layers, Filled::layers, Filled::checkerboard, Filled::checkerboard,
                                 Filled::checkerboard, Filled::air_pockets, Filled::air_pockets,
                                 Filled::slope, Filled::slope, Filled::crumb, Filled::crumb})),
        solids(p.one_of(insert_kind,
                        {Solids::none, Solids::none, Solids::none, Solids::none, Solids::two_squares,
                         Solids::two_squares, Solids::at_wall, Solids::at_wall, Solids::diamond,
                         Solids::circle, Solids::triangle, Solids::hook, Solids::hopper})),
        shape(p.one_of(Axis::symmetry, {0, 0, 0, 0, 0, 1, 1, 2, 2})) {
    if (p.share(fill_kind) > 0.99) filled = Filled::nothing;
    if (shape > 0) {  // the left edge is the middle
      if (walls == Walls::periodic) walls = Walls::slippery;
      if (gravity == Gravity::tilted) gravity = Gravity::up;
    }
  }
  Opening opening;
  Walls walls;
  Gravity gravity;
  Filled filled;
  Solids solids;
  int shape;  // 0 cartesian, 1 mirror, 2 axisymmetric
};

void set_materials(const Point& p, double d, double rho, double g, Scene& s) {
  Material first;
  first.mu_s = p.logarithmic(mu_s, 0.01, 3);
  first.delta_mu = p.linear(delta_mu, 0, 2);
  first.I_0 = p.logarithmic(I_0, 1e-4, 10);
  first.diameter = d;
  first.density = rho;
  double rest = 0;
  if (!p.absent(cohesion, 0.7, rest)) first.cohesion = 10 * rest * rho * g * d;
  s.materials = {first};
  const int count = p.one_of(material_count, {1, 1, 2, 2, 3});
  Material other = first;
  other.name = "other";
  other.mu_s = p.logarithmic(other_mu_s, 0.01, 3);
  other.delta_mu = p.linear(other_delta_mu, 0, 2);
  other.I_0 = p.logarithmic(other_I_0, 1e-4, 10);
  other.density = rho * p.logarithmic(other_density, 0.1, 10);
  other.diameter = d * p.logarithmic(other_diameter, 0.1, 10);
  if (count > 1) s.materials.push_back(other);
  if (count > 2) {
    other.name = "smooth";
    other.mu_s = other.delta_mu = other.cohesion = 0;
    s.materials.push_back(other);
  }
}

void set_rheology(const Point& p, double d, double viscosity, Scene& s) {
  Rheology& r = s.rheology;
  r.eta_max = viscosity * p.logarithmic(eta_max, 1, 1e9);
  r.eta_min = std::min(viscosity, r.eta_max / 2) * p.logarithmic(eta_min, 1e-3, 1);
  r.smoothing_length = d * p.one_of(smoothing, {0.0, 0.5, 0.5, 5.0});
  r.cap = p.one_of(Axis::cap, {Cap::clip, Cap::clip, Cap::smooth});
  r.corner_mean = p.one_of(Axis::corner_mean, {CornerMean::harmonic, CornerMean::arithmetic});
  r.orifice_edge = p.one_of(edge, {EdgeRule::half_wall, EdgeRule::free, EdgeRule::wall});
  r.law = p.one_of(Axis::law, {Law::mu_I, Law::mu_I, Law::mu_I, Law::mu_I, Law::mu_I, Law::mu_I,
                               Law::mu_I_regularised, Law::mu_I_regularised, Law::newtonian});
  if (r.law == Law::mu_I_regularised)
    for (const Material& m : s.materials)
      if (!regularised_friction(m, r)) r.law = Law::mu_I;
  if (r.law == Law::newtonian)
    for (Material& m : s.materials) m.viscosity = std::clamp(viscosity * m.I_0, r.eta_min, r.eta_max);
}

void set_modules(const Point& p, double time, double speed, Scene& s) {
  double rest = 0;
  const bool frictional = s.rheology.law != Law::newtonian;
  if (!p.absent(A, 0.5, rest) && frictional) {
    s.nonlocal = Nonlocal{10 * rest, p.one_of(Axis::closure, {Closure::thesis, Closure::kamrin}),
                          p.one_of(fluidity_wall, {FluidityWall::zero, FluidityWall::no_flux})};
    const bool rated =
        std::all_of(s.materials.begin(), s.materials.end(), [](const Material& m) { return m.delta_mu > 0; });
    if (!rated || s.rheology.law == Law::mu_I_regularised) s.nonlocal->closure = Closure::thesis;
  }
  if (!p.absent(phi_g, 0.5, rest) && frictional) {
    Dilatancy d;
    d.phi_g = 5 * rest;
    d.phi_min = d.phi_max * p.logarithmic(Axis::phi_min, 0.01, 1);
    d.mode = p.one_of(dilatancy_mode, {DilatancyMode::source, DilatancyMode::source, DilatancyMode::relax,
                                       DilatancyMode::weight});
    d.relaxation_time = time * p.logarithmic(relaxation, 0.01, 100);
    d.K = 4 * p.logarithmic(relaxation, 0.01, 100);
    s.dilatancy = d;
  }
  if (!p.absent(F, 0.5, rest)) {
    WallFriction f;
    f.F = rest < 0.1 ? 0 : 1e-2 * std::pow(1e5, (rest - 0.1) / 0.9) / s.width;
    f.mode = p.one_of(friction_mode, {FrictionMode::implicit, FrictionMode::implicit, FrictionMode::limiter});
    f.speed_floor = 1e-5 * speed;
    if (p.share(belt) > 0.8) f.wall_velocity = {speed, -speed};
    s.wall_friction = f;
  }
}

void set_sides(const Point& p, const Kinds& kinds, Scene& s) {
  const Wall side = kinds.walls == Walls::slippery                                   ? Wall::free_slip
                    : kinds.walls == Walls::periodic                                 ? Wall::periodic
                    : kinds.walls == Walls::open_sides || kinds.walls == Walls::open ? Wall::open
                                                                                     : Wall::no_slip;
  const Wall floor = kinds.walls == Walls::open       ? Wall::open
                     : kinds.walls == Walls::slippery ? Wall::free_slip
                                                      : Wall::no_slip;
  const Wall lid = kinds.walls == Walls::closed ? Wall::no_slip : Wall::open;
  s.walls = {kinds.shape > 0 ? Wall::free_slip : side, side, floor, lid};
  s.symmetry = kinds.shape == 1 ? Symmetry::mirror : Symmetry::none;
  s.coordinates = kinds.shape == 2 ? Coordinates::axisymmetric : Coordinates::cartesian;
  const auto can_have = [&](Side at) { return s.wall(at) == Wall::no_slip || s.wall(at) == Wall::free_slip; };
  const double h = s.width / s.cells_x, place = p.share(orifice_place);
  const auto along = [&](double length, double width) { return width / 2 + place * (length - width); };
  const auto wide = [&](double length) { return 2 * h * std::pow(length / (2 * h), p.share(orifice_width)); };
  const double width = wide(s.width), tall = wide(s.height);
  switch (kinds.opening) {
    case Opening::none:
      break;
    case Opening::floor:
      if (!can_have(Side::bottom)) break;
      if (kinds.shape > 0)
        s.orifices = {{Side::bottom, 0, 2 * width}};
      else
        s.orifices = {{Side::bottom, along(s.width, width), width}};
      break;
    case Opening::two:
      if (!can_have(Side::bottom)) break;
      s.orifices = {{Side::bottom, s.width / 4, std::min(width, s.width / 2)},
                    {Side::bottom, s.width * 3 / 4, std::max(2 * h, width / 2)}};
      break;
    case Opening::side:
      if (can_have(Side::right)) s.orifices = {{Side::right, along(s.height, tall), tall}};
      break;
    case Opening::lid:
      if (can_have(Side::top)) s.orifices = {{Side::top, along(s.width, width), width}};
      break;
  }
}

void set_solids(const Kinds& kinds, Scene& s) {
  const double h = s.width / s.cells_x, x = std::floor(s.cells_x / 2.0) * h,
               y = std::floor(s.height / h / 2) * h;
  const double size = 6 * h;
  switch (kinds.solids) {
    case Solids::none:
      break;
    case Solids::two_squares:  // two cells apart
      s.inserts = {insert_of(Shape::square, x - 4 * h, y, size, size),
                   insert_of(Shape::square, x + 4 * h, y, size, size)};
      break;
    case Solids::at_wall:  // two cells from the right wall
      s.inserts = {insert_of(Shape::rectangle, s.width - 2 * h - size / 2, y, size, size)};
      break;
    case Solids::diamond:
      s.inserts = {insert_of(Shape::diamond, x, y, 1.5 * size, size)};
      break;
    case Solids::circle:
      s.inserts = {insert_of(Shape::circle, x, y, size, size)};
      break;
    case Solids::triangle:
      s.inserts = {insert_of(Shape::triangle_up, x, y, size, size)};
      break;
    case Solids::hook:  // holds grains in its corner
      s.inserts = {insert_of({{x - 4 * h, y - 2 * h},
                              {x + 4 * h, y - 2 * h},
                              {x + 4 * h, y + 4 * h},
                              {x + 2 * h, y + 4 * h},
                              {x + 2 * h, y},
                              {x - 4 * h, y}})};
      break;
    case Solids::hopper:
      if (s.wall(Side::bottom) == Wall::open || s.wall(Side::left) == Wall::periodic) break;
      s.hopper = Hopper{30, s.width / 3};
      s.orifices = {{Side::bottom, s.left_is_middle() ? 0 : s.width / 2, s.width / 3}};
      break;
  }
}

void set_fill(const Point& p, const Kinds& kinds, Scene& s) {
  const double w = s.width, t = s.height, h = w / s.cells_x;
  const int materials = static_cast<int>(s.materials.size());
  const int parts = static_cast<int>(p.linear(fill_parts, 2, 9));
  const auto add = [&](int material, double x0, double x1, double y0, double y1) {
    s.fill.push_back(fill_box(material, x0, x1, y0, y1));
  };
  switch (kinds.filled) {
    case Filled::full:
      add(0, 0, w, 0, t);
      if (materials > 1) add(1, 0, w / 2, 0, t);
      break;
    case Filled::heap:
      add(0, 0, w, 0, p.linear(fill_parts, 0.3, 0.95) * t);
      if (materials > 1) add(materials - 1, w / 3, 2 * w / 3, 0, t / 4);
      break;
    case Filled::layers:
      for (int k = 0; k < parts; ++k)
        add(k % materials, 0, w, k * 0.9 * t / parts, (k + 1) * 0.9 * t / parts);
      break;
    case Filled::checkerboard:
    case Filled::air_pockets:
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
          const bool odd = (i + j) % 2 == 1;
          if (kinds.filled == Filled::air_pockets && odd) continue;
          add(odd ? materials - 1 : 0, i * w / parts, (i + 1) * w / parts, j * t / parts,
              (j + 1) * t / parts);
        }
      break;
    case Filled::slope:
      s.fill.push_back({0, {{0, 0}, {w, 0}, {w, t / 4}, {0, 0.9 * t}}});
      if (materials > 1) add(materials - 1, 0, w / 2, 0, t / 8);
      break;
    case Filled::crumb:  // less than two cells, in mid-air
      add(0, 0.3 * w, 0.3 * w + 1.7 * h, 0.8 * t, 0.8 * t + 1.1 * h);
      break;
    case Filled::nothing:
      add(-1, 0, w, 0, t);
      break;
  }
}

void set_levers(const Point& p, Scene& s) {
  const double fall = std::sqrt(2 * s.g() * s.height), h = s.width / s.cells_x;
  s.time.dt_max = s.time.cfl * h / fall * p.logarithmic(dt_max, 0.1, 100);
  s.time.max_steps = std::lround(p.linear(max_steps, 100, 400));
  s.start_pressure =
      p.one_of(Axis::start_pressure, {StartPressure::zero, StartPressure::zero, StartPressure::hydrostatic});
  Accuracy& a = s.accuracy;
  a.precision = p.one_of(Axis::precision, {Precision::mixed, Precision::mixed, Precision::full});
  a.solids = p.one_of(solid_model, {SolidModel::cut_cells, SolidModel::cut_cells, SolidModel::staircase});
  a.viscous_tolerance = p.logarithmic(tolerance, 1e-5, 1e-2);
  a.fluidity_tolerance = 10 * a.viscous_tolerance;
  a.pressure_tolerance = p.logarithmic(tolerance, 1e-8, 1e-5);
  a.splitting.outer = p.one_of(rounds, {1, 1, 1, 2});
  a.splitting.picard = p.one_of(rounds, {1, 1, 2, 1});
  double rest = 0;
  a.splitting.rotational = p.absent(rotational, 0.6, rest) ? 1 : 1.9 * rest;
}

}  // namespace

ExtremeScene extreme_scene(int number) {
  const Point p(number);
  const Kinds kinds(p);
  Scene s;
  s.name = fmt::format("extreme_{}", number);
  s.units = Units::SI;
  s.threads = 1;
  const double d = p.logarithmic(unit_of_length, 1e-4, 1), g = p.logarithmic(unit_of_gravity, 1e-2, 1e2),
               rho = p.logarithmic(unit_of_density, 1, 3000);
  const double time = std::sqrt(d / g), speed = std::sqrt(g * d), viscosity = rho * std::sqrt(g * d * d * d);
  const double cells_across_grain = p.logarithmic(grain_size, 0.01, 100), h = d / cells_across_grain;
  s.cells_x = p.one_of(cells, {24, 32, 36, 48});
  s.width = s.cells_x * h;
  s.height = s.width * p.one_of(Axis::height, {0.5, 1.0, 1.0, 1.5});
  const double angle = kinds.gravity == Gravity::down ? 0
                       : kinds.gravity == Gravity::up ? M_PI
                                                      : p.linear(gravity_angle, -M_PI, M_PI);
  s.gravity = {kinds.gravity == Gravity::tilted ? g * std::sin(angle) : 0, -g * std::cos(angle)};
  s.air = {rho * p.logarithmic(air_density, 1e-6, 1), viscosity * p.logarithmic(air_viscosity, 1e-4, 1),
           p.one_of(Axis::air_model, {AirModel::passive, AirModel::passive, AirModel::none})};
  set_materials(p, d, rho, g, s);
  set_rheology(p, d, viscosity, s);
  set_modules(p, time, speed, s);
  set_sides(p, kinds, s);
  set_solids(kinds, s);
  set_fill(p, kinds, s);
  if (p.share(Axis::feed) > 0.92) s.feed = Feed{0, 0.8 * s.height};
  set_levers(p, s);
  bool opening = !s.orifices.empty();
  for (const Wall wall : s.walls) opening |= wall == Wall::open;
  if (s.dilatancy && !opening) s.dilatancy->mode = DilatancyMode::weight;
  s.output.series_every = s.time.dt_max;
  s.output.fields_every = s.output.snapshots_every = 0;

  const auto number_of = [](double x) { return fmt::format("{:.4g}", x); };
  const Material& m = s.materials[0];
  std::string modules;
  if (s.nonlocal)
    modules += std::string("nonlocal ") + closure_names[static_cast<int>(s.nonlocal->closure)] + "; ";
  if (s.dilatancy)
    modules += std::string("dilatancy ") + dilatancy_mode_names[static_cast<int>(s.dilatancy->mode)] + "; ";
  if (s.wall_friction)
    modules += std::string("friction ") + friction_mode_names[static_cast<int>(s.wall_friction->mode)] + "; ";
  return {s,
          {{"cells", fmt::format("{}x{}", s.cells_x, s.patch().ny)},
           {"mu_s", number_of(m.mu_s)},
           {"delta_mu", number_of(m.delta_mu)},
           {"I_0", number_of(m.I_0)},
           {"eta_max", number_of(s.rheology.eta_max / viscosity)},
           {"density_ratio", number_of(s.air.density / rho)},
           {"grain_over_cell", number_of(cells_across_grain)},
           {"orifice_cells", number_of(s.orifices.empty() ? 0 : s.orifices[0].width / h)},
           {"A", s.nonlocal ? number_of(s.nonlocal->A) : ""},
           {"phi_g", s.dilatancy ? number_of(s.dilatancy->phi_g) : ""},
           {"F_width", s.wall_friction ? number_of(*s.wall_friction->F * s.width) : ""},
           {"dt_over_cfl", number_of(s.time.dt_max * std::sqrt(2 * g * s.height) / (s.time.cfl * h))},
           {"law", law_names[static_cast<int>(s.rheology.law)]},
           {"modules", modules},
           {"materials", std::to_string(s.materials.size())},
           {"gravity", gravity_names[static_cast<int>(kinds.gravity)]},
           {"fill", filled_names[static_cast<int>(kinds.filled)]},
           {"walls", wall_kind_names[static_cast<int>(kinds.walls)]},
           {"openings", opening_names[static_cast<int>(kinds.opening)]},
           {"solids", solids_names[static_cast<int>(kinds.solids)]},
           {"air", air_model_names[static_cast<int>(s.air.model)]},
           {"shape", kinds.shape == 0   ? "cartesian"
                     : kinds.shape == 1 ? "mirror"
                                        : "axisymmetric"}}};
}

const std::vector<std::string>& drawn_names() {
  static const std::vector<std::string> names{
      "cells",         "mu_s",    "delta_mu", "I_0",     "eta_max",     "density_ratio", "grain_over_cell",
      "orifice_cells", "A",       "phi_g",    "F_width", "dt_over_cfl", "law",           "modules",
      "materials",     "gravity", "fill",     "walls",   "openings",    "solids",        "air",
      "shape"};
  return names;
}

}  // namespace hourglass
