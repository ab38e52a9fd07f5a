#pragma once
// eta = c eta_grains(|γ̇|, p) + (1 - c) eta_air in cells, with |γ̇|^2 smoothed over
// rheology.smoothing_length.
#include <vector>

#include "kernels/rheology.hpp"
#include "kernels/strain_rate.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"

namespace hourglass {

class RheologyStage {
 public:
  RheologyStage(const Scene& scene, const Patch& patch, const Boundary& boundary);

  /// in: fields (u, v with halos, p, grains, tracers); out: eta [M/T] in cells, interior.
  LimitCounts update(const Fields& fields, int threads, CellField& eta);

  /// |γ̇|^2 as the law saw it last, smoothed [1/T^2].
  const CellField& shear_rate_squared() const { return gamma2_; }
  Grain grain(int material) const { return grains_[material]; }
  std::size_t bytes() const { return gamma2_.bytes() + weighted_.bytes() + weight_.bytes(); }

 private:
  void smooth(Team& team, const Fields& fields, CellField& spare);

  Law law_;
  std::vector<Grain> grains_;
  std::vector<double> viscosity_;  ///< law newtonian: by material
  bool equal_properties_;
  ViscosityLimits limits_;
  bool periodic_;
  std::vector<SmoothingPass> passes_;
  CellField gamma2_, weighted_, weight_;
  std::vector<LimitCounts> row_counts_;
};

}  // namespace hourglass
