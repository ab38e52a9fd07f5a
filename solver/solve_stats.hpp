#pragma once
// What every solve returns. A missed tolerance is never swallowed: it travels up to the step's report.
#include <string>

namespace hourglass {

struct SolveStats {
  int iterations = 0;    ///< preconditioned Krylov iterations
  double initial = 0;    ///< error measure before the solve
  double final = 0;      ///< and after it
  double tolerance = 0;  ///< what was asked for (a rounding floor may have raised it)
  bool converged = true;
  int worst_i = -1, worst_j = -1;  ///< cell of the largest residual, when the tolerance was missed
};

}  // namespace hourglass
