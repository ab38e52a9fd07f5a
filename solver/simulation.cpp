#include "solver/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "kernels/polygon.hpp"
#include "solver/boundary_of.hpp"
#include "solver/diagnostics.hpp"
#include "solver/step.hpp"
#include "solver/thread_governor.hpp"
#include "solver/time_step.hpp"

namespace hourglass {

const char* name_of(Status status) {
  switch (status) {
    case Status::finished:
      return "finished";
    case Status::stopped:
      return "stopped";
    case Status::diverged:
      return "diverged";
    case Status::interrupted:
      return "interrupted";
  }
  return "";
}

static int threads_of(const Scene& scene) { return scene.threads > 0 ? scene.threads : omp_get_num_procs(); }

struct Simulation::Impl {
  explicit Impl(const Scene& s)
      : scene(s), boundary(boundary_of(scene)), threads(threads_of(scene)),
        fields(scene.patch(), static_cast<int>(scene.materials.size())),
        stepper(make_stepper(scene, boundary, threads)), governor(threads),
        orifice_mass(scene.orifices.size()), orifice_material(scene.materials.size()) {}

  Scene scene;
  Boundary boundary;
  int threads;
  Fields fields;
  std::unique_ptr<Stepper> stepper;
  ThreadGovernor governor;
  Timers timers;
  double t = 0, dt = 0;  // dt of the last step; 0 before the first
  long steps = 0;
  std::vector<double> orifice_mass;      // by orifice, all materials
  std::vector<double> orifice_material;  // by material, all orifices
  double other_mass = 0;                 // through open sides

  void fill();
  void account();
  SeriesRow row(const StepReport& report) const;
};

/// Paints the fills in order, each cell by the share that a polygon covers.
void Simulation::Impl::fill() {
  const Patch& patch = fields.patch();
  for (const Fill& f : scene.fill) {
    const Polygon polygon(f.points.begin(), f.points.end());
    for (int j = 0; j < patch.ny; ++j)
      for (int i = 0; i < patch.nx; ++i) {
        const double share = covered_fraction(polygon, patch.x_corner(i), patch.y_corner(j),
                                              patch.x_corner(i + 1), patch.y_corner(j + 1));
        if (share <= 0) continue;
        const auto paint = [&](CellField& c, bool covered) {
          c(i, j) = share >= 1 ? (covered ? 1.0 : 0.0) : c(i, j) * (1 - share) + (covered ? share : 0.0);
        };
        paint(fields.grains, f.material >= 0);
        for (std::size_t k = 0; k < fields.tracers.size(); ++k)
          paint(fields.tracers[k], f.material == static_cast<int>(k) + 1);
      }
  }
  fill_cell_halo(boundary, fields.grains);
}

/// Adds what left in the last step to the accounts.
void Simulation::Impl::account() {
  const Patch& patch = fields.patch();
  std::array<std::vector<double>, 4> open{boundary.left.open, boundary.right.open, boundary.bottom.open,
                                          boundary.top.open};
  for (std::size_t o = 0; o < scene.orifices.size(); ++o) {
    const Orifice& orifice = scene.orifices[o];
    const FaceRange range = faces_of(orifice, patch);
    const auto lost = mass_through(scene, stepper->vof(), orifice.wall, range, patch);
    for (std::size_t k = 0; k < lost.size(); ++k) {
      orifice_mass[o] += lost[k];
      orifice_material[k] += lost[k];
    }
    auto& side = open[static_cast<int>(orifice.wall)];
    std::fill(side.begin() + range.first, side.begin() + range.last, 0.0);
  }
  for (int s = 0; s < 4; ++s)
    if (scene.walls[s] == Wall::open)
      for (double mass : mass_through(scene, stepper->vof(), static_cast<Side>(s),
                                      {0, static_cast<int>(open[s].size())}, patch))
        other_mass += mass;
}

/// State of the accounts; the outflows are totals since the start.
SeriesRow Simulation::Impl::row(const StepReport& report) const {
  SeriesRow r;
  r.step = report;
  r.material_mass = masses_by_material(scene, fields, threads);
  for (double m : r.material_mass) r.mass += m;
  const double g = std::hypot(scene.gravity[0], scene.gravity[1]);
  r.quasi_static_fraction = slow_fraction(fields, 1e-3 * std::sqrt(g * scene.materials[0].diameter), threads);
  r.max_speed = fastest_grains(fields, threads);
  r.orifice_outflow = orifice_mass;
  r.material_outflow = orifice_material;
  return r;
}

Simulation::Simulation(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {
  impl_->fill();
  if (scene.start_pressure == StartPressure::hydrostatic) impl_->stepper->hydrostatic(impl_->fields);
}
Simulation::~Simulation() = default;

const Scene& Simulation::scene() const { return impl_->scene; }
const Fields& Simulation::fields() const { return impl_->fields; }
Fields& Simulation::fields() { return impl_->fields; }
double Simulation::t() const { return impl_->t; }
const std::vector<double>& Simulation::orifice_mass() const { return impl_->orifice_mass; }
std::vector<double> Simulation::material_mass() const {
  return masses_by_material(impl_->scene, impl_->fields, impl_->threads);
}
double Simulation::grain_mass() const {
  double total = 0;
  for (double m : material_mass()) total += m;
  return total;
}
double Simulation::quasi_static_fraction() const {
  const Scene& s = impl_->scene;
  const double g = std::hypot(s.gravity[0], s.gravity[1]);
  return slow_fraction(impl_->fields, 1e-3 * std::sqrt(g * s.materials[0].diameter), impl_->threads);
}

std::vector<std::pair<std::string, std::size_t>> Simulation::memory() const {
  const Fields& f = impl_->fields;
  std::size_t state = f.u.bytes() + f.v.bytes() + f.p.bytes() + f.grains.bytes();
  for (const CellField& t : f.tracers) state += t.bytes();
  auto table = impl_->stepper->memory();
  table.insert(table.begin(), {"fields", state});
  return table;
}

StepReport Simulation::step(double t_limit) {
  Impl& s = *impl_;
  StepReport report;
  fill_velocity_halo(s.boundary, s.fields.u, s.fields.v);  // cheap, and callers may have set the velocity
  const auto start = Clock::now();
  s.threads = s.governor.next();
  s.stepper->set_threads(s.threads);
  FastestCells fastest;
  s.timers.time("time step", [&] { fastest = fastest_cells(s.fields, s.threads); });
  if (!std::isfinite(fastest.near_grains + fastest.air)) throw std::runtime_error(not_finite(s.fields));
  const TimeStep dt = choose_time_step(s.scene, fastest, s.fields.patch().h, s.dt, t_limit - s.t);
  s.stepper->step(s.fields, dt.dt, s.steps % 2 == 0, s.timers, report);
  s.account();
  // A viscous iteration costs about two of the pressure's, and all the rest about two viscous ones.
  s.governor.record(4 + 2 * report.viscous.iterations + report.pressure.iterations, seconds_since(start));
  s.t = dt.limit == DtLimit::end ? t_limit : s.t + dt.dt;
  if (dt.limit != DtLimit::end) s.dt = dt.dt;
  ++s.steps;
  report.step = s.steps;
  report.t = s.t;
  report.dt = dt.dt;
  report.limit = dt.limit;
  report.max_speed = std::max(fastest.near_grains, fastest.air);
  return report;
}

namespace {

/// What a solve's missed tolerance says.
std::string missed(const char* name, const SolveStats& s, const StepReport& report) {
  return fmt::format(
      "the {} solve missed its tolerance at t = {:.6g} (step {}): {:.3g} instead of {:.3g} after {} "
      "iterations, worst at cell ({}, {})",
      name, report.t, report.step, s.final, s.tolerance, s.iterations, s.worst_i, s.worst_j);
}

/// Hopeless: not a number, or so far off that going on would be a silent wrong answer.
bool failed(const SolveStats& s) {
  return !std::isfinite(s.final) || (!s.converged && s.final > 1e3 * s.tolerance);
}

/// Times at which something is due: every `interval` from 0 on.
class Cadence {
 public:
  explicit Cadence(double interval) : interval_(interval) {}
  bool due(double t) {
    if (interval_ <= 0 || t < next_ * (1 - 1e-12)) return false;
    while (next_ <= t * (1 + 1e-12)) next_ = interval_ * ++count_;
    return true;
  }

 private:
  double interval_, next_ = 0;
  long count_ = 0;
};

}  // namespace

Summary Simulation::run(const std::vector<Observer*>& observers) {
  Impl& s = *impl_;
  const Scene& scene = s.scene;
  Summary summary;
  summary.threads = threads_of(scene);
  summary.cells = s.fields.patch().cells();
  const auto tell = [&](auto&& f) {
    for (Observer* o : observers) f(*o);
  };
  const auto warn = [&](const std::string& text) {
    summary.warnings.push_back(text);
    tell([&](Observer& o) { o.on_warning(text); });
  };

  Cadence series(scene.output.series_every), frames(scene.output.fields_every),
      pictures(scene.output.snapshots_every);
  const double initial_mass = grain_mass();
  std::vector<std::array<double, 2>> mass_over_time{{s.t, initial_mass}};
  std::vector<std::array<double, 2>> static_over_time;
  SeriesRow last;
  double stepping = 0, outside = 0, frame_t = -1, picture_t = -1;
  const auto clock = Clock::now();

  const auto emit_series = [&](const StepReport& report, bool forced) {
    if (!series.due(s.t) && !(forced && last.step.t < s.t)) return;
    SeriesRow row = s.row(report);
    const SeriesRow totals = row;
    const double interval = s.t - last.step.t;
    const auto rate = [&](std::vector<double>& now, const std::vector<double>& before) {
      for (std::size_t k = 0; k < now.size(); ++k)
        now[k] = interval > 0 ? (now[k] - (before.empty() ? 0 : before[k])) / interval : 0;
    };
    rate(row.orifice_outflow, last.orifice_outflow);
    rate(row.material_outflow, last.material_outflow);
    for (double q : row.orifice_outflow) row.outflow += q;
    row.wall_seconds = seconds_since(clock);
    static_over_time.push_back({s.t, row.quasi_static_fraction});
    tell([&](Observer& o) { o.on_series(row); });
    last = totals;
  };
  const auto emit_frames = [&](bool forced) {
    if (frames.due(s.t) || (forced && scene.output.fields_every > 0 && frame_t < s.t)) {
      tell([&](Observer& o) { o.on_fields(*this); });
      frame_t = s.t;
    }
    if (pictures.due(s.t) || (forced && scene.output.snapshots_every > 0 && picture_t < s.t)) {
      tell([&](Observer& o) { o.on_snapshot(*this); });
      picture_t = s.t;
    }
  };

  StepReport report;
  report.t = s.t;
  emit_series(report, true);
  emit_frames(true);

  const double end = scene.time.end > 0 ? scene.time.end : 1e300;
  const double settle = start_up_time(scene);
  long misses_in_a_row = 0;
  bool checked_flow = false;
  double mass = initial_mass;
  summary.reason = "reached time.end";
  while (true) {
    if (s.t >= end) break;
    if (scene.time.max_steps > 0 && s.steps >= scene.time.max_steps) {
      summary.reason = "reached time.max_steps";
      break;
    }
    const auto start = Clock::now();
    try {
      report = step(end);
    } catch (const std::exception& error) {
      summary.status = Status::diverged;
      summary.reason = error.what();
      break;
    }
    stepping += seconds_since(start);
    const auto after = Clock::now();

    summary.worst_max_divergence = std::max(summary.worst_max_divergence, report.max_divergence);
    bool missed_now = false;
    for (const auto& [name, stats] :
         {std::pair{"pressure", &report.pressure}, {"viscous", &report.viscous}}) {
      if (stats->converged) continue;
      missed_now = true;
      ++summary.missed_tolerances;
      if (summary.missed_tolerances <= 20) warn(missed(name, *stats, report));
      if (failed(*stats)) {
        summary.status = Status::diverged;
        summary.reason = missed(name, *stats, report);
      }
    }
    misses_in_a_row = missed_now ? misses_in_a_row + 1 : 0;
    if (misses_in_a_row >= 20 && summary.status != Status::diverged) {
      summary.status = Status::diverged;
      summary.reason =
          "a solve missed its tolerance in 20 steps in a row; the last: " + summary.warnings.back();
    }
    if (summary.status == Status::diverged) break;

    mass = grain_mass();
    mass_over_time.push_back({s.t, mass});
    emit_series(report, false);
    emit_frames(false);

    if (!checked_flow && settle > 0 && s.t > settle) {
      checked_flow = true;
      for (std::size_t o = 0; o < scene.orifices.size(); ++o) {
        const Orifice& orifice = scene.orifices[o];
        const double g = std::hypot(scene.gravity[0], scene.gravity[1]);
        const double free_flow =
            scene.materials[0].density * std::sqrt(g) * std::pow(orifice.width, 1.5) * s.t;
        if (s.orifice_mass[o] < 1e-3 * free_flow)
          warn(
              fmt::format("orifice {} is open but does not flow: {:.3g} left in the first {:.3g}; an orifice "
                          "of this width "
                          "would let out about {:.3g} (jammed, or no grains above it)",
                          o, s.orifice_mass[o], s.t, free_flow));
      }
    }
    if (scene.stop.mass_below && mass < *scene.stop.mass_below * initial_mass) {
      summary.status = Status::stopped;
      summary.reason = fmt::format("grain mass fell below {} of the initial mass", *scene.stop.mass_below);
      break;
    }
    if (scene.stop.steady_discharge && settle > 0 && s.t > 3 * settle) {
      const auto mass_at = [&](double t) {
        const auto it = std::lower_bound(mass_over_time.begin(), mass_over_time.end(), t,
                                         [](const auto& sample, double time) { return sample[0] < time; });
        return *it;
      };
      const auto a = mass_at(s.t - 2 * settle), b = mass_at(s.t - settle);
      const double before = (a[1] - b[1]) / (b[0] - a[0]), now = (b[1] - mass) / (s.t - b[0]);
      if (now > 0 && std::abs(now - before) < *scene.stop.steady_discharge * now) {
        summary.status = Status::stopped;
        summary.reason = fmt::format("discharge steady to {}", *scene.stop.steady_discharge);
        break;
      }
    }
    double done = scene.time.end > 0 ? s.t / scene.time.end : 0;
    if (scene.time.max_steps > 0) done = std::max(done, static_cast<double>(s.steps) / scene.time.max_steps);
    if (scene.stop.mass_below)
      done = std::max(done, (initial_mass - mass) / (initial_mass * (1 - *scene.stop.mass_below)));
    std::string interrupted;
    tell([&](Observer& o) {
      o.on_step(report, std::min(done, 1.0));
      if (std::string reason = o.interrupt(); !reason.empty()) interrupted = reason;
    });
    outside += seconds_since(after);
    if (!interrupted.empty()) {
      summary.status = Status::interrupted;
      summary.reason = interrupted;
      break;
    }
  }

  if (summary.status != Status::diverged || not_finite(s.fields).empty()) {
    emit_series(report, true);
    emit_frames(true);
  }
  const DischargeWindow window = discharge(scene, mass_over_time);
  summary.discharge_rate = window.rate;
  summary.discharge_window[0] = window.from;
  summary.discharge_window[1] = window.to;
  double width = 0, through_orifices = 0;
  for (const Orifice& o : scene.orifices) width += o.width;
  const double g = std::hypot(scene.gravity[0], scene.gravity[1]);
  if (width > 0 && g > 0)
    summary.discharge_constant =
        window.rate / (scene.materials[0].density * std::sqrt(g) * std::pow(width, 1.5));
  double share = 0, rows = 0;
  for (const auto& [time, fraction] : static_over_time)
    if (time >= window.from && time <= window.to) {
      share += fraction;
      rows += 1;
    }
  summary.quasi_static_fraction = rows > 0 ? share / rows : quasi_static_fraction();
  for (double m : s.orifice_mass) through_orifices += m;
  if (initial_mass > 0)
    summary.mass_error =
        std::abs((initial_mass - grain_mass()) - (through_orifices + s.other_mass)) / initial_mass;
  summary.steps = s.steps;
  summary.wall_seconds = stepping;
  if (stepping > 0) summary.cell_steps_per_second = static_cast<double>(s.steps) * summary.cells / stepping;
  s.timers.add("output and diagnostics", outside);
  summary.stages = s.timers.stages();
  return summary;
}

SolveStats project_noise(const Scene& scene) {
  Scene quiet = scene;
  Simulation::Impl impl(quiet);
  impl.fill();
  std::mt19937 random(12345);
  std::uniform_real_distribution<double> noise(-1, 1);
  for (int j = 0; j < impl.fields.u.ny(); ++j)
    for (int i = 0; i < impl.fields.u.nx(); ++i) impl.fields.u(i, j) = noise(random);
  for (int j = 0; j < impl.fields.v.ny(); ++j)
    for (int i = 0; i < impl.fields.v.nx(); ++i) impl.fields.v(i, j) = noise(random);
  return impl.stepper->project(impl.fields, scene.time.dt_max);
}

CellField Simulation::derived(const std::string& name) const {
  const Fields& f = impl_->fields;
  const Patch& patch = f.patch();
  CellField out(patch);
  const auto each = [&](auto&& value) {
    for (int j = 0; j < patch.ny; ++j)
      for (int i = 0; i < patch.nx; ++i) out(i, j) = value(i, j);
  };
  const auto vx = [&](int i, int j) { return 0.5 * (f.u(i, j) + f.u(i + 1, j)); };
  const auto vy = [&](int i, int j) { return 0.5 * (f.v(i, j) + f.v(i, j + 1)); };
  const CellField& gamma2 = impl_->stepper->rheology().shear_rate_squared();
  const auto shear_rate = [&](int i, int j) { return gamma2.allocated() ? std::sqrt(gamma2(i, j)) : 0.0; };
  if (name == "speed") {
    each([&](int i, int j) { return std::hypot(vx(i, j), vy(i, j)); });
  } else if (name == "velocity_x") {
    each(vx);
  } else if (name == "velocity_y") {
    each(vy);
  } else if (name == "pressure") {
    each([&](int i, int j) { return f.p(i, j); });
  } else if (name == "grains") {
    each([&](int i, int j) { return f.grains(i, j); });
  } else if (name == "tracer") {  // share of the grains that is not material 0
    each([&](int i, int j) {
      double share = 0;
      for (const CellField& t : f.tracers) share += t(i, j);
      return f.grains(i, j) > 0 ? std::min(share / f.grains(i, j), 1.0) : 0.0;
    });
  } else if (name == "viscosity") {
    each([&](int i, int j) { return impl_->stepper->viscosity()(i, j); });
  } else if (name == "shear_rate") {
    each(shear_rate);
  } else if (name == "inertial_number") {
    const Grain grain = impl_->stepper->rheology().grain(0);
    each([&](int i, int j) {
      return f.grains(i, j) > 0.5 && f.p(i, j) > 0 ? inertial_number(shear_rate(i, j), f.p(i, j), grain)
                                                   : 0.0;
    });
  } else {
    throw std::invalid_argument("no field is called " + name);
  }
  return out;
}

const std::vector<FieldInfo>& known_fields() {
  static const std::vector<FieldInfo> fields{
      {"speed", "L/T", "speed", true},
      {"velocity_x", "L/T", "horizontal velocity", false},
      {"velocity_y", "L/T", "vertical velocity", false},
      {"pressure", "M/T^2", "pressure", false},
      {"grains", "1", "grain fraction", false},
      {"tracer", "1", "tracer share of grains", false},
      {"viscosity", "M/T", "viscosity", true},
      {"shear_rate", "1/T", "shear rate", true},
      {"inertial_number", "1", "inertial number I", true},
  };
  return fields;
}

}  // namespace hourglass
