#pragma once
// Advection of all materials by volume of fluid: two sweeps a step (kernels/vof_sweep.hpp).
#include <span>
#include <vector>

#include "kernels/geometry.hpp"
#include "kernels/vof_sweep.hpp"
#include "solver/fields.hpp"
#include "solver/scene.hpp"

namespace hourglass {

/// What went through all faces in a step, by phase: all grains, then materials 1, 2, ... [cell areas].
struct PhaseFlux {
  std::span<const XFaceField> x;
  std::span<const YFaceField> y;
};

class Vof {
 public:
  /// Allocates all scratch. `materials` counts material 0, the rest of the grains that no tracer fills.
  /// geometry: nullptr, or what outlives this.
  Vof(const Patch& patch, int materials, Ends ends = {}, const Geometry* geometry = nullptr,
      VofFlux flux = VofFlux::plic);

  /// Moves fields.grains and fields.tracers by u and v over dt [T], x sweep first or y sweep first (alternate
  /// for second order). Needs (|u| + |v|) dt < h / 2 to keep the shares in [0, 1] by itself; what lies
  /// outside all the same is put back beside (clipped()). Leaves in the halo of the shares their linear
  /// continuation.
  void advect(Fields& fields, double dt, bool x_first, int threads);

  /// Volume carried through the faces in the last step, boundary faces included, positive to +x and +y
  /// [cell areas]: k = 0 all grains, k >= 1 material k. Where the velocity is solenoidal, grains(n+1) is
  /// grains(n) less what leaves through the four faces, to rounding and to wisps of 1e-12 in each sweep.
  const XFaceField& flux_x(int k) const { return flux_x_[k]; }
  const YFaceField& flux_y(int k) const { return flux_y_[k]; }

  PhaseFlux flux() const { return {flux_x_, flux_y_}; }

  /// Volume found outside [0, 1], or a tracer's outside of the grains, since the start [cell areas]; and how
  /// much of it found no room within two cells and was lost.
  double clipped() const { return clipped_; }
  double lost() const { return lost_; }
  /// What carries the volumes: A u where there is a geometry, of the last step, else u itself.
  const Velocity& carrier(const Fields& fields) const { return geometry_ ? carrier_ : fields; }
  std::size_t bytes() const;

 private:
  template <At face>
  void sweep(Team& team, Fields& fields, const Field<face>& velocity, double dt_h,
             std::span<Field<face>> flux);
  void fill_halos(Rows rows, Fields& fields) const;
  void put_back(Fields& fields);

  Ends ends_;
  const Geometry* geometry_;
  VofFlux kind_;
  Velocity carrier_;
  DilationOwner owner_;
  std::vector<XFaceField> flux_x_;
  std::vector<YFaceField> flux_y_;
  RowSums excess_;
  double clipped_ = 0, lost_ = 0;
};

}  // namespace hourglass
