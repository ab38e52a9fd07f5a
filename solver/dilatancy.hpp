#pragma once
// Packing fraction of sheared grains, phi(I), and what follows from it (docs/physics.md, Dilatancy).
//
// `source`, `relax`: the mass of grains is carried by itself, phi is what mass and volume say, and the flow dilates
// towards phi(I):  div u = S,
//   source: S = (1 - phi(I)/phi) / relaxation_time, a short time: in the limit S = -(1/phi) D phi(I)/Dt;
//   relax:  S = K |γ̇| (phi - phi(I))  (Pailha & Pouliquen 2009, JFM 633:115);  both bounded by |S| <= |γ̇|, and S <= mu |γ̇|:
//   dilating against P takes its work from the shear stress, (mu |γ̇| - S) P >= 0.
// `weight`: the thesis's way, phi(I) weighs in the density alone; its mass is not conserved.
#include "solver/archive.hpp"
#include "solver/grain_properties.hpp"
#include "solver/vof.hpp"

namespace hourglass {

class DilatancyStage {
 public:
  DilatancyStage(const Scene& scene, const Patch& patch, Ends ends, const Geometry* geometry = nullptr);

  /// Before volumes move: phi of each material at n.
  void remember(const Fields& fields, int threads);
  /// After: fields.solid moves with the volumes, by the phi of the cell upstream.
  void transport(Fields& fields, const Vof& vof, int threads);
  /// phi(I) and S of row j. in along it: I, mu, |γ̇|^2, P, phi_g, d sqrt(rho). No two members set one row.
  void set_row(const Fields& fields, int j, const double* I, const double* mu, const double* gamma2,
               const double* pressure, const double* phi_g, const double* d_sqrt_rho);

  /// -dS/dP >= 0 [T/M]: S answers to the pressure that it makes within the step, which is what keeps it stable.
  const CellField* compliance() const { return compliance_.allocated() ? &compliance_ : nullptr; }
  /// S [1/T] in cells; nullptr in mode weight.
  const CellField* divergence() const { return divergence_.allocated() ? &divergence_ : nullptr; }
  /// What was carried through the faces at the packing phi_max [cell areas]; by phase.
  PhaseFlux flux() const { return {flux_x_, flux_y_}; }
  /// What the next step takes over from the last: in mode weight phi(I).
  void walk(Archive& archive);
  std::size_t bytes() const;

 private:
  Rows rows_of(Team& team) const { return team.rows(ratio_[0].ny()); }

  DilatancyMode mode_;
  double phi_max_, phi_min_, relaxation_time_, K_;
  Ends ends_;
  const Geometry* geometry_;
  std::vector<CellField> ratio_;  ///< phi / phi_max, by phase: all grains, then materials
  std::vector<XFaceField> flux_x_;
  std::vector<YFaceField> flux_y_;
  CellField divergence_, compliance_;
  double least_pressure_;  ///< rho g h [M/T^2]
};

}  // namespace hourglass
