#include "solver/geometry.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/open_shares.hpp"
#include "kernels/plic.hpp"
#include "solver/solids.hpp"

namespace hourglass {
namespace {

/// Cells and faces with less are closed: they would carry nothing, and divide by next to nothing.
constexpr double least_volume = 1e-2, least_aperture = 1e-3;

/// Shares on the grid of half the cell side, from which those of any control volume follow; beyond a mirror plane or the
/// ends of a periodic domain as well.
struct Halves {
  Ends ends;
  CellField volume;
  Velocity faces;
  Halves(const std::vector<Polygon>& solids, const Patch& patch, Ends beyond)
      : ends(beyond), volume(open_volume(solids, patch)), faces(open_faces(solids, patch)) {}
  int nx() const { return volume.nx(); }
  int ny() const { return volume.ny(); }
  /// Column of half cells or, `line`, of lines between them; where there is none, outside of [0, nx).
  int column(int i, bool line = false) const {
    if (ends.periodic) return (i + nx()) % nx();
    return ends.mirror && i < 0 ? -i - !line : i;
  }
  /// Mean volume of half cells [i0, i1) x [j0, j1), of those that there are.
  double mean_volume(int i0, int i1, int j0, int j1) const {
    double sum = 0;
    int n = 0;
    for (int j = std::max(j0, 0); j < std::min(j1, ny()); ++j)
      for (int i = i0; i < i1; ++i)
        if (const int k = column(i); k >= 0 && k < nx()) sum += volume(k, j), ++n;
    return n > 0 ? sum / n : 1;
  }
};

/// A wall as a plane: n . x + offset is the distance from it, in cells; x from the middle of a box.
struct Plane {
  double nx = 0, ny = 0, offset = 0;
  bool none() const { return nx == 0 && ny == 0; }
  double distance(double x, double y) const { return nx * x + ny * y + offset; }
};

/// The plane that leaves a square box of `side` cells its open volume, with the normal that the open shares of its four
/// sides have (the sum of all walls' normals around a closed figure is 0).
Plane plane_of(double side, double west, double east, double south, double north, double volume) {
  const double x = east - west, y = north - south, size = std::abs(x) + std::abs(y);
  if (size < 1e-9 || volume <= 0 || volume >= 1) return {};
  const double n1 = std::abs(x) / size, n2 = std::abs(y) / size;
  const double length = std::hypot(n1, n2);
  // {n . x <= alpha} of line_constant is the solid, 1 - volume of the box, from the corner that it fills first.
  const double alpha = line_constant(n1, n2, 1 - volume);
  return {std::copysign(n1, x) / length, std::copysign(n2, y) / length,
          side * (0.5 * (n1 + n2) - alpha) / length};
}

/// Mean distance from the wall of the open part of a segment of one cell; 0 if all of it is closed. along: the change of
/// the distance from end to end.
double mean_distance(double middle, double along) {
  const double high = middle + 0.5 * std::abs(along), low = middle - 0.5 * std::abs(along);
  return high <= 0 ? 0 : low >= 0 ? middle : 0.5 * high;
}

class Builder {
 public:
  Builder(const Scene& scene, const Boundary& boundary)
      : scene_(scene), boundary_(boundary), patch_(scene.patch()) {}

  std::unique_ptr<Geometry> build(std::vector<Polygon> solids) {
    const Patch fine{2 * patch_.nx, 2 * patch_.ny, 0.5 * patch_.h, patch_.x0, patch_.y0};
    if (scene_.accuracy.solids == SolidModel::staircase) solids = staircase(solids);
    const Halves halves(snapped(std::move(solids), fine), fine, boundary_.ends());
    geometry_ = std::make_unique<Geometry>();
    open_cells_and_faces(halves);
    close_what_is_cut_off();
    corners(halves);
    walls(halves);
    inertia();
    ghost_faces(halves, geometry_->aperture.u, geometry_->ghost_u);
    ghost_faces(halves, geometry_->aperture.v, geometry_->ghost_v);
    if (scene_.axisymmetric()) weigh_by_radius();
    finish();
    return std::move(geometry_);
  }

 private:
  /// Whole cells in place of what covers more than half of them.
  std::vector<Polygon> staircase(const std::vector<Polygon>& solids) const {
    const CellField open = open_volume(snapped(solids, patch_), patch_);
    std::vector<Polygon> steps;
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i) {
        if (open(i, j) >= 0.5) continue;
        const int first = i;
        while (i < patch_.nx && open(i, j) < 0.5) ++i;
        const double x0 = patch_.x_corner(first), x1 = patch_.x_corner(i), y0 = patch_.y_corner(j),
                     y1 = patch_.y_corner(j + 1);
        steps.push_back({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
      }
    return steps;
  }

  void open_cells_and_faces(const Halves& halves) {
    const int nx = patch_.nx, ny = patch_.ny;
    geometry_->volume = CellField(patch_);
    geometry_->aperture = Velocity(patch_);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const double v = halves.mean_volume(2 * i, 2 * i + 2, 2 * j, 2 * j + 2);
        geometry_->volume(i, j) = v < least_volume ? 0 : v;
      }
    XFaceField& u = geometry_->aperture.u;
    YFaceField& v = geometry_->aperture.v;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i <= nx; ++i) {
        const double side = boundary_.periodic_x ? 1
                            : i == 0             ? boundary_.left.open[j]
                            : i == nx            ? boundary_.right.open[j]
                                                 : 1;
        u(i, j) = side * 0.5 * (halves.faces.u(2 * i, 2 * j) + halves.faces.u(2 * i, 2 * j + 1));
      }
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const double side = j == 0 ? boundary_.bottom.open[i] : j == ny ? boundary_.top.open[i] : 1;
        v(i, j) = side * 0.5 * (halves.faces.v(2 * i, 2 * j) + halves.faces.v(2 * i + 1, 2 * j));
      }
    close_faces();
  }

  /// The cell beside a face of the boundary is the one inside, or across where periodic.
  std::array<int, 2> beside(int i) const {
    const int nx = patch_.nx;
    if (boundary_.periodic_x) return {(i - 1 + nx) % nx, i % nx};
    return {std::max(i - 1, 0), std::min(i, nx - 1)};
  }

  void close_faces() {
    const CellField& volume = geometry_->volume;
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i <= patch_.nx; ++i) {
        double& a = geometry_->aperture.u(i, j);
        const auto [l, r] = beside(i);
        if (a < least_aperture || volume(l, j) == 0 || volume(r, j) == 0) a = 0;
      }
    for (int j = 0; j <= patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i) {
        double& a = geometry_->aperture.v(i, j);
        if (a < least_aperture || volume(i, std::max(j - 1, 0)) == 0 ||
            volume(i, std::min(j, patch_.ny - 1)) == 0)
          a = 0;
      }
  }

  /// Parts of the domain that no face joins to an opening become solid; in a closed box all but the largest.
  void close_what_is_cut_off() {
    const int nx = patch_.nx, ny = patch_.ny;
    const Velocity& a = geometry_->aperture;
    CellField& volume = geometry_->volume;
    CellFieldOf<int> part(patch_, -1);
    std::vector<double> size;
    std::vector<char> open;
    std::vector<std::array<int, 2>> stack;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (volume(i, j) == 0 || part(i, j) >= 0) continue;
        const int name = static_cast<int>(size.size());
        size.push_back(0);
        open.push_back(0);
        const auto visit = [&](int ci, int cj, double aperture) {
          if (aperture <= 0) return;
          if (ci < 0 || ci >= nx || cj < 0 || cj >= ny) {
            open[name] = 1;
          } else if (part(ci, cj) < 0) {
            part(ci, cj) = name;
            stack.push_back({ci, cj});
          }
        };
        visit(i, j, 1);
        while (!stack.empty()) {
          const auto [ci, cj] = stack.back();
          stack.pop_back();
          size[name] += volume(ci, cj);
          const bool wraps = boundary_.periodic_x;
          visit(wraps ? (ci + nx - 1) % nx : ci - 1, cj, a.u(ci, cj));
          visit(wraps ? (ci + 1) % nx : ci + 1, cj, a.u(ci + 1, cj));
          visit(ci, cj - 1, a.v(ci, cj));
          visit(ci, cj + 1, a.v(ci, cj + 1));
        }
      }
    const bool any_open = std::any_of(open.begin(), open.end(), [](char o) { return o != 0; });
    const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const int name = part(i, j);
        if (name >= 0 && !(any_open ? open[name] != 0 : name == largest)) volume(i, j) = 0;
      }
    close_faces();
  }

  void corners(const Halves& halves) {
    CornerField& c = geometry_->corner_volume = CornerField(patch_);
    for (int j = 0; j <= patch_.ny; ++j)
      for (int i = 0; i <= patch_.nx; ++i)
        c(i, j) = halves.mean_volume(2 * i - 1, 2 * i + 1, 2 * j - 1, 2 * j + 1);
  }

  /// Where the energy of the viscous operator, weighted by open volumes, is not that of a plane shear flow along a wall, the
  /// wall's own shear makes up for it: `wall` is what lets the flow u = t (n . x) stand without force. A wall on grid
  /// lines gets the domain wall's 2, and any straight wall its true place.
  void walls(const Halves& halves) {
    geometry_->wall = Velocity(patch_);
    geometry_->wall_area = CellField(patch_);
    const Velocity& a = geometry_->aperture;
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i <= patch_.nx; ++i)
        if (a.u(i, j) > 0) geometry_->wall.u(i, j) = wall_at<At::xface>(halves, i, j);
    for (int j = 0; j <= patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i)
        if (a.v(i, j) > 0) geometry_->wall.v(i, j) = wall_at<At::yface>(halves, i, j);
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i) {
        if (geometry_->volume(i, j) == 0) continue;
        const auto open_u = [&](int k) {
          return 0.5 * (halves.faces.u(k, 2 * j) + halves.faces.u(k, 2 * j + 1));
        };
        const auto open_v = [&](int k) {
          return 0.5 * (halves.faces.v(2 * i, k) + halves.faces.v(2 * i + 1, k));
        };
        geometry_->wall_area(i, j) =
            std::hypot(open_u(2 * i + 2) - open_u(2 * i), open_v(2 * j + 2) - open_v(2 * j));
      }
  }

  /// The wall in a box of two cells around (x, y), in half cells; where a side of the domain would cut the box, in the
  /// nearest whole one.
  Plane wall_around(const Halves& halves, int x, int y) const {
    const bool left = halves.ends.periodic || halves.ends.mirror, right = halves.ends.periodic;
    const int cx = std::min(left ? x : std::max(x, 2), right ? x : std::max(halves.nx() - 2, 2));
    const int cy = std::clamp(y, 2, std::max(halves.ny() - 2, 2));
    const auto upright = [&](int at) {  // mean of four half faces
      double sum = 0;
      for (int k = cy - 2; k < cy + 2; ++k) sum += halves.faces.u(halves.column(at, true), k);
      return 0.25 * sum;
    };
    const auto level = [&](int at) {
      double sum = 0;
      for (int k = cx - 2; k < cx + 2; ++k) sum += halves.faces.v(halves.column(k), at);
      return 0.25 * sum;
    };
    Plane wall = plane_of(2, upright(cx - 2), upright(cx + 2), level(cy - 2), level(cy + 2),
                          halves.mean_volume(cx - 2, cx + 2, cy - 2, cy + 2));
    wall.offset += 0.5 * (wall.nx * (x - cx) + wall.ny * (y - cy));
    return wall;
  }

  /// The same, or the nearest wall that a box one cell aside sees.
  Plane wall_near(const Halves& halves, int x, int y) const {
    Plane best = wall_around(halves, x, y);
    if (!best.none()) return best;
    for (const auto [dx, dy] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      Plane aside = wall_around(halves, x + 2 * dx, y + 2 * dy);
      aside.offset -= aside.nx * dx + aside.ny * dy;
      if (!aside.none() && (best.none() || aside.offset < best.offset - 1e-9)) best = aside;
    }
    return best;
  }

  /// Whether solids close a face, whatever the side of the domain does.
  static bool closed_u(const Halves& halves, int i, int j) {
    return halves.faces.u(2 * i, 2 * j) + halves.faces.u(2 * i, 2 * j + 1) < 2 * least_aperture;
  }
  static bool closed_v(const Halves& halves, int i, int j) {
    return halves.faces.v(2 * i, 2 * j) + halves.faces.v(2 * i + 1, 2 * j) < 2 * least_aperture;
  }

  template <At face>
  double wall_at(const Halves& halves, int i, int j) const {
    const Geometry& g = *geometry_;
    constexpr bool is_u = face == At::xface;
    const int x = is_u ? 2 * i : 2 * i + 1, y = is_u ? 2 * j + 1 : 2 * j;
    const Plane wall = wall_near(halves, x, y);
    if (wall.none()) return 0;
    // u = t d on u-faces and v-faces around, d their mean distance; t is along the wall. It goes on beyond the sides of the
    // domain, which have shear weights of their own.
    const double tx = -wall.ny, ty = wall.nx;
    const int nx = patch_.nx, ny = patch_.ny;
    const auto column = [&](int k) {
      return boundary_.periodic_x ? (k + nx) % nx : std::clamp(k, 0, nx - 1);
    };
    const auto u = [&](int k, int l) {
      const int c = boundary_.periodic_x ? (k + nx) % nx : k;
      if (c >= 0 && c <= nx && l >= 0 && l < ny &&
          (c % nx == 0 ? closed_u(halves, c, l) : g.aperture.u(c, l) == 0))
        return 0.0;
      return tx * mean_distance(wall.distance(k - 0.5 * x, l + 0.5 - 0.5 * y), wall.ny);
    };
    const auto v = [&](int k, int l) {
      const int c = column(k);
      if (l >= 0 && l <= ny && (l % ny == 0 ? closed_v(halves, c, l) : g.aperture.v(c, l) == 0)) return 0.0;
      return ty * mean_distance(wall.distance(k + 0.5 - 0.5 * x, l - 0.5 * y), wall.nx);
    };
    const auto cell = [&](int k, int l) { return g.volume(column(k), std::clamp(l, 0, ny - 1)); };
    double force = 0, speed = 0;
    if constexpr (is_u) {
      speed = u(i, j);
      force = 2 * (cell(i, j) * (speed - u(i + 1, j)) + cell(i - 1, j) * (speed - u(i - 1, j))) +
              g.corner_volume(i, j + 1) * ((speed - u(i, j + 1)) - (v(i, j + 1) - v(i - 1, j + 1))) +
              g.corner_volume(i, j) * ((speed - u(i, j - 1)) + (v(i, j) - v(i - 1, j)));
    } else {
      speed = v(i, j);
      force = 2 * (cell(i, j) * (speed - v(i, j + 1)) + cell(i, j - 1) * (speed - v(i, j - 1))) +
              g.corner_volume(i + 1, j) * ((speed - v(i + 1, j)) - (u(i + 1, j) - u(i + 1, j - 1))) +
              g.corner_volume(i, j) * ((speed - v(i - 1, j)) + (u(i, j) - u(i, j - 1)));
    }
    constexpr double most = 100;  // a face within a hundredth of a cell of the wall hardly moves
    if (std::abs(speed) < 1e-9) return 0;
    const bool at_side = is_u ? !boundary_.periodic_x && (i == 0 || i == nx) : j == 0 || j == ny;
    return (at_side ? 0.5 : 1) * std::clamp(-force / speed, 0.0, most);  // a side halves the control volume
  }

  /// Closed faces beside open ones.
  template <At face>
  void ghost_faces(const Halves& halves, const Field<face>& aperture,
                   std::vector<Geometry::GhostFace>& ghosts) {
    constexpr bool is_u = face == At::xface;
    const auto x = [](int i) { return is_u ? 2 * i : 2 * i + 1; };
    const auto y = [](int j) { return is_u ? 2 * j + 1 : 2 * j; };
    const bool periodic = boundary_.periodic_x;
    for (int j = 0; j < aperture.ny(); ++j)
      for (int i = 0; i < aperture.nx(); ++i) {
        const bool at_side =
            is_u ? i + 1 == aperture.nx() || (i == 0 && !periodic) : j == 0 || j + 1 == aperture.ny();
        if (aperture(i, j) > 0 || at_side) continue;
        Geometry::GhostFace ghost{i, j, {}};
        for (const auto [di, dj] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int k = periodic ? (i + di + patch_.nx) % patch_.nx : i + di, l = j + dj;
          if (k < 0 || k >= aperture.nx() || l < 0 || l >= aperture.ny() || aperture(k, l) == 0) continue;
          const Plane wall = wall_around(halves, x(k), y(l));
          const double own = mean_distance(wall.offset, is_u ? wall.ny : wall.nx);
          if (wall.none() || own < 1e-3) continue;
          ghost.from.push_back({k, l, std::clamp(wall.distance(-di, -dj) / own, -1.0, 1.0)});
        }
        for (auto& source : ghost.from) source.factor /= static_cast<double>(ghost.from.size());
        if (!ghost.from.empty()) ghosts.push_back(std::move(ghost));
      }
  }

  /// Shares of the momentum's control volumes; before radii come in.
  void inertia() {
    Velocity& inverse = geometry_->inverse_inertia = Velocity(patch_);
    const CellField& v = geometry_->volume;
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i <= patch_.nx; ++i) {
        const auto [l, r] = beside(i);
        inverse.u(i, j) = 1 / std::max(0.5, 0.5 * (v(l, j) + v(r, j)));
      }
    for (int j = 0; j <= patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i)
        inverse.v(i, j) =
            1 / std::max(0.5, 0.5 * (v(i, std::max(j - 1, 0)) + v(i, std::min(j, patch_.ny - 1))));
  }

  void weigh_by_radius() {
    Geometry& g = *geometry_;
    g.axisymmetric = true;
    const double per_width = 1 / scene_.width;
    for (int j = 0; j <= patch_.ny; ++j)
      for (int i = 0; i <= patch_.nx; ++i) {
        const double at_face = patch_.x_corner(i) * per_width;
        const double at_cell = patch_.x_centre(std::min(i, patch_.nx - 1)) * per_width;
        g.corner_volume(i, j) *= at_face;
        if (j < patch_.ny) {
          g.aperture.u(i, j) *= at_face;
          g.inverse_inertia.u(i, j) /= std::max(at_face, 0.5 * per_width * patch_.h);
          // Hoop stress 2 eta u_r / r over the control volume: eta (2 V h^2 / r^2) u_r.
          const double cells = patch_.x_corner(i) / patch_.h;
          const auto [l, r] = beside(i);
          const double share = 0.5 * ((i > 0 ? g.volume(l, j) : 0) + (i < patch_.nx ? g.volume(r, j) : 0));
          if (i > 0) g.wall.u(i, j) = at_face * (g.wall.u(i, j) + 2 * share / (cells * cells));
        }
        if (i < patch_.nx) {
          g.aperture.v(i, j) *= at_cell;
          g.inverse_inertia.v(i, j) /= at_cell;
          g.wall.v(i, j) *= at_cell;
        }
      }
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i) {
        g.volume(i, j) *= patch_.x_centre(i) * per_width;
        g.wall_area(i, j) *= patch_.x_centre(i) * per_width;
      }
  }

  void finish() {
    Geometry& g = *geometry_;
    const auto invert = [](const auto& from, auto& to) {
      for (int j = 0; j < from.ny(); ++j)
        for (int i = 0; i < from.nx(); ++i) to(i, j) = from(i, j) > 0 ? 1 / from(i, j) : 0;
    };
    g.inverse_volume = CellField(patch_);
    g.inverse_aperture = Velocity(patch_);
    invert(g.volume, g.inverse_volume);
    invert(g.aperture.u, g.inverse_aperture.u);
    invert(g.aperture.v, g.inverse_aperture.v);
    for (int j = 0; j < patch_.ny; ++j) fill_ends(boundary_.ends(), g.volume.row(j), patch_.nx);
    for (int j = 0; j < patch_.ny; ++j)
      for (int i = 0; i < patch_.nx; ++i) {
        if (g.volume(i, j) > 0) continue;
        Geometry::Ghost ghost{i, j, {}};
        for (int b = -1; b <= 1; ++b)
          for (int c = -1; c <= 1; ++c) {
            const int cj = j + b, ci = boundary_.periodic_x                 ? (i + c + patch_.nx) % patch_.nx
                                       : boundary_.mirror_left && i + c < 0 ? 0
                                                                            : i + c;
            if (ci >= 0 && ci < patch_.nx && cj >= 0 && cj < patch_.ny && g.volume(ci, cj) > 0)
              ghost.beside.push_back({ci, cj});
          }
        if (!ghost.beside.empty()) g.ghosts.push_back(std::move(ghost));
      }
  }

  const Scene& scene_;
  const Boundary& boundary_;
  const Patch patch_;
  std::unique_ptr<Geometry> geometry_;
};

bool within_faces(const SideFaces& side) {
  return std::any_of(side.open.begin(), side.open.end(), [](double open) { return open > 0 && open < 1; });
}

}  // namespace

std::unique_ptr<Geometry> geometry_of(const Scene& scene, const Boundary& boundary) {
  const bool partly = within_faces(boundary.left) || within_faces(boundary.right) ||
                      within_faces(boundary.bottom) || within_faces(boundary.top);
  std::vector<Polygon> solids = solids_of(scene);
  if (solids.empty() && !partly && !scene.axisymmetric()) return nullptr;
  return Builder(scene, boundary).build(std::move(solids));
}

}  // namespace hourglass
