#pragma once
// Exact steady shear flow of Newtonian layers along x, driven by gravity along x: the stress falls by rho g dy, and
// du/dy is stress / viscosity. The lowest layer stands on a wall at rest; at the top there is a wall at rest or no stress.
#include <vector>

#include "tests/support/make_scene.hpp"

namespace hourglass {

struct Layer {
  double thickness, viscosity, density;
};

class LayeredFlow {
 public:
  LayeredFlow(std::vector<Layer> layers, double gravity, bool wall_on_top)
      : layers_(std::move(layers)), g_(gravity) {
    // With stress tau at the bottom, u at the top is a + b tau.
    double a = 0, b = 0, weight = 0;
    for (const Layer& l : layers_) {
      a -= (weight * l.thickness + 0.5 * g_ * l.density * l.thickness * l.thickness) / l.viscosity;
      b += l.thickness / l.viscosity;
      weight += g_ * l.density * l.thickness;
    }
    stress_ = wall_on_top ? -a / b : weight;
  }
  double stress_at_bottom() const { return stress_; }
  double velocity(double y) const {
    double u = 0, stress = stress_;
    for (const Layer& l : layers_) {
      const double up = std::min(y, l.thickness);
      u += (stress - 0.5 * g_ * l.density * up) * up / l.viscosity;
      stress -= g_ * l.density * l.thickness;
      y -= up;
      if (y <= 0) break;
    }
    return u;
  }

 private:
  std::vector<Layer> layers_;
  double g_, stress_ = 0;
};

/// The scene of such a flow on `cells` cells over the height: four cells wide, periodic, one material a layer.
inline Scene layered_scene(const std::vector<Layer>& layers, double gravity, bool wall_on_top, int cells) {
  double height = 0;
  std::vector<double> viscosities;
  for (const Layer& l : layers) {
    height += l.thickness;
    viscosities.push_back(l.viscosity);
  }
  Scene s = newtonian(4 * height / cells, height, 4, viscosities);
  s.gravity = {gravity, 0};
  s.walls = {Wall::periodic, Wall::periodic, Wall::no_slip, wall_on_top ? Wall::no_slip : Wall::free_slip};
  s.fill.clear();
  double y = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    s.materials[k].density = layers[k].density;
    s.fill.push_back(fill_box(static_cast<int>(k), 0, s.width, y, y + layers[k].thickness));
    y += layers[k].thickness;
  }
  return s;
}

}  // namespace hourglass
