#include "solver/dilatancy.hpp"

#include <fmt/format.h>

#include "kernels/boundary.hpp"

namespace hourglass {
namespace {

/// A phase with less in a cell has no packing of its own.
constexpr double least_volume = 1e-9;

const CellField& volume_of(const Fields& fields, std::size_t phase) {
  return phase == 0 ? fields.grains : fields.tracers[phase - 1];
}

}  // namespace

DilatancyStage::DilatancyStage(const Scene& scene, const Patch& patch, Ends ends, const Geometry* geometry)
    : mode_(scene.dilatancy->mode), phi_max_(scene.dilatancy->phi_max), phi_min_(scene.dilatancy->phi_min),
      relaxation_time_(scene.dilatancy->relaxation_time), K_(scene.dilatancy->K), ends_(ends),
      geometry_(geometry), ratio_(scene.materials.size(), CellField(patch, 1)),
      flux_x_(scene.materials.size(), XFaceField(patch)), flux_y_(scene.materials.size(), YFaceField(patch)),
      least_pressure_(scene.materials[0].density * scene.g() * patch.h) {
  if (mode_ == DilatancyMode::weight) return;
  divergence_ = CellField(patch);
  compliance_ = CellField(patch);
}

void DilatancyStage::remember(const Fields& fields, int threads) {
  if (mode_ == DilatancyMode::weight) return;  // phi(I) of the last set_row
  const double lowest = 0.5 * phi_min_ / phi_max_,
               highest = 1.05;  // what rounding at the surface may not leave
  parallel(threads, [&](Team& team) {
    const Rows rows = rows_of(team);
    for (std::size_t k = 0; k < ratio_.size(); ++k)
      for (int j = rows.begin; j < rows.end; ++j) {
        const double* volume = volume_of(fields, k).row(j);
        const double* solid = fields.solid[k].row(j);
        double* __restrict out = ratio_[k].row(j);
#pragma omp simd
        for (int i = 0; i < ratio_[k].nx(); ++i) {
          const double ratio = solid[i] / std::max(volume[i], least_volume);
          out[i] = volume[i] > least_volume ? std::min(std::max(ratio, lowest), highest) : 1.0;
        }
        fill_ends(ends_, out, ratio_[k].nx());
      }
  });
}

void DilatancyStage::transport(Fields& fields, const Vof& vof, int threads) {
  parallel(threads, [&](Team& team) {
    const int nx = ratio_[0].nx(), ny = ratio_[0].ny();
    const Rows faces = team.rows(ny + 1), rows = rows_of(team);
    for (std::size_t k = 0; k < ratio_.size(); ++k)
      for (int j = faces.begin; j < faces.end; ++j) {
        const double* here = ratio_[k].row(j);
        const auto carry = [&](int n, const double* lower, const double* volume, double* __restrict out) {
#pragma omp simd
          for (int i = 0; i < n; ++i) out[i] = volume[i] * (volume[i] > 0 ? lower[i] : here[i]);
        };
        if (j < ny) carry(nx + 1, here - 1, vof.flux_x(static_cast<int>(k)).row(j), flux_x_[k].row(j));
        carry(nx, ratio_[k].row(j - 1), vof.flux_y(static_cast<int>(k)).row(j), flux_y_[k].row(j));
      }
    team.sync();
    for (std::size_t k = 0; k < ratio_.size(); ++k)
      for (int j = rows.begin; j < rows.end; ++j) {
        double* __restrict solid = fields.solid[k].row(j);
        const double *x = flux_x_[k].row(j), *s = flux_y_[k].row(j), *n = flux_y_[k].row(j + 1);
        const double *volume = volume_of(fields, k).row(j), *ratio = ratio_[k].row(j);
        if (mode_ == DilatancyMode::weight) {
#pragma omp simd
          for (int i = 0; i < nx; ++i) solid[i] = volume[i] * ratio[i];
        } else if (geometry_) {
          const double* per_open = geometry_->inverse_volume.row(j);
#pragma omp simd
          for (int i = 0; i < nx; ++i) solid[i] -= per_open[i] * ((x[i + 1] - x[i]) + (n[i] - s[i]));
        } else {
#pragma omp simd
          for (int i = 0; i < nx; ++i) solid[i] -= (x[i + 1] - x[i]) + (n[i] - s[i]);
        }
      }
  });
}

void DilatancyStage::set_row(const Fields& fields, int j, const double* __restrict I,
                             const double* __restrict mu, const double* __restrict gamma2,
                             const double* __restrict pressure, const double* __restrict phi_g,
                             const double* __restrict d_sqrt_rho) {
  const int nx = ratio_[0].nx();
  const double phi_max = phi_max_, phi_min = phi_min_;
  if (mode_ == DilatancyMode::weight) {
    for (CellField& ratio : ratio_) {
      double* __restrict out = ratio.row(j);
#pragma omp simd
      for (int i = 0; i < nx; ++i) out[i] = packing_of_I(I[i], phi_max, phi_g[i], phi_min) / phi_max;
      fill_ends(ends_, out, nx);
    }
    return;
  }
  const double *solid = fields.solid[0].row(j), *grains = fields.grains.row(j), *p = fields.p.row(j);
  double* __restrict S = divergence_.row(j), * __restrict softness = compliance_.row(j);
  const bool relax = mode_ == DilatancyMode::relax;
  const double K = K_, per_time = 1 / relaxation_time_, least = least_pressure_;
#pragma omp simd
  for (int i = 0; i < nx; ++i) {
    const double rate = std::sqrt(gamma2[i]);
    const double phi = phi_max * solid[i] / std::max(grains[i], 0.5);
    const double aim = packing_of_I(I[i], phi_max, phi_g[i], phi_min);
    const double wanted =
        relax ? K * rate * (phi - aim) : (1 - aim / std::max(phi, 0.1 * phi_min)) * per_time;
    // Cells of the free surface keep their packing: their volume is the reconstruction's.
    const double full = static_cast<double>(grains[i] > 0.99);
    // Grains dilate and settle no faster than they are sheared, but do not stay crushed; and dilating does no more work
    // against P than friction takes from the flow, or the flow would drive itself.
    const double crushed = std::max(1 - phi_max / std::max(phi, phi_max), 0.0);
    S[i] =
        full * std::min(std::max(wanted, -rate), std::max(std::min(mu[i], 1.0) * rate, crushed * per_time));
    // S = 0 at the pressure where phi(I) is phi. The secant to there, or to a multiple of P if that is nearer: a tangent
    // would be of no use, for S is steep at small P and level at its bounds. Not nearer than a part of a cell's weight: S
    // made linear over less would pass its bounds by far. Without a slope S does not depend on P.
    const double slip = rate * d_sqrt_rho[i] * phi_g[i] / std::max(phi_max - phi, 1e-12);
    const double rest = slip * slip, apart = std::abs(rest - pressure[i]);
    const double reach = std::min(apart, 2 * pressure[i] + least);
    // No pressure crushes grains; where P is nothing, as beside the surface, δp is noise that S must not follow; and
    // tension has to go before P rises.
    const double tension = std::max(-p[i], 0.0);
    const double room = std::min(std::max(1 - crushed * 50, 0.0), 1.0);
    softness[i] =
        static_cast<double>(phi_g[i] > 0) * room * std::abs(S[i]) / (std::max(reach, least) + tension);
  }
}

void DilatancyStage::walk(Archive& archive) {
  if (mode_ != DilatancyMode::weight) return;
  for (std::size_t k = 0; k < ratio_.size(); ++k) archive.field(fmt::format("packing_{}", k), ratio_[k]);
}

std::size_t DilatancyStage::bytes() const {
  std::size_t sum = divergence_.bytes() + compliance_.bytes();
  for (const CellField& f : ratio_) sum += f.bytes();
  for (const XFaceField& f : flux_x_) sum += f.bytes();
  for (const YFaceField& f : flux_y_) sum += f.bytes();
  return sum;
}

}  // namespace hourglass
