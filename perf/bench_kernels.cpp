// Each hot kernel against its plain twin and the triad, on 1 and 2 threads. Bytes a cell are those of the
// kernels' contracts: what a pass over a patch larger than any cache reads and writes. `--roofline=FILE.png`
// draws the result.
#include <fmt/format.h>
#include <unistd.h>

#include <memory>

#include "perf/harness.hpp"
#include "perf/plain.hpp"
#include "perf/roofline.hpp"
#include "perf/stream.hpp"
#include "solver/levels.hpp"
#include "tests/support/boundaries.hpp"
#include "tests/support/make_operator.hpp"

using namespace hourglass;
using perf::Case;

namespace {

Patch square(int n) { return {n, n, 1.0 / n, 0, 0}; }
Boundary silo_boundary(int n) { return all_kinds_of_boundaries(n, n)[2].boundary; }

/// A level with random coefficients and right-hand side, the next coarser one, and a copy of the unknown for
/// the twin.
template <class Level>
struct Levels {
  Level fine, coarse;
  decltype(Level::x) start, twin, coarse_twin;

  explicit Levels(int n)
      : fine(square(n), silo_boundary(n), true),
        coarse(square(n).coarser(), silo_boundary(n).coarser(), false) {
    Noise noise;
    if constexpr (std::is_same_v<Level, ViscousLevel<float>>) {
      fine.a = random_viscous<float>(square(n), fine.boundary(), noise, 1e3);
    } else {
      fine.a = random_poisson<float>(square(n), fine.boundary(), noise, 1e3);
    }
    Team alone;
    coarse.coarsen(alone, fine);
    for (auto* f : {&fine.b, &fine.x, &fine.r}) fill_random(*f, noise);
    for (auto* f : {&fine.b, &fine.x, &fine.r})
      for (int k = 0; k < row_count(*f); ++k) fine.mask(*f, k);
    fill_random(coarse.x, noise);
    for (int k = 0; k < row_count(coarse.x); ++k) coarse.mask(coarse.x, k);
    start = twin = fine.x;
    coarse_twin = coarse.b;
  }
};

/// Runs both twins of a case from the same state.
template <class Reset, class Compare>
std::function<double()> both(const Case& c, Reset reset, Compare compare) {
  return [fast = c.fast, plain = c.plain, reset, compare] {
    reset();
    Team alone;
    fast(alone);
    plain();
    return compare();
  };
}
constexpr double float_rounding = 2e-5,
                 double_rounding = 1e-12;  // of some tens of operations, at contrast 1e3

template <class Level>
Case relax(int n) {
  constexpr bool viscous = std::is_same_v<Level, ViscousLevel<float>>;
  const auto s = std::make_shared<Levels<Level>>(n);
  Case c{viscous ? 128.0 : 48.0,
         viscous ? 40.0 : 20.0,
         [s](Team& team) { s->fine.relax(team, s->fine.x, s->fine.b, false); },
         [s] { plain::relax(s->fine.a, s->twin, s->fine.b, false); },
         {},
         float_rounding};
  c.difference = both(
      c, [s] { s->fine.x = s->twin = s->start; },
      [s] { return perf::relative_difference(s->fine.x, s->twin); });
  return c;
}

template <class Level>
Case residual(int n) {
  constexpr bool viscous = std::is_same_v<Level, ViscousLevel<float>>;
  const auto s = std::make_shared<Levels<Level>>(n);
  Case c{viscous ? 48.0 : 20.0,
         viscous ? 48.0 : 20.0,
         [s](Team& team) { s->fine.residual(team, s->fine.x, s->fine.b, s->fine.r); },
         [s] { plain::residual(s->fine.a, s->fine.x, s->fine.b, s->twin); },
         {},
         float_rounding};
  c.difference = both(
      c, [] {}, [s] { return perf::relative_difference(s->fine.r, s->twin); });
  return c;
}

template <class Level>
Case restriction(int n) {
  constexpr bool viscous = std::is_same_v<Level, ViscousLevel<float>>;
  const auto s = std::make_shared<Levels<Level>>(n);
  const double bytes = viscous ? 10 : 5;
  Case c{bytes, bytes, [s](Team& team) { s->coarse.restrict_from(team, s->fine.r); }, {}, {}, float_rounding};
  if constexpr (viscous) {
    c.plain = [s] { plain::restrict(s->fine.r, s->coarse.boundary(), s->coarse_twin); };
  } else {
    c.plain = [s] { plain::restrict(s->fine.r, s->coarse_twin); };
  }
  c.difference = both(
      c, [] {}, [s] { return perf::relative_difference(s->coarse.b, s->coarse_twin); });
  return c;
}

template <class Level>
Case prolongation(int n) {
  constexpr bool viscous = std::is_same_v<Level, ViscousLevel<float>>;
  const auto s = std::make_shared<Levels<Level>>(n);
  Case c{viscous ? 26.0 : 12.0,
         viscous ? 18.0 : 8.0,
         [s](Team& team) { s->coarse.prolong_to(team, s->fine); },
         {},
         {},
         float_rounding};
  if constexpr (viscous) {
    c.plain = [s] { plain::prolong(s->coarse.x, s->coarse.boundary(), s->fine.a.inverse_diagonal, s->twin); };
  } else {
    c.plain = [s] { plain::prolong(s->coarse.a, s->coarse.x, s->twin); };
  }
  c.difference = both(
      c, [s] { s->fine.x = s->twin = s->start; },
      [s] { return perf::relative_difference(s->fine.x, s->twin); });
  return c;
}

/// Grains below a wavy surface in a solenoidal flow at Courant numbers up to 1/4, and what the explicit
/// stages need.
struct Flow {
  Boundary boundary;
  Velocity w, advected, advected_twin;
  MassTransport mass;
  CellField grains, start, twin, gamma2, p, eta, eta_twin, spare;
  CellFieldOf<float> eta_c;
  CornerFieldOf<float> eta_n, eta_n_twin;
  XFaceField flux_x;
  YFaceField flux_y;
  DilationOwner owner;
  RowSums excess;
  double dt_h = 0.25, twin_dt_h = 0.25;

  explicit Flow(int n)
      : boundary(silo_boundary(n)), w(square(n)), advected(square(n)), advected_twin(square(n)),
        mass(square(n)), grains(square(n)), gamma2(square(n)), p(square(n)), eta(square(n)),
        eta_twin(square(n)), spare(square(n)), eta_c(square(n)), eta_n(square(n)), eta_n_twin(square(n)),
        flux_x(square(n)), flux_y(square(n)), owner(square(n)), excess(n) {
    const double pi = std::acos(-1.0);
    const Patch patch = square(n);
    const auto psi = [&](int i, int j) {
      return std::sin(pi * patch.x_corner(i)) * std::sin(pi * patch.y_corner(j)) / (pi * patch.h);
    };
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        if (j < n) w.u(i, j) = psi(i, j + 1) - psi(i, j);
        if (i < n) w.v(i, j) = psi(i, j) - psi(i + 1, j);
      }
    fill_velocity_halo(boundary, w.u, w.v);
    Noise noise;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double surface = 0.85 + 0.05 * std::sin(7 * patch.x_centre(i));
        grains(i, j) = std::clamp((surface - patch.y_centre(j)) / patch.h + 0.5, 0.0, 1.0);
        gamma2(i, j) = noise.logarithmic(1e-8, 10);
        p(i, j) = noise(-1, 50);
        eta_c(i, j) = static_cast<float>(noise.logarithmic(1, 1e6));
        mass.density(i, j) = 1e-3 + grains(i, j);
      }
    fill_vof_halo({}, {0, n}, grains);
    freeze_dilation(grains, {}, {0, n}, owner);
    start = twin = grains;
    fill_cell_halo(boundary, mass.density);
    for (int j = 0; j < n; ++j) uniform_density_row(mass.density, j, mass.uniform.row(j));
    fill_random(mass.x, noise);
    fill_random(mass.y, noise);
  }
};

template <At face>
Case vof_sweep(int n) {
  const auto s = std::make_shared<Flow>(n);
  auto& flux = [&]() -> auto& {
    if constexpr (face == At::xface)
      return s->flux_x;
    else
      return s->flux_y;
  }
  ();
  const auto& velocity = [&]() -> const auto& {
    if constexpr (face == At::xface)
      return s->w.u;
    else
      return s->w.v;
  }
  ();
  Case c{60, 28, {}, {}, {}, 0.03};
  c.fast = [s, &flux, &velocity](Team& team) {
    if (team.leads()) s->dt_h = -s->dt_h;  // there and back, so that many sweeps do not wear the surface away
    team.sync();
    const Rows cells = team.rows(s->grains.ny());
    vof_fluxes<face>(s->grains, {}, velocity, s->dt_h, false, team.rows(velocity.ny()), {&flux, 1});
    team.sync();
    apply_fluxes<face, true>({&flux, 1}, velocity, s->dt_h, s->owner, {}, cells, s->grains, {}, s->excess);
    fill_vof_halo({}, cells, s->grains);
  };
  c.plain = [s, &flux, &velocity] {
    plain::vof_sweep<face>(s->twin, velocity, s->twin_dt_h = -s->twin_dt_h, s->owner, flux);
  };
  // The share of cells that differ, from noise. In some of a hundred cells two of the six candidate lines fit
  // equally well, for the misfit is a sum of magnitudes, and rounding chooses.
  c.difference = [s, c] {
    Team alone;
    double off = 0;
    for (int k = 0; k < 2; ++k) {  // both directions
      Noise noise;
      fill_random(s->grains, noise, 0, 1);
      fill_vof_halo({}, {0, s->grains.ny()}, s->grains);
      s->twin = s->grains;
      c.fast(alone);
      c.plain();
      for (int j = 0; j < s->twin.ny(); ++j)
        for (int i = 0; i < s->twin.nx(); ++i)
          off += !(std::abs(s->grains(i, j) - s->twin(i, j)) < double_rounding);
    }
    s->grains = s->twin = s->start;
    return off / (2.0 * s->twin.nx() * s->twin.ny());
  };
  return c;
}

Case advection(int n) {
  const auto s = std::make_shared<Flow>(n);
  Case c{52,
         52,
         [s](Team& team) {
           const int ny = s->w.u.ny();
           using U = MomentumAdvection<At::xface>;
           double* scratch = row_scratch<double>(2 * U::scratch_size(ny + 1));
           const Rows rows = team.rows(ny + 1);
           U u(s->w.u, s->w.v, s->mass, s->dt_h, rows.begin, scratch);
           MomentumAdvection<At::yface> v(s->w.u, s->w.v, s->mass, s->dt_h, rows.begin,
                                          scratch + U::scratch_size(ny + 1));
           for (int j = rows.begin; j < rows.end; ++j) {
             if (j < ny) u.next(s->advected.u.row(j));
             v.next(s->advected.v.row(j));
           }
         },
         [s] { plain::advect(s->w, s->mass, s->dt_h, s->advected_twin); },
         {},
         double_rounding};
  c.difference = both(
      c, [] {}, [s] { return perf::relative_difference(s->advected, s->advected_twin); });
  return c;
}

Case shear_rate(int n) {
  const auto s = std::make_shared<Flow>(n);
  Case c{24,
         24,
         [s](Team& team) {
           const Rows rows = team.rows(s->eta.ny());
           for (int j = rows.begin; j < rows.end; ++j)
             shear_rate_squared_row(s->w.u, s->w.v, j, s->eta.row(j));
         },
         [s] { plain::shear_rate_squared(s->w, s->eta_twin); },
         {},
         double_rounding};
  c.difference = both(
      c, [] {}, [s] { return perf::relative_difference(s->eta, s->eta_twin); });
  return c;
}

Case smoothing(int n) {
  const auto s = std::make_shared<Flow>(n);
  static constexpr SmoothingPass pass{1, 0.25};
  Case c{32,
         16,
         [s](Team& team) {
           const Rows rows = team.rows(s->gamma2.ny());
           for (int j = rows.begin; j < rows.end; ++j)
             smooth_row(s->gamma2.row(j), s->gamma2.nx(), pass, {}, s->spare.row(j));
           team.sync();
           for (int j = rows.begin; j < rows.end; ++j) smooth_column_row(s->spare, pass, j, s->eta.row(j));
         },
         [s] { plain::smooth(pass, s->twin, s->spare); },
         {},
         double_rounding};
  c.difference = both(
      c, [s] { s->twin = s->gamma2; }, [s] { return perf::relative_difference(s->eta, s->twin); });
  return c;
}

Case viscosity(int n) {
  const auto s = std::make_shared<Flow>(n);
  static constexpr Grain grain;
  static constexpr ViscosityLimits limits{1, 1e6, 0.0164, 0};
  Case c{32,
         32,
         [s](Team& team) {
           const Rows rows = team.rows(s->eta.ny());
           for (int j = rows.begin; j < rows.end; ++j)
             granular_viscosity_row(s->gamma2.row(j), s->p.row(j), s->grains.row(j), s->eta.nx(), grain,
                                    limits, s->eta.row(j));
         },
         [s] { plain::granular_viscosity(s->gamma2, s->p, s->grains, grain, limits, s->eta_twin); },
         {},
         double_rounding};
  c.difference = both(
      c, [] {}, [s] { return perf::relative_difference(s->eta, s->eta_twin); });
  return c;
}

Case corners(int n) {
  const auto s = std::make_shared<Flow>(n);
  Case c{8,
         8,
         [s](Team& team) {
           const Rows rows = team.rows(s->eta_n.ny());
           for (int j = rows.begin; j < rows.end; ++j)
             corner_viscosity_row(s->eta_c, s->boundary, true, j, s->eta_n);
         },
         [s] { plain::corner_viscosity(s->eta_c, s->boundary, s->eta_n_twin); },
         {},
         float_rounding};
  c.difference = both(
      c, [] {},
      [s] {
        double worst = 0;
        for (int j = 0; j < s->eta_n.ny(); ++j)
          for (int i = 0; i < s->eta_n.nx(); ++i)
            worst = std::max(worst, std::abs(double(s->eta_n(i, j)) - s->eta_n_twin(i, j)));
        return worst / 2e6;  // twice the largest viscosity
      });
  return c;
}

/// The ceilings: the triad in half of the second-level cache of each thread, and far beyond the last level.
void stream(benchmark::State& state, double bytes, int threads, double& gigabytes) {
  Triad triad(bytes);
  const perf::Job job = perf::on_threads(threads, [&](Team& team) { triad.run(team); });
  for (auto _ : state) {
    const double seconds = perf::median(perf::take_turns({job})[0]);
    state.SetIterationTime(seconds);
    gigabytes = triad.bytes() / seconds / 1e9;
    state.counters["triad_GB/s"] = gigabytes;
  }
  if (!triad.right()) perf::wrong(state, "the triad is wrong");
}

double cache_bytes(int name, double otherwise) {
  const long size = ::sysconf(name);
  return size > 0 ? static_cast<double>(size) : otherwise;
}

}  // namespace

int main(int argc, char** argv) {
  perf::start(argc, argv, {"roofline"});
  const double near = cache_bytes(_SC_LEVEL2_CACHE_SIZE, 1 << 20) / 2;
  const double far = 4 * cache_bytes(_SC_LEVEL3_CACHE_SIZE, 1 << 25);
  std::vector<perf::Ceiling> ceilings{
      {"L2 cache", 1, 0}, {"L2 cache", 2, 0}, {"memory", 1, 0}, {"memory", 2, 0}};
  for (perf::Ceiling& c : ceilings) {
    const double bytes = c.where == "memory" ? far : near * c.threads;
    benchmark::RegisterBenchmark(
        fmt::format("stream/{}/threads:{}", c.where == "memory" ? "memory" : "L2", c.threads).c_str(),
        [&c, bytes](benchmark::State& state) { stream(state, bytes, c.threads, c.gigabytes); })
        ->Iterations(1)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }

  using V = ViscousLevel<float>;
  using P = PoissonLevel<float>;
  const std::vector<int> sizes{128, 256, 512, 1024};
  perf::add("viscous_relax", sizes, relax<V>);
  perf::add("viscous_residual", sizes, residual<V>);
  perf::add("viscous_restrict", sizes, restriction<V>);
  perf::add("viscous_prolong", sizes, prolongation<V>);
  perf::add("poisson_relax", sizes, relax<P>);
  perf::add("poisson_residual", sizes, residual<P>);
  perf::add("poisson_restrict", sizes, restriction<P>);
  perf::add("poisson_prolong", sizes, prolongation<P>);
  perf::add("vof_sweep_x", sizes, vof_sweep<At::xface>);
  perf::add("vof_sweep_y", sizes, vof_sweep<At::yface>);
  perf::add("advection", sizes, advection);
  perf::add("shear_rate", sizes, shear_rate);
  perf::add("smoothing", sizes, smoothing);
  perf::add("viscosity", sizes, viscosity);
  perf::add("corner_viscosity", sizes, corners);

  const int status = perf::finish();
  const std::string picture = perf::flag("roofline");
  if (status == 0 && !picture.empty()) perf::draw_roofline(ceilings, perf::results(), picture);
  return status;
}
