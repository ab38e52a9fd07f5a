#pragma once
// One scene from start to end: chooses dt, steps, diagnoses, tells observers, stops.
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solver/fields.hpp"
#include "solver/initial_state.hpp"
#include "solver/scene.hpp"
#include "solver/solve_stats.hpp"

namespace hourglass {

/// What limited the time step.
enum class DtLimit { dt_max, cfl, cfl_air, growth, end, back_off };
inline constexpr int dt_limits = 6;
const char* name_of(DtLimit limit);

struct StepReport {
  long step = 0;
  double t = 0, dt = 0;  ///< time at the end of the step; its length [T]
  DtLimit limit = DtLimit::dt_max;
  SolveStats pressure, viscous;
  SolveStats fluidity;        ///< of physics.nonlocal; 0 iterations without
  double max_divergence = 0;  ///< max |div u| dt [1]
  double max_speed = 0;       ///< grains and air [L/T]
  long capped_cells = 0;      ///< grain cells at eta_max
  long floored_cells = 0;     ///< grain cells at eta_min
};

/// Shares of the grain volume that hardly moves.
struct SlowGrains {
  double quasi_static_fraction = 0;                   ///< slower than 1e-3 sqrt(g d)
  double quasi_static_1e2 = 0, quasi_static_1e4 = 0;  ///< slower than 1e-2, 1e-4 sqrt(g d)
  /// Of quasi_static_fraction, what lies straight above flat tops of inserts; with such an insert.
  std::optional<double> quasi_static_above_flat_top;
};

/// A row of series.csv.
struct SeriesRow : SlowGrains {
  StepReport step;
  double mass = 0;     ///< grains in the domain [M per unit depth]
  double outflow = 0;  ///< flux of grains through all orifices [M/T], mean since the last row
  std::vector<double> orifice_outflow;   ///< the same by orifice
  std::vector<double> material_mass;     ///< by material [M]
  std::vector<double> material_outflow;  ///< through all orifices, by material [M/T]
  std::optional<double> fed;             ///< what the feed brings [M/T], mean since the last row; with a feed
  double ill_posed_fraction =
      0;                 ///< grain cells where mu(I) is ill-posed (field well_posed), over all grain cells
  double max_speed = 0;  ///< of grains [L/T]
  double wall_seconds = 0;
};

enum class Status { finished, stopped, diverged, interrupted };
const char* name_of(Status status);

/// A figure of merit over time: [T], value.
using History = std::vector<std::array<double, 2>>;

/// What accuracy.extrapolate makes of the same scene on several grids; all figures over the same window of time.
struct Extrapolation {
  std::vector<long> cells;              ///< of each grid, the coarsest first
  std::vector<double> discharge_rates;  ///< on each grid [M/T]
  double order = 0;  ///< at which the discharge was extrapolated; 0: its grids agree on none
  double discharge_rate = 0, error_bar = 0;                      ///< at vanishing cells, and of it [M/T]
  double quasi_static_fraction = 0, quasi_static_error_bar = 0;  ///< the same [1]
  /// By how much half the steps' length changes the discharge on the coarsest grid [1]; none with one coarser grid.
  std::optional<double> step_change;
  double seconds = 0;  ///< that the coarser grids took
};

/// What summary.json holds of the physics; provenance is io's business. Slow grains: the mean over the rows of the series in
/// the window of the discharge, or at the end.
struct Summary : SlowGrains {
  Status status = Status::finished;
  std::string reason;
  double discharge_rate = 0;  ///< least-squares slope of mass less feed over time, start-up left out [M/T]
  double discharge_constant = 0;        ///< discharge_rate / discharge_scale(), W the total width
  double discharge_window[2] = {0, 0};  ///< the times that the slope was taken over [T]
  double mass_error = 0;                ///< |grain loss + feed - integrated outflow| / initial mass
  double worst_max_divergence = 0;
  long missed_tolerances = 0;
  long back_offs = 0;  ///< how often the run went back and on with more care (docs/theory.md, Trouble)
  long steps = 0, cells = 0;
  double wall_seconds = 0;  ///< stepping only
  double cell_steps_per_second = 0;
  int threads = 1;
  std::vector<std::pair<std::string, double>> stages;  ///< seconds by stage
  std::optional<Extrapolation> extrapolation;
  History mass_over_time;             ///< less what was fed, after each step [M]
  History quasi_static_over_time;     ///< at each row of the series
  std::vector<std::string> warnings;  ///< guards that spoke, e.g. an open orifice that does not flow
};

/// Told of what happens; io's writers are observers. `t` of the simulation is the time of what is shown.
class Simulation;
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void on_series(const SeriesRow&) {}
  virtual void on_fields(const Simulation&) {}
  virtual void on_snapshot(const Simulation&) {}
  virtual void on_step(const StepReport&, double /*fraction_done*/) {}
  virtual void on_warning(const std::string&) {}
  /// Asked after every step; a non-empty answer interrupts the run with that reason.
  virtual std::string interrupt() { return {}; }
};

class Simulation {
 public:
  /// Allocates everything and fills the domain. The scene must be free of fatal problems (check()) and of model mu_I;
  /// std::invalid_argument for another, which steady_flow() is for.
  explicit Simulation(const Scene& scene);
  ~Simulation();

  /// One time step, not past `t_limit`.
  StepReport step(double t_limit = 1e300);
  /// Steps to the end of the scene, telling the observers. An exception of an observer ends the run as
  /// `interrupted`, with its words as the reason.
  Summary run(const std::vector<Observer*>& observers = {});

  /// Replaces what the fills put into the domain, before the first step. Grains and tracers keep their volumes where there
  /// are no solids and no axis; the velocity is interpolated to faces and made free of divergence.
  void begin_with(const InitialState& state);

  const Scene& scene() const;
  /// With air model none they end some rows above the grains.
  const Fields& fields() const;
  Fields& fields();  ///< for initial conditions and verification flows
  double t() const;
  double grain_mass() const;
  std::vector<double> material_mass() const;
  /// Grains through each orifice since the start, outward positive, integrated at the faces [M].
  const std::vector<double>& orifice_mass() const;
  /// Derived cell fields by the names of `output.fields`: speed, velocity_x, velocity_y, pressure, grains,
  /// tracer, viscosity, shear_rate, inertial_number, well_posed; with their modules fluidity, fluidity_ratio, packing,
  /// dilation. Unknown name: std::invalid_argument.
  CellField derived(const std::string& name) const;
  std::vector<std::pair<std::string, std::size_t>> memory() const;  ///< bytes by array group

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

/// One projection of random noise with the scene's own boundaries: what `hourglass check` runs.
SolveStats project_noise(const Scene& scene);

/// The names that output.fields and render accept, with unit dimension and description.
struct FieldInfo {
  const char* name;
  const char* dimension;  ///< of "L", "T", "M": e.g. "L/T"
  const char* label;
  bool logarithmic;              ///< pictures use a log colour scale
  const char* module = nullptr;  ///< the block under physics: that makes it; nullptr: always there
};
const std::vector<FieldInfo>& known_fields();

/// k of the field tracer_k, the share of material k in the grains; 0: it is no such field.
std::size_t tracer_number(const std::string& field);

/// Whether a scene has the block of this name under physics: ("nonlocal", "dilatancy", "wall_friction").
bool has_module(const Scene& scene, const std::string& module);

/// Whether a run of the scene has the field: by its model, modules and materials.
bool has_field(const Scene& scene, const FieldInfo& field);

}  // namespace hourglass
