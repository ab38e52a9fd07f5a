// One step of the incompressible two-phase equations, time levels n -> n+1 (docs/theory.md):
//
//   c^{n+1}: ∂t c + ∇·(c u^n) = 0                           geometric VOF; its fluxes carry mass, momentum and tracers
//   η = c η_grains(|γ̇(u^n)|, p^n) + (1 - c) η_air           at c^{n+1}
//   u*  = u^n - Δt u^n·∇u^n + Δt (g - β ∇p^n)                β = 1/ρ^{n+1}
//   ρ u** - Δt ∇·(2 η D(u**)) = ρ u*                         implicit, u and v coupled
//   u^{n+1} = u** - Δt β ∇δp,  ∇·u^{n+1} = 0,  p^{n+1} = p^n + δp
#include "solver/step.hpp"

#include "kernels/momentum.hpp"
#include "solver/projection.hpp"
#include "solver/viscous_solve.hpp"

namespace hourglass {
namespace {

template <class T>
class StepperOf final : public Stepper {
 public:
  StepperOf(const Scene& scene, const Boundary& boundary, int threads)
      : scene_(scene), boundary_(boundary), threads_(threads), patch_(scene.patch()),
        vof_(patch_, static_cast<int>(scene.materials.size()), {boundary.periodic_x}),
        rheology_(scene, patch_, boundary), mass_(patch_), eta_(patch_), star_(patch_),
        viscous_(patch_, boundary), projection_(patch_, boundary) {
    for (const Material& m : scene.materials) excess_.push_back(m.density - scene.materials[0].density);
  }

  void set_threads(int threads) override { threads_ = threads; }

  void step(Fields& fields, double dt, bool x_first, Timers& timers, StepReport& report) override {
    for (int j = 0; boundary_.periodic_x && j < patch_.ny; ++j) wrap_row(fields.p.row(j), patch_.nx);
    timers.time("vof", [&] { vof_.advect(fields, dt, x_first, threads_); });
    timers.time("mass", [&] { transport_mass(fields, dt); });
    timers.time("rheology", [&] {
      const LimitCounts counts = rheology_.update(fields, threads_, eta_);
      report.capped_cells = counts.capped;
      report.floored_cells = counts.floored;
    });
    timers.time("momentum", [&] { predict_momentum(fields, dt); });
    timers.time("viscous", [&] { report.viscous = solve_viscous(fields, dt); });
    timers.time("projection", [&] { report.pressure = project_velocity(fields, dt); });
    report.max_divergence = report.pressure.final;
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
    fill_velocity_halo(boundary_, fields.u, fields.v);
    return stats;
  }

  const Vof& vof() const override { return vof_; }
  const RheologyStage& rheology() const override { return rheology_; }
  const CellField& viscosity() const override { return eta_; }
  std::vector<std::pair<std::string, std::size_t>> memory() const override {
    return {{"volume of fluid", vof_.bytes()},
            {"mass transport", mass_.bytes()},
            {"rheology", rheology_.bytes() + eta_.bytes()},
            {"momentum", star_.bytes()},
            {"viscous solve", viscous_.bytes()},
            {"projection", projection_.bytes()}};
  }

 private:
  /// Density at n+1 and the mass that VOF carried through each face.
  void transport_mass(const Fields& fields, double dt) {
    const int nx = patch_.nx, ny = patch_.ny;
    const double air = scene_.air.density, dt_h = dt / patch_.h;
    const int tracers = static_cast<int>(fields.tracers.size());
    const double grains = scene_.materials[0].density - air;
    // rho = air + grains c + Σ excess_k f_k, and so for the fluxes.
    parallel(threads_, [&](Team& team) {
      const Rows rows = team.rows(ny + 1);
      const auto mix = [&](int n, double* out, const double* volume, double scale, const double* c,
                           auto tracer_row) {
#pragma omp simd
        for (int i = 0; i < n; ++i) out[i] = air * (volume ? volume[i] * scale : 1.0) + grains * c[i];
        for (int k = 0; k < tracers; ++k)
          if (excess_[k + 1] != 0) {
            const double* f = tracer_row(k);
            for (int i = 0; i < n; ++i) out[i] += excess_[k + 1] * f[i];
          }
      };
      for (int j = rows.begin; j < rows.end; ++j) {
        if (j < ny) {
          mix(nx, mass_.density.row(j), nullptr, 1, fields.grains.row(j),
              [&](int k) { return fields.tracers[k].row(j); });
          if (dt > 0)
            mix(nx + 1, mass_.x.row(j), fields.u.row(j), dt_h, vof_.flux_x(0).row(j),
                [&](int k) { return vof_.flux_x(k + 1).row(j); });
          if (boundary_.periodic_x) wrap_row(mass_.x.row(j), nx);
        }
        if (dt > 0)
          mix(nx, mass_.y.row(j), fields.v.row(j), dt_h, vof_.flux_y(0).row(j),
              [&](int k) { return vof_.flux_y(k + 1).row(j); });
        if (boundary_.periodic_x) wrap_row(mass_.y.row(j), nx);
      }
      team.sync();
      if (team.leads()) fill_cell_halo(boundary_, mass_.density);
      team.sync();
      const Rows cells = team.rows(ny);
      for (int j = cells.begin; j < cells.end; ++j) {
        uniform_density_row(mass_.density, j, mass_.uniform.row(j));
        if (boundary_.periodic_x) wrap_row(mass_.uniform.row(j), nx);
      }
    });
  }

  /// star_ = u*.
  void predict_momentum(const Fields& fields, double dt) {
    parallel(threads_, [&](Team& team) {
      projection_.assemble(team, mass_.density);
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
          const double left = old[0] - 2 * out[0] / above[0];  // half a control volume
          const double right = old[nx] - 2 * out[nx] / above[nx - 1];
#pragma omp simd
          for (int i = 0; i <= nx; ++i) out[i] = old[i] - 2 * out[i] / (above[i - 1] + above[i]);
          if (!boundary_.periodic_x) {
            out[0] = left;
            out[nx] = right;
          }
          projection_.add_gravity_and_pressure_row(fields.p, scene_.gravity, dt, star_, 2 * j);
        }
        const double* old = fields.v.row(j);
        const double share = j == 0 || j == ny ? 0.5 : 1.0;
        double* __restrict out = star_.v.row(j);
        of_v.next(out);
#pragma omp simd
        for (int i = 0; i < nx; ++i) out[i] = old[i] - 2 * out[i] / (share * (below[i] + above[i]));
        projection_.add_gravity_and_pressure_row(fields.p, scene_.gravity, dt, star_,
                                                 j < ny ? 2 * j + 1 : 2 * j);
      }
    });
  }

  /// fields: u^n, the first guess, becomes u**.
  SolveStats solve_viscous(Fields& fields, double dt) {
    SolveStats stats;
    const double g = std::hypot(scene_.gravity[0], scene_.gravity[1]);
    parallel(threads_, [&](Team& team) {
      viscous_.assemble(team, eta_, scene_.rheology.corner_mean == CornerMean::harmonic, mass_.density, dt);
      clear_halo(team, fields);
      const SolveStats s = viscous_.solve(team, star_, fields, scene_.accuracy.viscous_tolerance, g * dt,
                                          scene_.accuracy.max_iterations);
      if (team.leads()) stats = s;
    });
    return stats;
  }

  SolveStats project_velocity(Fields& fields, double dt) {
    SolveStats stats;
    parallel(threads_, [&](Team& team) {
      const SolveStats s = projection_.solve(team, dt, scene_.accuracy.pressure_tolerance,
                                             scene_.accuracy.max_iterations, fields, fields.p);
      if (team.leads()) stats = s;
    });
    fill_velocity_halo(boundary_, fields.u, fields.v);
    return stats;
  }

  const Scene& scene_;
  const Boundary& boundary_;
  int threads_;
  const Patch patch_;
  Vof vof_;
  RheologyStage rheology_;
  MassTransport mass_;
  std::vector<double> excess_;  // density of each material over that of material 0
  CellField eta_;
  Velocity star_;
  ViscousSolve<T> viscous_;
  Projection<T> projection_;
};

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Scene& scene, const Boundary& boundary, int threads) {
  if (scene.accuracy.precision == Precision::full)
    return std::make_unique<StepperOf<double>>(scene, boundary, threads);
  return std::make_unique<StepperOf<float>>(scene, boundary, threads);
}

}  // namespace hourglass
