// One step of the incompressible two-phase equations, time levels n -> n+1 (docs/theory.md):
//
//   c^{n+1}: ∂t c + ∇·(c u^n) = 0                           geometric VOF; its fluxes carry mass, momentum and tracers
//   η = c η_grains(|γ̇(u^n)|, p^n) + (1 - c) η_air           at c^{n+1}
//   u*  = u^n - Δt u^n·∇u^n + Δt (g - β ∇p^n)                β = 1/ρ^{n+1}
//   ρ u** - Δt ∇·(2 η D(u**)) = ρ u*                         implicit, u and v coupled
//   u^{n+1} = u** - Δt β ∇δp,  ∇·u^{n+1} = 0,  p^{n+1} = p^n + δp
//
// Modules that the scene names add to it (docs/physics.md): fluidity, eta = P/g; dilatancy, ∇·u = S and a mass of its own;
// wall friction, a drag in the viscous solve. accuracy.splitting repeats the last lines.
#include "solver/step.hpp"

#include "kernels/momentum.hpp"
#include "solver/dilatancy.hpp"
#include "solver/fluidity.hpp"
#include "solver/free_surface.hpp"
#include "solver/projection.hpp"
#include "solver/viscous_solve.hpp"

namespace hourglass {
namespace {

template <class T>
class StepperOf final : public Stepper {
 public:
  StepperOf(const Scene& scene, const Boundary& boundary, const Geometry* geometry, int threads)
      : scene_(scene), boundary_(boundary), geometry_(geometry), threads_(threads), patch_(scene.patch()),
        vof_(patch_, static_cast<int>(scene.materials.size()), boundary.ends(), geometry, scene.accuracy.vof),
        rheology_(scene, patch_, boundary, geometry),
        fluidity_(make_fluidity<T>(scene, patch_, boundary, geometry)), mass_(patch_), eta_(patch_),
        star_(patch_),
        surface_(scene.air.model == AirModel::none
                     ? std::make_unique<FreeSurface>(patch_, boundary, geometry, scene.air.density)
                     : nullptr),
        viscous_(patch_, boundary, geometry, surface_.get(), scene.accuracy.extra_sweeps),
        projection_(patch_, boundary, scene.dilatancy && scene.dilatancy->mode != DilatancyMode::weight,
                    geometry, surface_.get(), scene.accuracy.extra_sweeps) {
    for (const Material& m : scene.materials) excess_.push_back(m.density - scene.materials[0].density);
    if (scene.dilatancy) {
      dilatancy_ = std::make_unique<DilatancyStage>(scene, patch_, boundary.ends(), geometry);
      if (dilatancy_->divergence()) trace_ = CellField(patch_);
    }
    const Splitting& splitting = scene.accuracy.splitting;
    if (splitting.outer > 1 || splitting.picard > 1) advected_ = Velocity(patch_);
  }

  void set_threads(int threads) override { threads_ = threads; }

  void advect(Fields& fields, double dt, bool x_first, Timers& timers) override {
    for (int j = 0; boundary_.periodic_x && j < patch_.ny; ++j) wrap_row(fields.p.row(j), patch_.nx);
    if (with_modules && dilatancy_) timers.time("dilatancy", [&] { dilatancy_->remember(fields, threads_); });
    timers.time("vof", [&] { vof_.advect(fields, dt, x_first, threads_); });
    if (with_modules && dilatancy_)
      timers.time("dilatancy", [&] { dilatancy_->transport(fields, vof_, threads_); });
  }

  void accelerate(Fields& fields, double dt, Timers& timers, StepReport& report) override {
    timers.time("mass", [&] { transport_mass(fields, dt); });
    const Splitting& splitting = scene_.accuracy.splitting;
    for (int outer = 0; outer < splitting.outer; ++outer) {
      for (int picard = 0; picard < splitting.picard; ++picard) {
        const bool first = outer + picard == 0;
        if (!first) fill_halo(fields);
        timers.time(with_modules && fluidity_ ? "rheology and fluidity" : "rheology",
                    [&] { update_viscosity(fields, first, report); });
        timers.time("momentum", [&] {
          if (first) {
            predict_momentum(fields, dt);
          } else {
            predict_again(fields, dt);
          }
        });
        timers.time("viscous", [&] { add(solve_viscous(fields, dt), first, report.viscous); });
      }
      timers.time("projection", [&] { add(project_velocity(fields, dt), outer == 0, report.pressure); });
    }
    report.max_divergence = report.pressure.final;
  }

  void fill_halo(Fields& fields) const override {
    if (surface_) surface_->extrapolate(fields);
    if (geometry_) fill_solid(*geometry_, fields);
    fill_velocity_halo(boundary_, fields.u, fields.v);
  }

  void forget() override { projection_.forget(); }

  void walk(Archive& archive) override {
    projection_.walk(archive);
    archive.field("viscosity", eta_);
    rheology_.walk(archive);
    if (fluidity_) fluidity_->walk(archive);
    if (with_modules && dilatancy_) dilatancy_->walk(archive);
  }

  void hydrostatic(Fields& fields) override {
    transport_mass(fields, 0);
    parallel(threads_, [&](Team& team) {
      // ∇·(β ∇p) = ∇·g is the projection of g Δt from p = 0; Δt = 1 keeps the units.
      projection_.assemble(team, mass_.density);
      if (team.leads()) star_.fill(0);
      team.sync();
      projection_.add_gravity_and_pressure(team, fields.p, scene_.gravity, 1, star_);
      projection_.solve(team, 1, 1e-13, scene_.accuracy.max_iterations, star_, fields.p);
    });
    projection_.forget();
  }

  SolveStats project(Fields& fields, double dt) override {
    transport_mass(fields, 0);
    SolveStats stats;
    parallel(threads_, [&](Team& team) {
      projection_.assemble(team, mass_.density);
      projection_.add_gravity_and_pressure(team, fields.p, {0, 0}, 0, fields);  // zeroes walls
      const SolveStats s = projection_.solve(team, dt, scene_.accuracy.pressure_tolerance,
                                             scene_.accuracy.max_iterations, fields, fields.p);
      if (team.leads()) stats = s;
    });
    projection_.forget();
    fill_halo(fields);
    return stats;
  }

  const Vof& vof() const override { return vof_; }
  PhaseFlux mass_flux() const override {
    return with_modules && dilatancy_ ? dilatancy_->flux() : vof_.flux();
  }
  const RheologyStage& rheology() const override { return rheology_; }
  const CellField& viscosity() const override { return eta_; }
  std::vector<std::pair<std::string, std::size_t>> memory() const override {
    std::vector<std::pair<std::string, std::size_t>> table{{"volume of fluid", vof_.bytes()},
                                                           {"mass transport", mass_.bytes()},
                                                           {"rheology", rheology_.bytes() + eta_.bytes()},
                                                           {"momentum", star_.bytes()},
                                                           {"viscous solve", viscous_.bytes()},
                                                           {"projection", projection_.bytes()}};
    if (surface_) table.emplace_back("free surface", surface_->bytes());
    if (fluidity_) table.emplace_back("fluidity", fluidity_->bytes());
    if (with_modules && dilatancy_) table.emplace_back("dilatancy", dilatancy_->bytes() + trace_.bytes());
    if (advected_.bytes() > 0) table.emplace_back("splitting", advected_.bytes());
    return table;
  }

 private:
  /// Density at n+1 and the mass that VOF carried through each face.
  void transport_mass(const Fields& fields, double dt) {
    const int nx = patch_.nx, ny = patch_.ny;
    const double air = scene_.air.density, dt_h = dt / patch_.h;
    const int tracers = static_cast<int>(fields.tracers.size());
    const double grains = scene_.materials[0].density - air;
    // rho = air + grains c + Σ excess_k f_k, and so for the fluxes; with dilatancy air (1 - c) + rho_0 s + Σ excess_k s_k,
    // s the volumes at phi_max.
    const PhaseFlux flux = mass_flux(), volume_flux = vof_.flux();
    const Velocity& carrier = vof_.carrier(fields);
    const bool dilatant = with_modules && dilatancy_;
    const double solid = scene_.materials[0].density;
    parallel(threads_, [&](Team& team) {
      const Rows rows = team.rows(ny + 1);
      const auto mix = [&](int n, double* out, const double* volume, double scale, const double* c,
                           auto phase_row) {
        if (dilatant) {
          const double* s = phase_row(0);
          for (int i = 0; i < n; ++i)
            out[i] = air * ((volume ? volume[i] * scale : 1.0) - c[i]) + solid * s[i];
        } else {
#pragma omp simd
          for (int i = 0; i < n; ++i) out[i] = air * (volume ? volume[i] * scale : 1.0) + grains * c[i];
        }
        for (int k = 0; k < tracers; ++k)
          if (excess_[k + 1] != 0) {
            const double* f = phase_row(k + 1);
            for (int i = 0; i < n; ++i) out[i] += excess_[k + 1] * f[i];
          }
      };
      for (int j = rows.begin; j < rows.end; ++j) {
        if (j < ny) {
          mix(nx, mass_.density.row(j), nullptr, 1, fields.grains.row(j),
              [&](int k) { return dilatant ? fields.solid[k].row(j) : fields.tracers[k - 1].row(j); });
          if (dilatant) keep_positive(fields, j);
          if (dt > 0)
            mix(nx + 1, mass_.x.row(j), carrier.u.row(j), dt_h, volume_flux.x[0].row(j),
                [&](int k) { return flux.x[k].row(j); });
          if (boundary_.periodic_x) wrap_row(mass_.x.row(j), nx);
          if (boundary_.mirror_left) mass_.x(-1, j) = -mass_.x(1, j);
        }
        if (dt > 0)
          mix(nx, mass_.y.row(j), carrier.v.row(j), dt_h, volume_flux.y[0].row(j),
              [&](int k) { return flux.y[k].row(j); });
        fill_ends(boundary_.ends(), mass_.y.row(j), nx);
      }
      team.sync();
      if (team.leads()) fill_cell_halo(boundary_, mass_.density);
      team.sync();
      if (surface_) surface_->update(team, fields.grains, mass_.density);
      const Rows cells = team.rows(ny);
      for (int j = cells.begin; j < cells.end; ++j) {
        uniform_density_row(mass_.density, j, mass_.uniform.row(j));
        fill_ends(boundary_.ends(), mass_.uniform.row(j), nx);
      }
    });
  }

  /// What rounding at the surface took from the solid of a cell must not make its density less than that of air.
  void keep_positive(const Fields& fields, int j) {
    const double thin =
        0.5 * scene_.dilatancy->phi_min / scene_.dilatancy->phi_max * scene_.materials[0].density;
    const double* c = fields.grains.row(j);
    double* density = mass_.density.row(j);
    for (int i = 0; i < patch_.nx; ++i)
      density[i] = std::max(density[i], scene_.air.density * (1 - c[i]) + thin * c[i]);
  }

  /// eta, S and, where the trace of D is not 0, what it adds to the pressure of a deviatoric stress.
  void update_viscosity(Fields& fields, bool first, StepReport& report) {
    const RheologyStage::Result result =
        rheology_.update(fields, threads_, eta_, {fluidity_.get(), dilatancy_.get()});
    report.capped_cells = result.limits.capped;
    report.floored_cells = result.limits.floored;
    add(result.fluidity, first, report.fluidity);
    if (!with_modules || !trace_.allocated()) return;
    parallel(threads_, [&](Team& team) {
      const Rows rows = team.rows(patch_.ny);
      for (int j = rows.begin; j < rows.end; ++j) {
        const double *eta = eta_.row(j), *S = dilatancy_->divergence()->row(j);
        double* __restrict out = trace_.row(j);
#pragma omp simd
        for (int i = 0; i < patch_.nx; ++i) out[i] = eta[i] * S[i];
        if (boundary_.periodic_x) wrap_row(out, patch_.nx);
      }
    });
  }

  /// Statistics of several solves in a step: iterations add up, the last one's error stays.
  static void add(const SolveStats& now, bool first, SolveStats& all) {
    const int before = first ? 0 : all.iterations;
    const bool converged = first || all.converged;
    all = now;
    all.iterations += before;
    all.converged = all.converged && converged;
  }

  /// star_ = u* once more, with the present pressure.
  void predict_again(const Fields& fields, double dt) {
    parallel(threads_, [&](Team& team) {
      if (with_modules && dilatancy_) projection_.assemble(team, mass_.density, dilatancy_->compliance(), dt);
      copy(team, advected_, star_);
      add_forces(team, fields, dt);
    });
  }
  void copy(Team& team, const Velocity& from, Velocity& to) {
    const Rows rows = team.rows(row_count(to));
    for (int k = rows.begin; k < rows.end; ++k) {
      const auto row = row_of(from, k);
      std::copy(row.data, row.data + row.n, row_of(to, k).data);
    }
    team.sync();
  }
  /// What the predictor's own loop leaves out, or all forces where it left them out.
  void add_forces(Team& team, const Fields& fields, double dt) {
    if (advected_.bytes() > 0)
      projection_.add_gravity_and_pressure(team, fields.p, scene_.gravity, dt, star_);
    if (with_modules && trace_.allocated())
      projection_.add_gravity_and_pressure(team, trace_, {0, 0}, dt, star_);
  }

  /// The silo thesis's wall friction: u^n, relative to the walls, less F P Δt/ρ, not below rest. star_ += that change. On
  /// the half control volume of a boundary face force and mass are those of its one cell.
  void limit_by_walls(Team& team, const Fields& fields, double dt) {
    const CellField& force = rheology_.wall_force();
    const auto [u_wall, v_wall] = scene_.wall_friction->wall_velocity;
    const auto change = [&](double own, double across, double push, double rho) {
      const double speed = std::hypot(own, across);
      return speed > 0 ? -own * std::min(1.0, push * dt / (rho * speed)) : 0.0;
    };
    const int nx = patch_.nx, ny = patch_.ny;
    const bool periodic = boundary_.periodic_x;
    const Rows rows = team.rows(ny + 1);
    for (int j = rows.begin; j < rows.end; ++j) {
      const double *f = force.row(std::min(j, ny - 1)), *rho = mass_.density.row(j);
      const double *us = fields.u.row(j - 1), *u = fields.u.row(j), *v = fields.v.row(j);
      for (int i = 0; i <= nx && j < ny; ++i) {
        const double* vn = fields.v.row(j + 1);
        const double push = 0.5 * (f[i > 0 || periodic ? i - 1 : 0] + f[i < nx || periodic ? i : nx - 1]);
        const double across = 0.25 * ((v[i - 1] + v[i]) + (vn[i - 1] + vn[i])) - v_wall;
        star_.u(i, j) += change(u[i] - u_wall, across, push, 0.5 * (rho[i - 1] + rho[i]));
      }
      const double* below = mass_.density.row(j - 1);
      for (int i = 0; i < nx; ++i) {
        const double push = 0.5 * (force(i, std::max(j - 1, 0)) + force(i, std::min(j, ny - 1)));
        const double across = 0.25 * ((us[i] + us[i + 1]) + (u[i] + u[i + 1])) - u_wall;
        star_.v(i, j) += change(v[i] - v_wall, across, push, 0.5 * (below[i] + rho[i]));
      }
    }
    team.sync();
  }

  static void multiply(int n, const double* __restrict factor, double* __restrict out) {
#pragma omp simd
    for (int i = 0; i < n; ++i) out[i] *= factor[i];
  }

  /// star_ = u*.
  void predict_momentum(const Fields& fields, double dt) {
    const bool apart = advected_.bytes() > 0;  // forces are added to what is kept
    parallel(threads_, [&](Team& team) {
      projection_.assemble(team, mass_.density,
                           with_modules && dilatancy_ ? dilatancy_->compliance() : nullptr, dt);
      const int nx = patch_.nx, ny = patch_.ny;
      const double dt_h = dt / patch_.h;
      constexpr auto size = &MomentumAdvection<At::xface>::scratch_size;
      double* scratch = row_scratch<double>(2 * size(nx + 1));
      const Rows rows = team.rows(ny + 1);
      MomentumAdvection<At::xface> of_u(fields.u, fields.v, mass_, dt_h, rows.begin, scratch);
      MomentumAdvection<At::yface> of_v(fields.u, fields.v, mass_, dt_h, rows.begin, scratch + size(nx + 1));
      for (int j = rows.begin; j < rows.end; ++j) {
        const double *below = mass_.density.row(j - 1), *above = mass_.density.row(j);
        if (j < ny) {
          const double* old = fields.u.row(j);
          double* __restrict out = star_.u.row(j);
          of_u.next(out);
          if (geometry_) multiply(nx + 1, geometry_->inverse_inertia.u.row(j), out);
          const double left = old[0] - 2 * out[0] / above[0];  // half a control volume
          const double right = old[nx] - 2 * out[nx] / above[nx - 1];
#pragma omp simd
          for (int i = 0; i <= nx; ++i) out[i] = old[i] - 2 * out[i] / (above[i - 1] + above[i]);
          if (!boundary_.periodic_x) {
            out[0] = left;
            out[nx] = right;
          }
          if (!apart) projection_.add_gravity_and_pressure_row(fields.p, scene_.gravity, dt, star_, 2 * j);
        }
        const double* old = fields.v.row(j);
        const double share = j == 0 || j == ny ? 0.5 : 1.0;
        double* __restrict out = star_.v.row(j);
        of_v.next(out);
        if (geometry_) multiply(nx, geometry_->inverse_inertia.v.row(j), out);
#pragma omp simd
        for (int i = 0; i < nx; ++i) out[i] = old[i] - 2 * out[i] / (share * (below[i] + above[i]));
        if (!apart)
          projection_.add_gravity_and_pressure_row(fields.p, scene_.gravity, dt, star_,
                                                   j < ny ? 2 * j + 1 : 2 * j);
      }
      if (!apart && !trace_.allocated() && !limiter()) return;
      team.sync();
      if (limiter()) limit_by_walls(team, fields, dt);
      if (apart) copy(team, star_, advected_);
      add_forces(team, fields, dt);
    });
  }
  bool limiter() const {
    return with_modules && scene_.wall_friction && scene_.wall_friction->mode == FrictionMode::limiter;
  }

  /// fields: u^n, the first guess, becomes u**.
  SolveStats solve_viscous(Fields& fields, double dt) {
    SolveStats stats;
    parallel(threads_, [&](Team& team) {
      WallDrag drag;
      if (with_modules && scene_.wall_friction && !limiter())
        drag = {&rheology_.wall_force(), scene_.wall_friction->wall_velocity,
                scene_.wall_friction->speed_floor};
      viscous_.assemble(team, eta_, scene_.rheology.corner_mean == CornerMean::harmonic, mass_.density, dt,
                        drag, fields, star_);
      clear_halo(team, fields);
      const SolveStats s = viscous_.solve(team, star_, fields, scene_.accuracy.viscous_tolerance,
                                          scene_.g() * dt, scene_.accuracy.max_iterations);
      if (team.leads()) stats = s;
    });
    return stats;
  }

  SolveStats project_velocity(Fields& fields, double dt) {
    SolveStats stats;
    if (scene_.accuracy.splitting.outer > 1) projection_.forget();  // rounds correct different things
    parallel(threads_, [&](Team& team) {
      const ProjectionModules modules{with_modules && dilatancy_ ? dilatancy_->divergence() : nullptr, &eta_,
                                      scene_.accuracy.splitting.rotational,
                                      scene_.materials[0].density * patch_.h * scene_.g()};
      const SolveStats s = projection_.solve(team, dt, scene_.accuracy.pressure_tolerance,
                                             scene_.accuracy.max_iterations, fields, fields.p, modules);
      if (team.leads()) stats = s;
    });
    fill_halo(fields);
    return stats;
  }

  const Scene& scene_;
  const Boundary& boundary_;
  const Geometry* geometry_;  // nullptr: whole cells
  int threads_;
  const Patch patch_;
  Vof vof_;
  RheologyStage rheology_;
  std::unique_ptr<FluidityStage> fluidity_;  // nullptr: not in the scene; and so below
  std::unique_ptr<DilatancyStage> dilatancy_;
  MassTransport mass_;
  std::vector<double> excess_;  // density of each material over that of material 0
  CellField eta_;
  Velocity star_;
  Velocity advected_;  // u* without its forces, where a step repeats what follows; else not allocated
  CellField trace_;    // eta S [M/T^2], with dilatancy
  std::unique_ptr<FreeSurface> surface_;  // air: {model: none}
  ViscousSolve<T> viscous_;
  Projection<T> projection_;
};

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Scene& scene, const Boundary& boundary, const Geometry* geometry,
                                      int threads) {
  if (scene.accuracy.precision == Precision::full)
    return std::make_unique<StepperOf<double>>(scene, boundary, geometry, threads);
  return std::make_unique<StepperOf<float>>(scene, boundary, geometry, threads);
}

}  // namespace hourglass
