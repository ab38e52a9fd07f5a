#include "solver/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

/// out[i] = 1 where well posed, on row j.
void well_posed_row(const Scene& scene, const Fields& fields, const RheologyStage& rheology, int j,
                    double* out) {
  const CellField& gamma2 = rheology.shear_rate_squared();
  const double most = 0.999 * scene.rheology.eta_max, p0 = scene.rheology.background_pressure;
  GrainProperties::Rows rows(rheology.properties(), fields, j);
  const GrainRows law = rows.law();
  for (int i = 0; i < fields.p.nx(); ++i) {
    const Grain g = law.at(i);
    const double rate = std::sqrt(gamma2(i, j)), pressure = std::max(fields.p(i, j) + p0, 0.0);
    const bool sheared =
        fields.grains(i, j) > 0.5 && pressure > 0 && granular_viscosity(rate, pressure, g) < most;
    out[i] = !sheared || well_posedness(inertial_number(rate, pressure, g), g) <= 0 ? 1 : 0;
  }
}

}  // namespace

CellField well_posed_cells(const Scene& scene, const Fields& fields, const RheologyStage& rheology) {
  CellField out(fields.patch(), 1);
  for (int j = 0; scene.rheology.law == Law::mu_I && j < out.ny(); ++j)
    well_posed_row(scene, fields, rheology, j, out.row(j));
  return out;
}

double ill_posed_fraction(const Scene& scene, const Fields& fields, const Geometry* geometry,
                          const RheologyStage& rheology, int threads) {
  if (scene.rheology.law != Law::mu_I) return 0;
  const int nx = fields.p.nx(), ny = fields.p.ny();
  RowSums bad(ny), all(ny);
  parallel(threads, [&](Team& team) {
    const Rows rows = team.rows(ny);
    double* well = row_scratch<double>(nx);
    for (int j = rows.begin; j < rows.end; ++j) {
      well_posed_row(scene, fields, rheology, j, well);
      double b = 0, a = 0;
      for (int i = 0; i < nx; ++i) {
        if (geometry && geometry->volume(i, j) == 0) continue;
        b += 1 - well[i];
        a += fields.grains(i, j) > 0.5 ? 1 : 0;
      }
      bad[j] = b;
      all[j] = a;
    }
  });
  return all.sum() > 0 ? bad.sum() / all.sum() : 0;
}

std::vector<double> masses_by_material(const Scene& scene, const Fields& fields, const Geometry* geometry,
                                       int threads, bool by_volume) {
  const int nx = fields.p.nx(), ny = fields.p.ny();
  const double area = scene.copies() * fields.patch().h * fields.patch().h;
  std::vector<double> volumes;
  std::vector<const CellField*> phases{&fields.grains};
  for (const CellField& t : fields.tracers) phases.push_back(&t);
  for (std::size_t k = 0; !by_volume && k < fields.solid.size(); ++k) phases[k] = &fields.solid[k];
  RowSums sums(ny);
  for (const CellField* phase : phases) {
    parallel(threads, [&](Team& team) {
      const Rows rows = team.rows(ny);
      for (int j = rows.begin; j < rows.end; ++j) {
        const double* c = phase->row(j);
        double s = 0;
        if (geometry) {
          const double* open = geometry->volume.row(j);
#pragma omp simd reduction(+ : s)
          for (int i = 0; i < nx; ++i) s += open[i] * c[i];
        } else {
#pragma omp simd reduction(+ : s)
          for (int i = 0; i < nx; ++i) s += c[i];
        }
        sums[j] = s;
      }
    });
    volumes.push_back(sums.sum() * area);
  }
  for (std::size_t k = 1; k < volumes.size(); ++k) volumes[0] -= volumes[k];
  for (std::size_t k = 0; k < volumes.size(); ++k) volumes[k] *= scene.materials[k].density;
  return volumes;
}

double fastest_grains(const Fields& fields, const Geometry* geometry, int threads) {
  const int nx = fields.p.nx(), ny = fields.p.ny();
  RowSums fastest(ny);
  parallel(threads, [&](Team& team) {
    const Rows rows = team.rows(ny);
    for (int j = rows.begin; j < rows.end; ++j) {
      double m = 0;
      for (int i = 0; i < nx; ++i)
        if (fields.grains(i, j) >= 0.5 && !(geometry && geometry->volume(i, j) == 0))
          m = std::max(m, cell_speed(fields, i, j));
      fastest[j] = m;
    }
  });
  return fastest.max();
}

std::string not_finite(const Fields& fields) {
  for (int j = 0; j < fields.p.ny(); ++j)
    for (int i = 0; i < fields.p.nx(); ++i) {
      const char* name = !std::isfinite(fields.p(i, j))        ? "pressure"
                         : !std::isfinite(fields.u(i, j))      ? "velocity u"
                         : !std::isfinite(fields.v(i, j))      ? "velocity v"
                         : !std::isfinite(fields.grains(i, j)) ? "share of grains"
                                                               : nullptr;
      if (name) return fmt::format("{} is not a number in cell ({}, {})", name, i, j);
    }
  return {};
}

double mass_through(const Scene& scene, const PhaseFlux& flux, Side side, const std::vector<OpenFace>& faces,
                    int material) {
  const Patch patch = scene.patch();
  // Phase 0 of the fluxes is all grains, phase k > 0 material k.
  const auto volume = [&](int phase) {
    const XFaceField& x = flux.x[phase];
    const YFaceField& y = flux.y[phase];
    double sum = 0;
    for (const auto& [f, share] : faces)
      sum += share * (side == Side::left     ? -x(0, f)
                      : side == Side::right  ? x(patch.nx, f)
                      : side == Side::bottom ? -y(f, 0)
                                             : y(f, patch.ny));
    return sum;
  };
  double sum = volume(material);
  for (int k = 1; material == 0 && k < static_cast<int>(scene.materials.size()); ++k) sum -= volume(k);
  return sum * scene.copies() * patch.h * patch.h * scene.materials[material].density;
}

// An orifice on the left edge has its centre there, any other begins at the edge or beyond.
static bool on_left_edge(const Orifice& o) {
  return (o.wall == Side::bottom || o.wall == Side::top) && o.centre < 0.25 * o.width;
}

int images(const Scene& scene, const Orifice& orifice) {
  return scene.symmetry == Symmetry::mirror && !on_left_edge(orifice) ? 2 : 1;
}

double total_width(const Scene& scene) {
  double sum = 0;
  for (const Orifice& o : scene.orifices)
    if (!scene.axisymmetric() || (o.wall == Side::bottom && on_left_edge(o)))
      sum += images(scene, o) * o.width;
  return sum;
}

double discharge_scale(const Scene& scene, double width) {
  return scene.materials[0].density * std::sqrt(scene.g()) *
         std::pow(width, scene.axisymmetric() ? 2.5 : 1.5);
}

double start_up_time(const Scene& scene) {
  double widest = 0;
  for (const Orifice& o : scene.orifices) widest = std::max(widest, o.width);
  return scene.g() > 0 ? 2.5 * std::sqrt(widest / scene.g()) : 0;
}

DischargeWindow discharge(const Scene& scene, const History& mass) {
  DischargeWindow window;
  if (mass.size() < 2) return window;
  const double end = mass.back()[0], first_mass = mass.front()[1];
  // A start from a stored run goes on from its time.
  window.from = std::max(0.0, start_up_time(scene) - (scene.start ? scene.start->time.value_or(0) : 0));
  if (window.from > 0.5 * end) window.from = 0.5 * end;  // a short run: its second half
  for (const auto& [t, m] : mass)
    // An almost empty silo no longer discharges at its own rate.
    if (t >= window.from && (m >= 0.3 * first_mass || scene.feed)) window.to = t;
  window.rate = loss_rate(mass, window.from, window.to);
  return window;
}

double loss_rate(const History& history, double from, double to) {
  double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
  for (const auto& [t, value] : history) {
    if (t < from || t > to) continue;
    const double x = t - from, y = value - history.front()[1];
    n += 1;
    st += x;
    sy += y;
    stt += x * x;
    sty += x * y;
  }
  const double spread = n * stt - st * st;
  return n >= 2 && spread > 0 ? -(n * sty - st * sy) / spread : 0;
}

std::optional<double> mean_over(const History& history, double from, double to) {
  double sum = 0, n = 0;
  for (const auto& [t, value] : history)
    if (t >= from && t <= to) sum += value, n += 1;
  return n > 0 ? std::optional(sum / n) : std::nullopt;
}

}  // namespace hourglass
