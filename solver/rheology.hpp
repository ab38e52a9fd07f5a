#pragma once
// eta = c eta_grains(|γ̇|, p) + (1 - c) eta_air in cells, with |γ̇|^2 smoothed over rheology.smoothing_length; and what the
// modules that a scene names need of |γ̇|, I and P, while these are at hand.
#include <vector>

#include "kernels/geometry.hpp"
#include "kernels/rheology.hpp"
#include "kernels/strain_rate.hpp"
#include "solver/archive.hpp"
#include "solver/dilatancy.hpp"
#include "solver/fluidity.hpp"
#include "solver/grain_properties.hpp"

namespace hourglass {

class RheologyStage {
 public:
  /// geometry: nullptr, or what outlives this.
  RheologyStage(const Scene& scene, const Patch& patch, const Boundary& boundary,
                const Geometry* geometry = nullptr);

  /// Modules that share the rows; nullptr: the scene does not name them.
  struct Modules {
    FluidityStage* fluidity = nullptr;
    DilatancyStage* dilatancy = nullptr;
  };
  struct Result {
    LimitCounts limits;
    SolveStats fluidity;
  };

  /// in: fields (u, v with halos, p, grains, tracers); out: eta [M/T] in cells, interior; fields.fluidity.
  Result update(Fields& fields, int threads, CellField& eta, const Modules& modules);

  /// |γ̇|^2 as the law saw it last, smoothed [1/T^2].
  const CellField& shear_rate_squared() const { return gamma2_; }
  /// F P c, force of the front and back walls on the grains [M/(L T^2)]; not allocated without physics.wall_friction.
  const CellField& wall_force() const { return wall_force_; }
  const GrainProperties& properties() const { return properties_; }
  /// What the last update leaves to be shown.
  void walk(Archive& archive) {
    if (gamma2_.allocated()) archive.field("shear_rate_squared", gamma2_);
  }
  std::size_t bytes() const {
    return gamma2_.bytes() + weighted_.bytes() + weight_.bytes() + wall_force_.bytes();
  }

 private:
  void smooth(Team& team, const Fields& fields, CellField& spare);
  void finish_shear_rate_row(const Fields& fields, int j);
  void shear_rate_row(const Fields& fields, int j, double* out) const;
  void newtonian_row(const Fields& fields, int j, GrainProperties::Rows& properties, double* eta);
  void general_row(const Fields& fields, int j, const Modules& modules, double* eta);
  void count_row(const Fields& fields, int j, const double* eta);

  Law law_;
  GrainProperties properties_;
  std::vector<RegularisedFriction> regularised_;  ///< by material; law mu_I_regularised
  ViscosityLimits limits_;
  const Geometry* geometry_;
  bool smooth_cap_, deviatoric_, general_, axisymmetric_;
  Ends ends_;
  std::vector<SmoothingPass> passes_;
  CellField gamma2_, weighted_, weight_, wall_force_;
  std::vector<LimitCounts> row_counts_;
};

}  // namespace hourglass
