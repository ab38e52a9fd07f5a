#pragma once
// Granular fluidity of physics.nonlocal: one linear solve a step (kernels/fluidity.hpp), coefficients from the step before.
#include <memory>

#include "kernels/fluidity.hpp"
#include "kernels/geometry.hpp"
#include "solver/archive.hpp"
#include "solver/grain_properties.hpp"
#include "solver/krylov.hpp"
#include "solver/levels.hpp"

namespace hourglass {

class FluidityStage {
 public:
  virtual ~FluidityStage() = default;

  /// Coefficients of row j. in: |γ̇|^2, P, I and mu(I) along it, its properties. No two members set one row.
  virtual void set_row(const Fields& fields, int j, const double* gamma2, const double* pressure,
                       const double* I, const double* mu, GrainProperties::Rows& properties) = 0;
  /// fields.fluidity, in [P/eta_max, ...] where there are grains, else 0. Rows must be set and synced; synced on return.
  virtual SolveStats solve(Team& team, Fields& fields) = 0;
  /// Besides fields.fluidity, what the next solve takes over from the last.
  virtual void walk(Archive& archive) = 0;
  virtual std::size_t bytes() const = 0;
};

template <class T>
class Fluidity final : public FluidityStage {
 public:
  Fluidity(const Scene& scene, const Patch& patch, const Boundary& boundary,
           const Geometry* geometry = nullptr)
      : closure_(scene.nonlocal->closure), zero_at_walls_(scene.nonlocal->walls == FluidityWall::zero),
        eta_max_(scene.rheology.eta_max), tolerance_(scene.accuracy.fluidity_tolerance),
        max_iterations_(scene.accuracy.max_iterations),
        multigrid_(patch, boundary, 2 + scene.accuracy.extra_sweeps), krylov_(patch), geometry_(geometry),
        source_(patch), least_(patch) {}

  void set_row(const Fields& fields, int j, const double* gamma2, const double* pressure, const double* I,
               const double* mu, GrainProperties::Rows& properties) override {
    PoissonCoefficients<T>& a = multigrid_.finest().a;
    const int nx = source_.nx();
    double* absorption = properties.scratch(7);
    const FluidityRow row{gamma2,
                          pressure,
                          fields.grains.row(j),
                          fields.fluidity.row(j),
                          properties[GrainProperties::A_d],
                          absorption,
                          source_.row(j),
                          least_.row(j)};
    const double h = source_.patch().h;
    if (closure_ == Closure::thesis) {
      fluidity_row_thesis(row, I, mu, properties.law(), nx, h, eta_max_);
    } else {
      fluidity_row_kamrin(row, properties.law(), nx, h, eta_max_);
    }
    if (geometry_) integrate_over_open_row(j, fields.grains.row(j), absorption);
    T* __restrict out = a.absorption.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i) out[i] = static_cast<T>(absorption[i]);
  }

  SolveStats solve(Team& team, Fields& fields) override {
    HelmholtzLevel<T>& level = multigrid_.finest();
    CellField& g = fields.fluidity;
    const int nx = g.nx(), ny = g.ny();
    const bool periodic = level.boundary().periodic_x;
    const Rows rows = team.rows(ny);
    bound(fields, rows, [&](int j, int i) {  // the first guess, and where grains are new
      const double kappa = level.a.absorption(i, j);
      return !started_ && kappa > 0 ? source_(i, j) / kappa : g(i, j);
    });
    for (int j = rows.begin; j < rows.end && periodic; ++j) wrap_row(g.row(j), nx);
    const Rows faces = team.rows(ny + 1);
    for (int j = faces.begin; j < faces.end; ++j)
      fluidity_faces_row(fields.grains, level.boundary(), zero_at_walls_, j, level.a.beta);
    for (int k = 2 * faces.begin; geometry_ && k < std::min(2 * faces.end, row_count(level.a.beta)); ++k)
      open_faces_row(level, k);
    team.sync();
    if (team.leads()) started_ = true;
    level.finish(team);
    multigrid_.coarsen(team);
    const SolveStats stats = krylov_.solve(team, multigrid_, source_, g,
                                           {Measure::relative, tolerance_, max_iterations_}, &least_);
    bound(fields, rows, [&](int j, int i) { return g(i, j); });
    for (int j = rows.begin; j < rows.end && periodic; ++j) wrap_row(g.row(j), nx);
    team.sync();
    return stats;
  }

  void walk(Archive& archive) override { archive.number("fluidity_started", started_); }

  std::size_t bytes() const override {
    return multigrid_.bytes() + krylov_.bytes() + source_.bytes() + least_.bytes();
  }

 private:
  /// The equation of row j over what is open of cells; solids hold g = 0 half of a cell's open depth away.
  void integrate_over_open_row(int j, const double* grains, double* __restrict absorption) {
    const double *open = geometry_->volume.row(j), *wall = geometry_->wall_area.row(j);
    double* __restrict source = source_.row(j);
    for (int i = 0; i < source_.nx(); ++i) {
      const double depth = open[i] / std::max(wall[i], 1e-300);
      source[i] *= open[i];
      absorption[i] *= open[i];
      if (zero_at_walls_ && wall[i] > 0 && grains[i] > least_grains)
        absorption[i] += grains[i] * wall[i] / std::max(0.5 * depth, 0.05);
    }
  }
  void open_faces_row(HelmholtzLevel<T>& level, int k) {
    const auto beta = row_of(level.a.beta, k);
    const double* open = row_of(geometry_->aperture, k).data;
    const int j = k / 2, ny = source_.ny();
    const bool is_u = k % 2 == 0 && j < ny;
    for (int i = 0; i < beta.n; ++i) {
      const bool side =
          is_u ? !level.boundary().periodic_x && (i == 0 || i + 1 == beta.n) : j == 0 || j == ny;
      // At a side beta is that of its wall, beside what is open of the cell there.
      const double beside = geometry_->volume(std::min(i, source_.nx() - 1), std::min(j, ny - 1));
      beta.data[i] *= static_cast<T>(side ? beside : open[i]);
    }
  }

  /// g = max(value, least) where there are grains, else 0.
  template <class Value>
  void bound(Fields& fields, Rows rows, Value value) {
    CellField& g = fields.fluidity;
    for (int j = rows.begin; j < rows.end; ++j) {
      double* __restrict out = g.row(j);
      const double *c = fields.grains.row(j), *least = least_.row(j);
#pragma omp simd
      for (int i = 0; i < g.nx(); ++i)
        out[i] = static_cast<double>(c[i] > least_grains) * std::max(value(j, i), least[i]);
    }
  }

  Closure closure_;
  bool zero_at_walls_, started_ = false;
  double eta_max_, tolerance_;
  int max_iterations_;
  Multigrid<HelmholtzLevel<T>> multigrid_;
  Krylov<HelmholtzLevel<T>> krylov_;
  const Geometry* geometry_;
  CellField source_;  ///< kappa g_local [1/T]
  CellField least_;   ///< P/eta_max [1/T]
};

/// nullptr if the scene names no nonlocal fluidity.
template <class T>
std::unique_ptr<FluidityStage> make_fluidity(const Scene& scene, const Patch& patch, const Boundary& boundary,
                                             const Geometry* geometry = nullptr) {
  return scene.nonlocal ? std::make_unique<Fluidity<T>>(scene, patch, boundary, geometry) : nullptr;
}

}  // namespace hourglass
