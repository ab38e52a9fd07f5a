#include "io/render_ground.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

constexpr int closest_spacing = 24, rows_of_arrows = 7;  // closer where there is little room
constexpr double arrow_decades = 3;

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

}  // namespace

double interpolate(const CellField& field, double x, double y) {
  const double a = std::clamp(x - 0.5, 0.0, field.nx() - 1.0), b = std::clamp(y - 0.5, 0.0, field.ny() - 1.0);
  const int i = std::min(static_cast<int>(a), std::max(field.nx() - 2, 0)),
            i1 = std::min(i + 1, field.nx() - 1);
  const int j = std::min(static_cast<int>(b), std::max(field.ny() - 2, 0)),
            j1 = std::min(j + 1, field.ny() - 1);
  const double s = a - i, t = b - j;
  return (1 - t) * ((1 - s) * field(i, j) + s * field(i1, j)) +
         t * ((1 - s) * field(i, j1) + s * field(i1, j1));
}

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

Ground::Ground(const Picture& picture)
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

bool has(const Picture& picture, Overlay overlay) {
  return picture.velocity_x.allocated() &&
         std::find(picture.overlays.begin(), picture.overlays.end(), overlay) != picture.overlays.end();
}

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

std::vector<double> shown_values(const Picture& picture) {
  std::vector<double> values;
  const Cover solids = cover_of(picture, picture.values.nx(), picture.values.ny(), 1);
  for (int j = 0; j < picture.values.ny(); ++j) {
    for (int i = 0; i < picture.values.nx(); ++i) {
      const bool shown = !solids.all(i, j) && (picture.show_air || picture.grains(i, j) >= 0.5);
      if (shown && std::isfinite(picture.values(i, j))) values.push_back(picture.values(i, j));
    }
  }
  return values;
}

}  // namespace hourglass
