#pragma once
// Properties of the grains along a row of cells: those of the one material, or linear means by volume share.
#include <array>
#include <vector>

#include "kernels/granular_laws.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"

namespace hourglass {

class GrainProperties {
 public:
  /// What may differ by material. A_d = A d [L], of physics.nonlocal; phi_g and F of their modules.
  enum Property { mu_s, delta_mu, I_0, d_sqrt_rho, cohesion, viscosity, A_d, phi_g, F, count };

  explicit GrainProperties(const Scene& scene);

  const std::vector<double>& by_material(Property p) const { return values_[p]; }
  bool equal(Property p) const { return equal_[p]; }
  /// Whether no property of the law differs.
  bool equal_law() const;
  /// The law's properties of one material.
  const Grain& grain(int material) const { return grains_[material]; }

  /// Rows of means, in memory of the calling thread until the next of this kind on it.
  class Rows {
   public:
    /// Row j of the interior.
    Rows(const GrainProperties& properties, const Fields& fields, int j);
    const double* operator[](Property p);  ///< made at the first call
    GrainRows law() {
      return {(*this)[mu_s], (*this)[delta_mu], (*this)[I_0], (*this)[d_sqrt_rho], (*this)[cohesion]};
    }
    const double* share(int material) const {
      return shares_[material - 1];
    }                        ///< of the grains; material >= 1
    double* scratch(int k);  ///< further rows, k = 0 .. 7

   private:
    const GrainProperties& properties_;
    const int n_;
    std::array<bool, count> made_{};
    std::vector<const double*>& shares_;
    std::vector<double>& memory_;
    double* row(int k) { return memory_.data() + static_cast<std::size_t>(k) * stride(); }
    int stride() const { return (n_ + 7) / 8 * 8; }
  };

 private:
  std::vector<Grain> grains_;  ///< by material
  std::array<std::vector<double>, count> values_;
  std::array<bool, count> equal_;
};

}  // namespace hourglass
