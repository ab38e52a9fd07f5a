#pragma once
// Implicit viscosity, coupled in u and v:  (ρ/Δt) u - ∇·(2 η D(u)) = (ρ/Δt) u*,  u at n+1 before the
// projection.
#include "solver/krylov.hpp"
#include "solver/levels.hpp"

namespace hourglass {

template <class T>
class ViscousSolve {
 public:
  ViscousSolve(const Patch& patch, const Boundary& boundary)
      : multigrid_(patch, boundary, 1), krylov_(patch), energy_(2 * patch.ny + 1) {}

  /// Coefficients of all levels. in: eta in cells [M/T], density halo 2 [M/L^2]. Synced on return.
  void assemble(Team& team, const CellField& eta, bool harmonic_corners, const CellField& density, double dt);

  /// in: star = u*, halo unread; guess in x, 0 on fixed faces. out: x; star is overwritten by the right-hand
  /// side. tolerance: energy norm of the error over that of the flow; gravity_speed = |g| dt keeps the scale
  /// above 0 at rest.
  SolveStats solve(Team& team, Velocity& star, Velocity& x, double tolerance, double gravity_speed,
                   int max_iterations);

  const ViscousLevel<T>& finest() { return multigrid_.finest(); }
  std::size_t bytes() const { return multigrid_.bytes() + krylov_.bytes(); }

 private:
  Multigrid<ViscousLevel<T>> multigrid_;
  Krylov<ViscousLevel<T>> krylov_;
  RowSums energy_;  // by row of the unknown
};

}  // namespace hourglass
