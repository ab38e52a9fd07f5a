#pragma once
// Implicit viscosity, coupled in u and v:  (ρ/Δt) u - ∇·(2 η D(u)) = (ρ/Δt) u*,  u at n+1 before the
// projection.
#include "kernels/geometry.hpp"
#include "solver/free_surface.hpp"
#include "solver/krylov.hpp"
#include "solver/levels.hpp"

namespace hourglass {

/// Friction of a front and a back wall as an implicit drag (docs/physics.md, Wall friction): a force F P c against the
/// motion relative to them, F P c / max(speed, floor) times the velocity.
struct WallDrag {
  const CellField* force = nullptr;  ///< F P c, wrapped where periodic [M/(L T^2)]; nullptr: no friction
  std::array<double, 2> wall_velocity{0, 0};  ///< [L/T]
  double speed_floor = 0;                     ///< [L/T]
};

template <class T>
class ViscousSolve {
 public:
  /// geometry: nullptr, or what outlives this. surface: nullptr, or nothing moves beyond it; up to date before assemble().
  ViscousSolve(const Patch& patch, const Boundary& boundary, const Geometry* geometry = nullptr,
               const FreeSurface* surface = nullptr, int extra_sweeps = 0)
      : multigrid_(patch, geometry ? boundary.with_partly_open() : boundary, 1 + extra_sweeps),
        krylov_(patch), geometry_(geometry), surface_(surface), energy_(2 * patch.ny + 1),
        inertia_(patch.ny) {}

  /// Coefficients of all levels. in: eta in cells [M/T], density halo 2 [M/L^2]. Synced on return.
  void assemble(Team& team, const CellField& eta, bool harmonic_corners, const CellField& density,
                double dt) {
    const Velocity unread;
    Velocity unused;
    assemble(team, eta, harmonic_corners, density, dt, {}, unread, unused);
  }
  /// The same with a drag at the speeds of u, halos filled. inout: star takes the mean of u* and the walls' velocity that
  /// the drag asks for.
  void assemble(Team& team, const CellField& eta, bool harmonic_corners, const CellField& density, double dt,
                const WallDrag& drag, const Velocity& u, Velocity& star);

  /// in: star = u*, halo unread; guess in x, 0 on fixed faces. out: x; star is overwritten by the right-hand
  /// side. tolerance: energy norm of the error over that of the flow; gravity_speed = |g| dt keeps the scale
  /// above 0 at rest.
  SolveStats solve(Team& team, Velocity& star, Velocity& x, double tolerance, double gravity_speed,
                   int max_iterations);

  const ViscousLevel<T>& finest() { return multigrid_.finest(); }
  std::size_t bytes() const { return multigrid_.bytes() + krylov_.bytes(); }

 private:
  void set_coefficients_in_geometry(Rows rows, const CellField& eta, bool harmonic, const CellField& density,
                                    double scale, Velocity& star);
  void add_drag(Rows rows, const WallDrag& drag, const Velocity& u, Velocity& star);

  Multigrid<ViscousLevel<T>> multigrid_;
  Krylov<ViscousLevel<T>> krylov_;
  const Geometry* geometry_;
  const FreeSurface* surface_;
  RowSums energy_;  // by row of the unknown
  RowSums
      inertia_;  // by row of cells, where drag adds to the masses of faces: drag is no scale of the flow's energy
  bool has_drag_ = false;
};

}  // namespace hourglass
