#include "solver/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "solver/diagnostics.hpp"
#include "solver/painting.hpp"
#include "solver/quasi_static.hpp"
#include "solver/simulation_state.hpp"
#include "solver/time_step.hpp"

namespace hourglass {

Fields fields_of(const Scene& scene) {
  return Fields(scene.patch(), static_cast<int>(scene.materials.size()), scene.nonlocal.has_value(),
                scene.dilatancy.has_value());
}

int threads_of(const Scene& scene) { return scene.threads > 0 ? scene.threads : omp_get_num_procs(); }

void Simulation::Impl::fill() {
  paint(scene, geometry.get(), fields);
  for (std::size_t k = 0; k < fields.solid.size(); ++k)  // at rest: phi_max
    fields.solid[k] = k == 0 ? fields.grains : fields.tracers[k - 1];
  fill_cell_halo(boundary, fields.grains);
}

void Simulation::begin_with(const InitialState& state) {
  Impl& s = *impl_;
  Fields& f = s.fields;
  const Patch& patch = f.patch();
  const std::vector<CellField> shares = regrid(state.shares, patch);
  const CellField vx = regrid(state.velocity_x, patch), vy = regrid(state.velocity_y, patch);
  CellField solid;  // as Fields::solid, of all grains
  if (state.packing.allocated()) {
    solid = state.shares[0];
    for (int j = 0; j < solid.ny(); ++j)
      for (int i = 0; i < solid.nx(); ++i)
        if (solid(i, j) > 0.5) solid(i, j) *= state.packing(i, j) / s.scene.dilatancy->phi_max;
    solid = std::move(regrid({state.shares[0], solid}, patch)[1]);
  }
  f.p = regrid(state.pressure, patch);
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i) {
      const bool open = !s.geometry || s.geometry->volume(i, j) > 0;
      double room = f.grains(i, j) = open ? std::clamp(shares[0](i, j), 0.0, 1.0) : 0.0;
      for (std::size_t k = 0; k < f.tracers.size(); ++k) {
        f.tracers[k](i, j) = std::clamp(shares[k + 1](i, j), 0.0, room);
        room -= f.tracers[k](i, j);
      }
      const double loose =
          solid.allocated() && f.grains(i, j) > 0 ? std::min(solid(i, j) / f.grains(i, j), 1.0) : 1;
      for (std::size_t k = 0; k < f.solid.size(); ++k)
        f.solid[k](i, j) = loose * (k == 0 ? f.grains(i, j) : f.tracers[k - 1](i, j));
    }
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i <= patch.nx; ++i)
      f.u(i, j) = 0.5 * (vx(std::max(i - 1, 0), j) + vx(std::min(i, patch.nx - 1), j));
  for (int j = 0; j <= patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      f.v(i, j) = 0.5 * (vy(i, std::max(j - 1, 0)) + vy(i, std::min(j, patch.ny - 1)));
  if (s.geometry) fill_solid_shares(*s.geometry, f);
  fill_cell_halo(s.boundary, f.grains);
  s.stepper->fill_halo(f);
  const CellField p = f.p;
  s.stepper->project(f, s.scene.time.dt_max);
  f.p = p;
}

/// Without air nothing happens above the grains: their rows are left out of everything, by whole numbers of the cells that
/// the coarser grids need, and come back if grains fly up.
void Simulation::Impl::fit_height() {
  const Patch whole = scene.patch(), now = fields.patch();
  if (scene.air.model != AirModel::none || scene.feed || scene.wall(Side::top) != Wall::open) return;
  if (scene.dilatancy && scene.dilatancy->mode == DilatancyMode::weight) return;  // remembers the step before
  constexpr int margin = 8, coarsest = 16;
  int unit = 1;
  while (unit < coarsest && whole.ny % (2 * unit) == 0) unit *= 2;
  const auto empty = [&](int j) {
    const double* c = fields.grains.row(j);
    return std::all_of(c, c + now.nx, [](double x) { return x == 0; });
  };
  int top = now.ny;
  while (top > 0 && empty(top - 1)) --top;
  const int needed = std::min(whole.ny, (top + margin + unit - 1) / unit * unit);
  const bool too_low = now.ny < whole.ny && top + margin / 2 > now.ny;
  const bool too_high = needed <= now.ny - std::max(unit, now.ny / 8);
  if (too_low || too_high) set_height(needed * now.h);
}

/// Solves the rows up to this height from now on; what was above is lost.
void Simulation::Impl::set_height(double height) {
  solved.height = height;
  boundary = boundary_of(solved);
  geometry = geometry_of(solved, boundary);
  ways_out = ways_out_of(solved, boundary);
  const Fields before = std::move(fields);
  fields = fields_of(solved);
  const auto take = [](const auto& from, auto& to) {
    for (int j = 0; j < std::min(from.ny(), to.ny()); ++j)
      std::copy(from.row(j), from.row(j) + from.nx(), to.row(j));
  };
  take(before.u, fields.u);
  take(before.v, fields.v);
  take(before.p, fields.p);
  take(before.grains, fields.grains);
  for (std::size_t k = 0; k < fields.tracers.size(); ++k) take(before.tracers[k], fields.tracers[k]);
  for (std::size_t k = 0; k < fields.solid.size(); ++k) take(before.solid[k], fields.solid[k]);
  if (fields.fluidity.allocated()) take(before.fluidity, fields.fluidity);
  fill_cell_halo(boundary, fields.grains);
  stepper = make_stepper(solved, boundary, geometry.get(), threads);
  rows = {RowSums(fields.p.ny()), RowSums(fields.p.ny())};
}

/// Keeps this state to go back to.
void Simulation::Impl::keep() {
  if (backup) {
    backup->tally = *this;
    backup->fields = fields;
    backup->height = solved.height;
  } else {
    backup.emplace(Backup{*this, fields, solved.height});
  }
}

/// Back to the state kept.
void Simulation::Impl::go_back() {
  if (backup->height != solved.height) set_height(backup->height);
  static_cast<Tally&>(*this) = backup->tally;
  fields = backup->fields;
  stepper->forget();
}

/// Throws std::runtime_error unless fit_height() could have chosen it.
static void check_height(const Scene& scene, double height) {
  const double rows = height / scene.patch().h;
  if (!(rows > 0.5 && height <= scene.height && std::abs(rows - std::round(rows)) < 1e-6))
    throw std::runtime_error("height: no rows of cells come out of it");
}

/// All that the next step and the next going back depend on, but for the rung (take_care), which comes first.
void Simulation::Impl::walk(Archive& archive) {
  const auto walk_fields = [&](Fields& all) {
    each_field(all, [&](const std::string& name, auto& field) { archive.field(name, field); });
  };
  double height = solved.height;
  archive.number("height", height);
  check_height(scene, height);
  if (height != solved.height) set_height(height);
  Tally::walk(archive);
  archive.number("dt_most", dt_most);
  walk_fields(fields);
  archive.group("stepper", [&] { stepper->walk(archive); });
  archive.group("backup", [&] {
    bool kept = backup.has_value();
    archive.number("kept", kept);
    if (!kept) return;
    if (archive.restoring()) keep();
    archive.number("height", backup->height);
    check_height(scene, backup->height);
    if (archive.restoring()) {
      Scene whole = scene;
      whole.height = backup->height;
      backup->fields = fields_of(whole);
    }
    backup->tally.walk(archive);
    walk_fields(backup->fields);
  });
  timers.walk(archive);
}

/// From which rung of the ladder on solves run in double throughout, with more sweeps.
constexpr int careful_rung = 2;

/// How carefully the next steps are solved: rung 0 as the scene says, higher ones with more iterations, then all in
/// double and with more sweeps. Their length is dt_most.
void Simulation::Impl::take_care(int rung) {
  const Accuracy before = solved.accuracy;
  solved.accuracy = scene.accuracy;
  if (rung > 0) solved.accuracy.max_iterations = 4 * scene.accuracy.max_iterations;
  if (rung >= careful_rung) {
    solved.accuracy.precision = Precision::full;
    solved.accuracy.extra_sweeps = scene.accuracy.extra_sweeps + 2;
  }
  if (solved.accuracy.precision != before.precision || solved.accuracy.extra_sweeps != before.extra_sweeps)
    stepper = make_stepper(solved, boundary, geometry.get(), threads);
}

/// What the accounts miss, over the mass at the start: |loss of grains + feed - outflow|.
double Simulation::Impl::mass_error(double initial_mass) const {
  if (initial_mass <= 0) return 0;
  const bool by_volume =
      scene.dilatancy && scene.dilatancy->mode == DilatancyMode::weight;  // conserves it, not mass
  double gone = lost_volume, left = 0;
  if (!by_volume) {
    gone = other_mass;
    for (double m : orifice_mass) gone += m;
  }
  for (double m : masses_by_material(scene, fields, geometry.get(), threads, by_volume)) left += m;
  return std::abs((initial_mass + fed_mass - left) - gone) / initial_mass;
}

/// Tops the grains up to the level, each column from there down to the first full cell, with grains at the velocity that is
/// there. Air below grains stays.
void Simulation::Impl::feed() {
  if (!scene.feed) return;
  const Patch& patch = fields.patch();
  const auto [material, level] = *scene.feed;
  double volume = 0;
  const auto top = std::min(static_cast<int>(std::ceil((level - patch.y0) / patch.h)), patch.ny) - 1;
  for (int i = 0; i < patch.nx; ++i)
    for (int j = top; j >= 0; --j) {
      const double open = geometry ? geometry->volume(i, j) : 1;
      const double before = fields.grains(i, j);
      const double missing = std::min((level - patch.y_corner(j)) / patch.h, 1.0) - before;
      if (missing > 0 && open > 0) {
        fields.grains(i, j) += missing;
        if (material > 0) fields.tracers[material - 1](i, j) += missing;
        if (!fields.solid.empty()) fields.solid[0](i, j) += missing;
        if (!fields.solid.empty() && material > 0) fields.solid[material](i, j) += missing;
        volume += missing * open;
      }
      if (open == 0 || before > 0.999) break;
    }
  fill_cell_halo(boundary, fields.grains);
  fed_mass += volume * patch.h * patch.h * scene.copies() * scene.materials[material].density;
}

/// Adds what left in the last step to the accounts.
void Simulation::Impl::account() {
  const auto each_way_out = [&](const PhaseFlux& flux, int k, auto&& leave) {
    for (const WayOut& o : ways_out) leave(o.orifice, mass_through(solved, flux, o.side, o.faces, k));
  };
  for (int k = 0; k < static_cast<int>(scene.materials.size()); ++k) {
    each_way_out(stepper->mass_flux(), k, [&](int orifice, double lost) {
      if (orifice < 0) {
        other_mass += lost;
        return;
      }
      orifice_mass[orifice] += lost;
      orifice_material[k] += lost;
    });
    if (scene.dilatancy && scene.dilatancy->mode == DilatancyMode::weight)
      each_way_out(stepper->vof().flux(), k, [&](int, double lost) { lost_volume += lost; });
  }
}

/// State of the accounts; the outflows are totals since the start.
SeriesRow Simulation::Impl::row(const StepReport& report) const {
  SeriesRow r;
  r.step = report;
  r.material_mass = masses_by_material(scene, fields, geometry.get(), threads);
  for (double m : r.material_mass) r.mass += m;
  tell_slow(slow_shares(fields, geometry.get(), flat_tops(scene), slow_speeds(scene), threads), r);
  r.ill_posed_fraction = ill_posed_fraction(scene, fields, geometry.get(), stepper->rheology(), threads);
  r.max_speed = fastest_grains(fields, geometry.get(), threads);
  r.orifice_outflow = orifice_mass;
  if (scene.feed) r.fed = fed_mass;
  r.material_outflow = orifice_material;
  return r;
}

Simulation::Simulation(const Scene& scene) {
  if (scene.model != Model::mu_I)
    throw std::invalid_argument(fmt::format("model {} is a steady field: there is nothing to step in time",
                                            model_names[static_cast<int>(scene.model)]));
  impl_ = std::make_unique<Impl>(scene);
  impl_->fill();
  if (scene.start_pressure == StartPressure::hydrostatic) impl_->stepper->hydrostatic(impl_->fields);
}
Simulation::~Simulation() = default;

const Scene& Simulation::scene() const { return impl_->scene; }
const Fields& Simulation::fields() const { return impl_->fields; }
Fields& Simulation::fields() { return impl_->fields; }
double Simulation::t() const { return impl_->t; }
long Simulation::steps() const { return impl_->steps; }
const std::vector<double>& Simulation::orifice_mass() const { return impl_->orifice_mass; }
std::vector<double> Simulation::material_mass() const {
  return masses_by_material(impl_->scene, impl_->fields, impl_->geometry.get(), impl_->threads);
}
double Simulation::grain_mass() const {
  double total = 0;
  for (double m : material_mass()) total += m;
  return total;
}
std::vector<std::pair<std::string, std::size_t>> Simulation::memory() const {
  const Fields& f = impl_->fields;
  std::size_t state = f.u.bytes() + f.v.bytes() + f.p.bytes() + f.grains.bytes();
  for (const CellField& t : f.tracers) state += t.bytes();
  for (const CellField& t : f.solid) state += t.bytes();
  state += f.fluidity.bytes();
  auto table = impl_->stepper->memory();
  if (impl_->geometry) table.insert(table.begin(), {"geometry", impl_->geometry->bytes()});
  if (impl_->scene.accuracy.backup_every > 0) table.insert(table.begin(), {"backup", state});
  table.insert(table.begin(), {"fields", state});
  return table;
}

StepReport Simulation::step(double t_limit) {
  Impl& s = *impl_;
  s.fit_height();
  StepReport report;
  s.stepper->fill_halo(s.fields);  // cheap, and callers may have set the velocity
  const auto start = Clock::now();
  s.threads = s.governor.next();
  s.stepper->set_threads(s.threads);
  FastestCells fastest;
  s.timers.time("time step", [&] { fastest = fastest_cells(s.fields, s.threads, s.rows); });
  if (!std::isfinite(fastest.near_grains + fastest.air)) throw std::runtime_error(not_finite(s.fields));
  const TimeStep dt = choose_time_step(s.scene, fastest, s.fields.patch().h, s.dt, t_limit - s.t, s.dt_most);
  s.stepper->advect(s.fields, dt.dt, s.steps % 2 == 0, s.timers);
  s.feed();
  s.stepper->accelerate(s.fields, dt.dt, s.timers, report);
  s.account();
  // A viscous iteration costs about two of the pressure's, and all the rest about two viscous ones.
  s.governor.record(
      4 + 2 * report.viscous.iterations + report.pressure.iterations + report.fluidity.iterations,
      seconds_since(start));
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
  const auto each_row = [&](auto&& value) {  // with the properties of the grains
    for (int j = 0; j < patch.ny; ++j) {
      GrainProperties::Rows rows(impl_->stepper->rheology().properties(), f, j);
      const GrainRows law = rows.law();
      for (int i = 0; i < patch.nx; ++i) out(i, j) = value(j, i, law.at(i));
    }
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
  } else if (const std::size_t k = tracer_number(name); k > 0 && k <= f.tracers.size()) {
    each([&](int i, int j) {
      return f.grains(i, j) > 0 ? std::min(f.tracers[k - 1](i, j) / f.grains(i, j), 1.0) : 0.0;
    });
  } else if (name == "viscosity") {
    each([&](int i, int j) { return impl_->stepper->viscosity()(i, j); });
  } else if (name == "shear_rate") {
    each(shear_rate);
  } else if (name == "inertial_number") {
    each_row([&](int j, int i, const Grain& g) {
      return f.grains(i, j) > 0.5 && f.p(i, j) > 0 ? inertial_number(shear_rate(i, j), f.p(i, j), g) : 0.0;
    });
  } else if (name == "well_posed") {
    out = well_posed_cells(impl_->scene, f, impl_->stepper->rheology());
  } else if (name == "fluidity" && f.fluidity.allocated()) {
    each([&](int i, int j) { return f.fluidity(i, j); });
  } else if (name == "fluidity_ratio" && f.fluidity.allocated()) {
    each_row([&](int j, int i, const Grain& g) {
      if (f.grains(i, j) <= 0.5 || f.p(i, j) <= 0) return 0.0;
      const double rate = shear_rate(i, j);
      const double local = rate / std::max(mu_of_I(inertial_number(rate, f.p(i, j), g), g), 1e-30);
      return f.fluidity(i, j) / std::max(local, f.p(i, j) / impl_->scene.rheology.eta_max);
    });
  } else if (name == "packing" && !f.solid.empty()) {
    const double phi_max = impl_->scene.dilatancy->phi_max;
    each([&](int i, int j) {
      return f.grains(i, j) > 0.5 ? phi_max * f.solid[0](i, j) / f.grains(i, j) : 0.0;
    });
  } else if (name == "dilation" && !f.solid.empty()) {
    each([&](int i, int j) { return ((f.u(i + 1, j) - f.u(i, j)) + (f.v(i, j + 1) - f.v(i, j))) / patch.h; });
  } else {
    throw std::invalid_argument("no field is called " + name);
  }
  if (patch == impl_->scene.patch()) return out;
  CellField whole(impl_->scene.patch(), name == "well_posed" ? 1 : 0);  // above the rows that are solved
  for (int j = 0; j < patch.ny; ++j) std::copy(out.row(j), out.row(j) + patch.nx, whole.row(j));
  return whole;
}

std::size_t tracer_number(const std::string& field) {
  constexpr std::string_view stem = "tracer_";
  const bool one = field.size() == stem.size() + 1 && field.starts_with(stem) && field.back() >= '1' &&
                   field.back() <= '9';
  return one ? static_cast<std::size_t>(field.back() - '0') : 0;
}

bool has_module(const Scene& scene, const std::string& module) {
  return (module == "nonlocal" && scene.nonlocal) || (module == "dilatancy" && scene.dilatancy) ||
         (module == "wall_friction" && scene.wall_friction);
}

bool has_field(const Scene& scene, const FieldInfo& field) {
  if (scene.model != Model::mu_I) {
    static constexpr std::array steady{"speed", "velocity_x", "velocity_y", "grains"};
    const std::string name = field.name;
    return std::ranges::find(steady, name) != steady.end() ||
           (scene.model == Model::radial && name == "pressure");
  }
  if (field.name == std::string("tracer")) return scene.materials.size() > 1;
  if (const std::size_t k = tracer_number(field.name); k > 0) return k < scene.materials.size();
  return !field.module || has_module(scene, field.module);
}

const std::vector<FieldInfo>& known_fields() {
  static const std::vector<FieldInfo> fields{
      {"speed", "L/T", "speed", true},
      {"velocity_x", "L/T", "horizontal velocity", false},
      {"velocity_y", "L/T", "vertical velocity", false},
      {"pressure", "M/T^2", "pressure", false},
      {"grains", "1", "grain fraction", false},
      {"tracer", "1", "tracer share of grains", false},
      {"tracer_1", "1", "share of the second material", false},
      {"tracer_2", "1", "share of the third material", false},
      {"tracer_3", "1", "share of the fourth material", false},
      {"tracer_4", "1", "share of the fifth material", false},
      {"viscosity", "M/T", "viscosity", true},
      {"shear_rate", "1/T", "shear rate", true},
      {"inertial_number", "1", "inertial number I", true},
      {"well_posed", "1", "well-posed (1) or not (0)", false},
      {"fluidity", "1/T", "granular fluidity", true, "nonlocal"},
      {"fluidity_ratio", "1", "fluidity over local fluidity", true, "nonlocal"},
      {"packing", "1", "packing fraction", false, "dilatancy"},
      {"dilation", "1/T", "divergence of the velocity", false, "dilatancy"},
  };
  return fields;
}

}  // namespace hourglass
