#pragma once
// The models of steady silo flow in closed form (Scene::model other than mu_I; docs/models.md) on the grid of
// a scene, with the grains of its fills. Nothing is stepped: all of it takes milliseconds.
#include <optional>
#include <string>

#include "solver/models/kinematic.hpp"
#include "solver/simulation.hpp"

namespace hourglass {

struct SteadyFlow {
  CellField grains;                  ///< share of the cell, as at the start of a run
  CellField velocity_x, velocity_y;  ///< at cell centres [L/T]; 0 where there are no grains
  CellField pressure;                ///< mean of the major and the minor stress [M/T^2]; model radial only
  SeriesRow row;                     ///< of the whole silo
  Summary summary;

  /// By the names of output.fields, of those that has_field() allows; else std::invalid_argument.
  CellField derived(const std::string& name) const;
};

/// Fills in what the block of the scene's model leaves open, and adds the block if there is none. Does
/// nothing for mu_I.
void resolve_model(Scene& scene);

/// The field of a scene without fatal problems (check()) and of a model other than mu_I.
SteadyFlow steady_flow(const Scene& scene);

/// Its orifices as sources of a linear model that together discharge Q [M/T], shared by W^1.5.
Floor floor_of(const Scene& scene, double Q, OrificeForm form);

/// The hopper of the radial model, resolved.
RadialHopper radial_hopper(const Scene& scene);

/// Where a field can be evaluated without a grid: velocity [L/T] at a place of the domain, grains or not.
class SteadyModel {
 public:
  explicit SteadyModel(const Scene& scene);
  ~SteadyModel();
  PointVelocity velocity(double x, double y) const;
  double pressure(double x, double y) const;  ///< [M/T^2]; 0 but for radial

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hourglass
