// The engine from C++: how fast does the silo of configs/silo.yaml drain, on a coarse grid?
#include <cstdio>

#include "solver/simulation.hpp"

int main() {
  hourglass::Scene scene;  // in grain units: a box of 150 d x 150 d, open at the top
  scene.cells_x = 64;
  scene.fill = {{0, {{0, 0}, {150, 0}, {150, 135}, {0, 135}}}};  // the first material
  scene.orifices = {{hourglass::Side::bottom, 75, 18.75}};
  scene.time.end = 20;
  for (const hourglass::Problem& problem : hourglass::check(scene)) {
    std::fprintf(stderr, "%s: %s\n", problem.path.c_str(), problem.message.c_str());
    if (problem.fatal) return 2;
  }
  hourglass::Simulation silo(scene);
  const hourglass::Summary summary = silo.run();  // observers would be told of rows, frames and steps
  std::printf("discharge rate %.4g rho sqrt(g d^3)\n", summary.discharge_rate);
}
