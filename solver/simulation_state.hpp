#pragma once
// What a simulation holds; for solver/simulation.cpp and solver/run.cpp only.
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "solver/archive.hpp"
#include "solver/boundary_of.hpp"
#include "solver/geometry.hpp"
#include "solver/simulation.hpp"
#include "solver/step.hpp"
#include "solver/thread_governor.hpp"
#include "solver/timers.hpp"

namespace hourglass {

/// Threads that a scene asks for.
int threads_of(const Scene& scene);
/// The arrays that it needs.
Fields fields_of(const Scene& scene);

/// Where a run stands, besides its fields. A new member goes into walk() too.
struct Tally {
  double t = 0, dt = 0;  // dt of the last step; 0 before the first
  long steps = 0;
  std::vector<double> orifice_mass;      // by orifice, all materials
  std::vector<double> orifice_material;  // by material, all orifices
  double other_mass = 0;                 // through open sides
  double fed_mass = 0;                   // by Scene::feed
  double lost_volume = 0;                // through all of them, times the density: what mode weight conserves

  void walk(Archive& archive) {
    archive.number("t", t);
    archive.number("dt", dt);
    archive.number("steps", steps);
    for (const auto& [name, totals] :
         {std::pair{"orifice_mass", &orifice_mass}, {"orifice_material", &orifice_material}}) {
      const std::vector<double> before = *totals;
      archive.numbers_like(name, *totals, before);
      totals->resize(before.size());
    }
    archive.number("other_mass", other_mass);
    archive.number("fed_mass", fed_mass);
    archive.number("lost_volume", lost_volume);
  }
};

struct Simulation::Impl : Tally {
  explicit Impl(const Scene& s)
      : scene(s), solved(s), boundary(boundary_of(solved)), geometry(geometry_of(solved, boundary)),
        ways_out(ways_out_of(solved, boundary)), threads(threads_of(scene)), fields(fields_of(solved)),
        stepper(make_stepper(solved, boundary, geometry.get(), threads)),
        governor(threads), rows{RowSums(fields.p.ny()), RowSums(fields.p.ny())} {
    orifice_mass.resize(scene.orifices.size());
    orifice_material.resize(scene.materials.size());
  }

  Scene scene;
  Scene
      solved;  // the same, but for its height where rows above the grains are left out, and for care (take_care)
  Boundary boundary;
  std::unique_ptr<Geometry> geometry;  // nullptr: whole cells
  std::vector<WayOut> ways_out;
  int threads;
  Fields fields;
  std::unique_ptr<Stepper> stepper;
  ThreadGovernor governor;
  std::array<RowSums, 2> rows;  // of fastest_cells
  Timers timers;
  /// A state to go back to.
  struct Backup {
    Tally tally;
    Fields fields;
    double height;
  };
  std::optional<Backup> backup;  // none before the first keep(), or where the scene wants none
  double dt_most = 1e300;        // of a run that has backed off [T]

  void fill();
  void feed();
  void fit_height();
  void set_height(double height);
  void keep();
  void walk(Archive& archive);
  void go_back();
  void take_care(int rung);
  double mass_error(double initial_mass) const;
  void account();
  SeriesRow row(const StepReport& report) const;
};

}  // namespace hourglass
