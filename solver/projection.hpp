#pragma once
// ∇·(β ∇q) = ∇·u**,  u = u** - β ∇q,  p <- p + q h/Δt, with q = Δt δp / h so that β ∇q is a difference of
// neighbours (Chorin 1968; incremental: Goda 1979). β = 1/ρ on faces at n+1, 2/ρ on open boundary faces, 0 on
// walls.
#include "kernels/geometry.hpp"
#include "solver/archive.hpp"
#include "solver/free_surface.hpp"
#include "solver/krylov.hpp"
#include "solver/levels.hpp"

namespace hourglass {

/// What a scene may add to a projection; nullptr, 0: nothing.
struct ProjectionModules {
  const CellField* divergence = nullptr;  ///< S: ∇·u is to be S - compliance δp, not 0 [1/T]
  const CellField* viscosity = nullptr;   ///< eta of the rotational term [M/T]
  double rotational = 0;                  ///< omega: p <- p + δp - omega eta (∇·u** - divergence) ...
  double least_bound =
      0;  ///< ... but by no more than p/4 and this a step, for eta ∇·u** is rounding where eta is large [M/T^2]
};

template <class T>
class Projection {
 public:
  /// `compliant`: assemble() will be given a compliance. geometry: nullptr, or what outlives this; then β has the open
  /// share of the face, and ∇·u is integrated over what is open of a cell. surface: nullptr, or p = 0 there and nothing to
  /// solve beyond; up to date before assemble().
  Projection(const Patch& patch, const Boundary& boundary, bool compliant = false,
             const Geometry* geometry = nullptr, const FreeSurface* surface = nullptr, int extra_sweeps = 0);

  /// β of all levels. in: density in cells, halo 2 [M/L^2]; compliance -dS/dp >= 0 of the divergence asked for [T/M],
  /// nullptr: 0. Synced on return.
  void assemble(Team& team, const CellField& density, const CellField* compliance = nullptr, double dt = 0);

  /// u* += Δt (g - β ∂p) on unknown faces. in: p halo 0 (wrapped where periodic); inout: w, interior.
  void add_gravity_and_pressure(Team& team, const CellField& p, std::array<double, 2> gravity, double dt,
                                Velocity& w) const;
  /// The same on row k (row_of) alone, without a sync.
  void add_gravity_and_pressure_row(const CellField& p, std::array<double, 2> gravity, double dt, Velocity& w,
                                    int k) const;

  /// The first guess of δp is that of the solve before; this makes it 0. Call from one member.
  void forget() { q_.fill(0); }

  /// in: w = u**, 0 on walls; out: w solenoidal, or of the given divergence, to max |div w| dt <= tolerance, p updated (halo wrapped where
  /// periodic). The statistics are in units of div dt.
  SolveStats solve(Team& team, double dt, double tolerance, int max_iterations, Velocity& w, CellField& p,
                   const ProjectionModules& modules = {});

  /// max |div w| dt. Every member returns the same.
  double max_divergence(Team& team, const Velocity& w, double dt);

  /// What the next solve takes over from the last.
  void walk(Archive& archive) { archive.field("warm_start", q_); }

  std::size_t bytes() const { return multigrid_.bytes() + krylov_.bytes() + q_.bytes() + rhs_.bytes(); }

 private:
  /// rhs_ = -Σ velocities out of a cell + h divergence; returns max |.|
  double measure_divergence(Team& team, const Velocity& w, const CellField* divergence);

  /// p = 0 beyond the surface: its β goes to the diagonal, and cells that are not liquid have none.
  void end_at_surface(Rows rows);

  const Geometry* geometry_;
  const FreeSurface* surface_;
  Multigrid<PoissonLevel<T>> multigrid_;
  Krylov<PoissonLevel<T>> krylov_;
  CellField q_;  ///< δp Δt / h of the last solve, the guess of the next
  CellField rhs_;
  RowSums largest_, speed_;
};

}  // namespace hourglass
