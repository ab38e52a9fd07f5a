#pragma once
// The surface of the grains at p = 0, in place of air (`air: {model: none}`). Cells at least half full are liquid, and only
// they have a pressure. A face between a liquid cell and another lies at the distance theta h from the surface, theta from
// the shares of both cells, and has beta = 1/(rho theta) towards p = 0 (a ghost fluid: Gibou, Fedkiw, Cheng & Kang 2002,
// JCP 176:205). Faces of grains apart from all liquid fall freely; elsewhere nothing is solved, and the velocity continues
// that of the faces beside.
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/geometry.hpp"

namespace hourglass {

class FreeSurface {
 public:
  /// geometry: nullptr, or what outlives this.
  FreeSurface(const Patch& patch, const Boundary& boundary, const Geometry* geometry, double air_density);

  /// From the shares of cells filled by grains, and their density with air. Synced on return.
  void update(Team& team, const CellField& grains, const CellField& density);

  static bool liquid(double grains) { return grains >= 0.5; }
  bool is_liquid(int i, int j) const { return liquid_(i, j) > 0; }

  /// Density of the grains of a cell without its air, halo filled [M/L^2].
  const CellField& density() const { return density_; }
  /// On faces: A/(rho theta) at the surface; `free_fall` where grains fall; 0 elsewhere [L^2/M].
  const Velocity& beta() const { return beta_; }
  static constexpr double free_fall = 1e-300;
  /// Sum of the surface's beta around a liquid cell: absorption of the pressure matrix.
  const CellField& absorption() const { return absorption_; }
  /// 1 in liquid cells, else 0.
  const CellField& liquid() const { return liquid_; }
  /// What is beside a face: liquid or falling grains, or neither; a closed one stays closed.
  enum Kind : char { closed, air_beside, grains_beside };
  const VelocityOf<char>& kind() const { return kind_; }

  /// Velocity of faces with air on both sides: mean of those beside that move, or 0. Call from one member.
  void extrapolate(Velocity& w) const;

  std::size_t bytes() const {
    return density_.bytes() + beta_.bytes() + absorption_.bytes() + liquid_.bytes() + kind_.bytes();
  }

 private:
  Boundary boundary_;
  const Geometry* geometry_;
  double air_density_;
  CellField density_, absorption_, liquid_;
  Velocity beta_;
  VelocityOf<char> kind_;  // Kind
};

}  // namespace hourglass
