#pragma once
// One time step, n -> n+1. The choice of precision is made once, here.
#include <memory>

#include "kernels/boundary.hpp"
#include "kernels/geometry.hpp"
#include "solver/archive.hpp"
#include "solver/fields.hpp"
#include "solver/rheology.hpp"
#include "solver/scene.hpp"
#include "solver/simulation.hpp"
#include "solver/timers.hpp"
#include "solver/vof.hpp"

namespace hourglass {

class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Threads of the stages from now on; the results are the same for any number.
  virtual void set_threads(int threads) = 0;

  /// The first half of a step of dt: moves the grains. in: fields with velocity halos.
  virtual void advect(Fields& fields, double dt, bool x_first, Timers& timers) = 0;
  /// The second: what moves them next. out: fields at n+1. Fills the solver part of the report. Grains that are added
  /// between the two have a velocity without divergence when they are moved.
  virtual void accelerate(Fields& fields, double dt, Timers& timers, StepReport& report) = 0;
  /// What lies in solids, in air that is not solved, and in the halo of the velocity follows from the rest.
  virtual void fill_halo(Fields& fields) const = 0;
  /// Takes nothing over from the step before: the fields are other ones now.
  virtual void forget() = 0;
  /// Besides the fields, what the next step takes over from the last, and what the last leaves to be shown.
  virtual void walk(Archive& archive) = 0;
  /// Pressure that holds the present densities still against gravity, where walls allow it.
  virtual void hydrostatic(Fields& fields) = 0;
  /// Projects the velocity in fields, at any density.
  virtual SolveStats project(Fields& fields, double dt) = 0;

  virtual const Vof& vof() const = 0;
  /// What the last step carried through faces at the density of a full cell, by phase: volumes, or with dilatancy these
  /// times phi / phi_max [cell areas].
  virtual PhaseFlux mass_flux() const = 0;
  virtual const RheologyStage& rheology() const = 0;
  virtual const CellField& viscosity() const = 0;
  virtual std::vector<std::pair<std::string, std::size_t>> memory() const = 0;
};

/// For Scene::accuracy.precision. boundary and geometry (or nullptr) outlive it.
std::unique_ptr<Stepper> make_stepper(const Scene& scene, const Boundary& boundary, const Geometry* geometry,
                                      int threads);

}  // namespace hourglass
