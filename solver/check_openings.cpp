// Openings in messages: walls, orifices, a left edge that is the middle of the domain, the outlet of a hopper.
#include "solver/scene_checks.hpp"
#include "solver/solids.hpp"

namespace hourglass {

namespace {

bool is_vertical(Side side) { return side == Side::left || side == Side::right; }

/// What a left edge in the middle is called in messages.
const char* middle_of(const Scene& s) { return s.axisymmetric() ? "axis" : "mirror plane"; }

/// Whether the orifice lies within its wall; halved by the middle of the domain it may lie beyond, too.
bool check_place(const Scene& s, const Orifice& o, const std::string& path, double tolerance, Problems& p) {
  const double low = o.centre - o.width / 2, high = o.centre + o.width / 2;
  const double length = is_vertical(o.wall) ? s.height : s.width;
  const char* wall = side_names[static_cast<int>(o.wall)];
  const bool halved = s.left_is_middle() && !is_vertical(o.wall);
  if (halved && std::abs(o.centre) <= tolerance && high <= length + tolerance) return true;
  if (low >= -tolerance && high <= length + tolerance) return true;
  if (halved && low < -tolerance && high > 0)
    p.error(path + ".centre",
            fmt::format("the orifice straddles the {} from {:.6g} to {:.6g} (x = 0 has to be its middle, or "
                        "its left end at least). Use a centre of 0, or from {:.12g} on.",
                        middle_of(s), low, high, o.width / 2));
  else if (o.width > length)
    p.error(path + ".centre",
            fmt::format("the orifice is wider ({}) than the {} wall ({}).", o.width, wall, length));
  else
    p.error(path + ".centre",
            fmt::format("the orifice reaches from {:.6g} to {:.6g}, beyond the {} wall (0 to {}). Use a "
                        "centre from {:.12g} to {:.12g}.",
                        low, high, wall, length, o.width / 2, length - o.width / 2));
  return false;
}

void check_orifice(const Scene& s, std::size_t k, Problems& p) {
  const Orifice& o = s.orifices[k];
  const std::string path = fmt::format("orifices.{}", k), wall = side_names[static_cast<int>(o.wall)];
  const double h = s.width / s.cells_x, tolerance = edge_tolerance * h, cells = o.width / h;
  if (s.left_is_middle() && o.wall == Side::left)
    p.error(path + ".wall", fmt::format("the left edge is the {} and cannot have an orifice (right, bottom, "
                                        "top).",
                                        middle_of(s)));
  else if (s.wall(o.wall) == Wall::open || s.wall(o.wall) == Wall::periodic)
    p.error(path + ".wall",
            fmt::format("the {} wall is {} and cannot have an orifice (only no_slip or free_slip). "
                        "Remove the orifice, or make walls.{} no_slip.",
                        wall, wall_names[static_cast<int>(s.wall(o.wall))], wall));
  for (std::size_t other = 0; other < k; ++other) {
    const Orifice& q = s.orifices[other];
    const double gap = std::abs(o.centre - q.centre) - (o.width + q.width) / 2;
    if (q.wall == o.wall && gap < -tolerance)
      p.error(
          path + ".centre",
          fmt::format("overlaps orifice {} by {:.6g}. Move them apart; touching is allowed.", other, -gap));
  }
  if (!check_place(s, o, path, tolerance, p)) return;
  if (s.hopper && o.wall == Side::bottom) {
    const auto [from, to] = outlet_of(s);
    if (o.centre - o.width / 2 < from - tolerance || o.centre + o.width / 2 > to + tolerance)
      p.error(path, fmt::format("reaches from {:.6g} to {:.6g}, beyond the hopper's outlet ({:.6g} to "
                                "{:.6g}). Remove it: the outlet is an orifice by itself.",
                                o.centre - o.width / 2, o.centre + o.width / 2, from, to));
  }
  if (s.model != Model::mu_I) return;  // the others know its width without a grid
  const auto cure = [&] { return cells_for(s, o.width, 8, "a wider orifice"); };
  if (cells < 2 - edge_tolerance)
    p.error(path + ".width",
            fmt::format("the neck is {:.3g} cells wide (must be at least 2; use >= 8: {}).", cells, cure()));
  else if (cells < 8 - edge_tolerance && suits(s, s.cells_x))  // otherwise the grid is going to change
    p.warn(path + ".width", fmt::format("neck is {:.3g} cells wide; use >= 8 ({}).", cells, cure()));
}

/// The left edge as a mirror plane or an axis.
void check_middle(const Scene& s, Problems& p) {
  const char* middle = middle_of(s);
  for (const Side side : {Side::left, Side::right})
    if (s.wall(side) == Wall::periodic)
      p.error(
          fmt::format("walls.{}", side_names[static_cast<int>(side)]),
          fmt::format("periodic is not possible: the left edge is the {}. Remove one of the two.", middle));
  const Wall left = s.wall(Side::left);
  if (left == Wall::no_slip || left == Wall::open)
    p.error("walls.left", fmt::format("is {}, but the left edge is the {} (only free_slip). Remove this key.",
                                      wall_names[static_cast<int>(left)], middle));
  if (s.gravity[0] != 0)
    p.error("gravity", fmt::format("has an x-component, {}, but the left edge is the {} (must be 0).",
                                   s.gravity[0], middle));
}

void check_hopper(const Scene& s, bool domain_sound, Problems& p) {
  const Hopper& hopper = *s.hopper;
  const double most = s.left_is_middle() ? 2 * s.width : s.width;
  if (domain_sound)
    p.require(hopper.outlet > 0 && hopper.outlet < most, "hopper.outlet", hopper.outlet,
              fmt::format("above 0, below the width {}", most));
  if (s.wall(Side::bottom) != Wall::no_slip && s.wall(Side::bottom) != Wall::free_slip)
    p.error("walls.bottom", fmt::format("is {} under a hopper (no_slip or free_slip). Remove this key: the "
                                        "outlet is an orifice by itself.",
                                        wall_names[static_cast<int>(s.wall(Side::bottom))]));
}

}  // namespace

void check_openings(const Scene& s, bool domain_sound, Problems& p) {
  const bool left = s.wall(Side::left) == Wall::periodic, right = s.wall(Side::right) == Wall::periodic;
  if (s.left_is_middle())
    check_middle(s, p);
  else if (left != right)
    p.error(left ? "walls.right" : "walls.left",
            fmt::format("is {} while the opposite wall is periodic (both or neither). Make both periodic.",
                        wall_names[static_cast<int>(s.wall(left ? Side::right : Side::left))]));
  for (const Side side : {Side::bottom, Side::top})
    if (s.wall(side) == Wall::periodic)
      p.error(
          fmt::format("walls.{}", side_names[static_cast<int>(side)]),
          "periodic is not possible here (no_slip, free_slip, open). Only left and right can be periodic.");
  if (s.hopper) check_hopper(s, domain_sound, p);
  for (std::size_t k = 0; k < s.orifices.size(); ++k) {
    const Orifice& o = s.orifices[k];
    const std::string path = fmt::format("orifices.{}", k);
    if (!std::isfinite(o.centre)) p.error(path + ".centre", fmt::format("{} is not finite.", o.centre));
    if (domain_sound && p.is_sound(path)) check_orifice(s, k, p);
  }
}

}  // namespace hourglass
