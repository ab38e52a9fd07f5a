#include "solver/painting.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/polygon.hpp"
#include "solver/solids.hpp"

namespace hourglass {

void paint(const Scene& scene, const Geometry* geometry, Fields& fields) {
  const Patch& patch = fields.patch();
  std::vector<Polygon> polygons;
  for (const Fill& f : scene.fill) polygons.emplace_back(f.points.begin(), f.points.end());
  const std::size_t fills = polygons.size();
  std::vector<Polygon> with_solids = polygons;
  for (Polygon& solid : solids_of(scene)) with_solids.push_back(std::move(solid));
  std::vector<double> share(scene.materials.size());
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i) {
      std::fill(share.begin(), share.end(), 0.0);
      const double open = geometry ? geometry->open_share(i, j) : 1;
      if (open == 0) continue;
      for (std::size_t k = 0; k < fills; ++k) {
        if (scene.fill[k].material < 0) continue;
        const Polygon part = part_in(polygons[k], patch.x_corner(i), patch.y_corner(j), patch.x_corner(i + 1),
                                     patch.y_corner(j + 1));
        share[scene.fill[k].material] +=
            visible_area(part, open < 1 ? with_solids : polygons, k + 1) / (patch.h * patch.h * open);
      }
      double grains = 0;
      for (double s : share) grains += s;
      const double rounding = std::abs(grains - 1) < 1e-12 ? 1 / grains : 1;
      fields.grains(i, j) = std::clamp(grains * rounding, 0.0, 1.0);
      for (std::size_t k = 0; k < fields.tracers.size(); ++k)
        fields.tracers[k](i, j) = std::clamp(share[k + 1] * rounding, 0.0, fields.grains(i, j));
    }
  if (geometry) fill_solid_shares(*geometry, fields);
}

}  // namespace hourglass
