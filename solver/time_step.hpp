#pragma once
// Honest limits of the time step, and which one ruled.
#include "kernels/team.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"
#include "solver/simulation.hpp"

namespace hourglass {

/// Largest |u| + |v| over the faces of a cell [L/T].
struct FastestCells {
  double near_grains = 0;  ///< in cells that hold grains or touch one that does
  double air = 0;          ///< elsewhere
};
/// rows: room for a number a row of cells, twice.
FastestCells fastest_cells(const Fields& fields, int threads, std::array<RowSums, 2>& rows);

struct TimeStep {
  double dt;
  DtLimit limit;
};

/// The smallest of: dt_max, times accuracy.step_factor; cfl h / speed near grains (geometric VOF keeps the shares in [0, 1] for cfl <=
/// 1/2); 0.9 h / speed in air (upwind advection); growth by a quarter a step from 0.1 sqrt(h / g), because
/// the pressure of an orifice that opens at once accelerates its edges without bound as h -> 0; what is left
/// to the end; dt_most of a run that has backed off.
TimeStep choose_time_step(const Scene& scene, const FastestCells& fastest, double h, double dt_before,
                          double t_left, double dt_most = 1e300);

}  // namespace hourglass
