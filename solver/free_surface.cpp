#include "solver/free_surface.hpp"

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

/// Fewer grains on both sides of a face move with the faces beside.
constexpr double least_grains = 1e-6;

}  // namespace

FreeSurface::FreeSurface(const Patch& patch, const Boundary& boundary, const Geometry* geometry,
                         double air_density)
    : boundary_(boundary), geometry_(geometry), air_density_(air_density), density_(patch),
      absorption_(patch), liquid_(patch), beta_(patch), kind_(patch) {}

void FreeSurface::update(Team& team, const CellField& grains, const CellField& density) {
  const Patch& patch = grains.patch();
  const int nx = patch.nx, ny = patch.ny;
  const Rows rows = team.rows(ny), faces = team.rows(ny + 1);
  for (int j = rows.begin; j < rows.end; ++j)
    for (int i = 0; i < nx; ++i) {
      const double c = grains(i, j);
      const bool open = !geometry_ || geometry_->volume(i, j) > 0;
      liquid_(i, j) = open && liquid(c);
      density_(i, j) = liquid(c) ? (density(i, j) - air_density_ * (1 - c)) / c : density(i, j);
    }
  team.sync();
  if (team.leads()) fill_cell_halo(boundary_, density_);
  team.sync();
  const auto across = [&](int i) { return boundary_.periodic_x ? (i + nx) % nx : i; };
  const auto beside_liquid = [&](int i, int j) {
    return (i > 0 && is_liquid(i - 1, j)) || (i + 1 < nx && is_liquid(i + 1, j)) ||
           (j > 0 && is_liquid(i, j - 1)) || (j + 1 < ny && is_liquid(i, j + 1));
  };
  const auto set = [&](double& beta, char& kind, double open, int i1, int j1, int i2, int j2) {
    const auto inside = [&](int i, int j) { return i >= 0 && i < nx && j >= 0 && j < ny; };
    const bool both = inside(i1, j1) && inside(i2, j2);
    const double c1 = inside(i1, j1) ? grains(i1, j1) : 0, c2 = inside(i2, j2) ? grains(i2, j2) : 0;
    const bool l1 = inside(i1, j1) && is_liquid(i1, j1), l2 = inside(i2, j2) && is_liquid(i2, j2);
    if (open <= 0 || (l1 && l2)) {
      kind = open <= 0 ? closed : grains_beside;
      beta = 0;
      return;
    }
    const bool falls = !l1 && !l2 && c1 + c2 > least_grains && !(c1 > 0 && beside_liquid(i1, j1)) &&
                       !(c2 > 0 && beside_liquid(i2, j2));
    kind = l1 || l2 || falls ? grains_beside : air_beside;
    beta = falls ? free_fall : 0;
    if (!both || !(l1 || l2)) return;  // at a boundary the projection knows what to do
    const double theta = std::clamp(c1 + c2 - 0.5, 0.1, 1.5);
    beta = open / (theta * (l1 ? density_(i1, j1) : density_(i2, j2)));
  };
  for (int j = faces.begin; j < faces.end; ++j) {
    const auto open_u = [&](int i) {
      if (geometry_) return geometry_->aperture.u(i, j);
      if (boundary_.periodic_x) return 1.0;
      return i == 0 ? boundary_.left.open[j] : i == nx ? boundary_.right.open[j] : 1.0;
    };
    const auto open_v = [&](int i) {
      if (geometry_) return geometry_->aperture.v(i, j);
      return j == 0 ? boundary_.bottom.open[i] : j == ny ? boundary_.top.open[i] : 1.0;
    };
    for (int i = 0; i <= nx && j < ny; ++i)
      set(beta_.u(i, j), kind_.u(i, j), open_u(i), across(i - 1), j, across(i), j);
    for (int i = 0; i < nx; ++i) set(beta_.v(i, j), kind_.v(i, j), open_v(i), i, j - 1, i, j);
  }
  team.sync();
  for (int j = rows.begin; j < rows.end; ++j)
    for (int i = 0; i < nx; ++i)
      absorption_(i, j) =
          liquid_(i, j) * ((beta_.u(i, j) + beta_.u(i + 1, j)) + (beta_.v(i, j) + beta_.v(i, j + 1)));
  team.sync();
}

void FreeSurface::extrapolate(Velocity& w) const {
  const auto each = [](auto& f, const auto& kind) {
    for (int j = 0; j < f.ny(); ++j)
      for (int i = 0; i < f.nx(); ++i) {
        if (kind(i, j) != air_beside) continue;
        double sum = 0, n = 0;
        const auto look = [&](int a, int b) {
          if (a < 0 || a >= f.nx() || b < 0 || b >= f.ny() || kind(a, b) != grains_beside) return;
          sum += f(a, b);
          n += 1;
        };
        look(i - 1, j);
        look(i + 1, j);
        look(i, j - 1);
        look(i, j + 1);
        f(i, j) = n > 0 ? sum / n : 0;
      }
  };
  each(w.u, kind_.u);
  each(w.v, kind_.v);
}

}  // namespace hourglass
