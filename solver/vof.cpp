#include "solver/vof.hpp"

#include <utility>

namespace hourglass {

Vof::Vof(const Patch& patch, int materials, Ends ends, const Geometry* geometry, VofFlux flux)
    : ends_(ends), geometry_(geometry), kind_(flux), owner_(patch), flux_x_(materials, XFaceField(patch)),
      flux_y_(materials, YFaceField(patch)), excess_(patch.ny) {
  if (geometry_) carrier_ = Velocity(patch);
}

void Vof::advect(Fields& fields, double dt, bool x_first, int threads) {
  const double dt_h = dt / fields.patch().h;
  const int members = std::min(threads, std::max(1, fields.patch().ny / 2));  // two rows each, for the halo
  parallel(members, [&](Team& team) {
    const Rows rows = team.rows(fields.patch().ny);
    freeze_dilation(fields.grains, fields.tracers, rows, owner_);
    fill_halos(rows, fields);
    if (geometry_) {
      const Rows faces = team.rows(row_count(carrier_));
      for (int k = faces.begin; k < faces.end; ++k) {
        const double *a = row_of(geometry_->aperture, k).data, *u = row_of(std::as_const(fields), k).data;
        const auto out = row_of(carrier_, k);
#pragma omp simd
        for (int i = 0; i < out.n; ++i) out.data[i] = a[i] * u[i];
      }
    }
    team.sync();
    const Velocity& w = carrier(fields);
    if (x_first) sweep<At::xface>(team, fields, w.u, dt_h, flux_x_);
    sweep<At::yface>(team, fields, w.v, dt_h, flux_y_);
    if (!x_first) sweep<At::xface>(team, fields, w.u, dt_h, flux_x_);
  });
}

template <At face>
void Vof::sweep(Team& team, Fields& fields, const Field<face>& velocity, double dt_h,
                std::span<Field<face>> flux) {
  const auto fluxes = kind_ == VofFlux::plic ? vof_fluxes<face, true> : vof_fluxes<face, false>;
  fluxes(fields.grains, fields.tracers, velocity, dt_h, ends_.periodic, team.rows(velocity.ny()), flux,
         geometry_ ? &geometry_->volume : nullptr);
  team.sync();
  const Rows rows = team.rows(fields.patch().ny);
  if (geometry_) {
    apply_fluxes<face, false>(flux, velocity, dt_h, owner_, geometry_->inverse_volume, rows, fields.grains,
                              fields.tracers, excess_);
  } else {
    apply_fluxes<face, true>(flux, velocity, dt_h, owner_, {}, rows, fields.grains, fields.tracers, excess_);
  }
  fill_halos(rows, fields);
  team.sync();
  if (geometry_ && !geometry_->ghosts.empty()) {
    if (team.leads()) fill_solid_shares(*geometry_, fields);
    team.sync();
  }
  if (excess_.max() > 0) {  // the same answer for every member
    if (team.leads()) put_back(fields);
    team.sync();
  }
}

void Vof::fill_halos(Rows rows, Fields& fields) const {
  fill_vof_halo(ends_, rows, fields.grains);
  for (CellField& tracer : fields.tracers) fill_vof_halo(ends_, rows, tracer);
}

// Serial and in the order of the rows: few cells need it, and it does not depend on the number of threads.
void Vof::put_back(Fields& fields) {
  const int nx = fields.patch().nx, ny = fields.patch().ny;
  const auto volume = [this](int i, int j) { return geometry_ ? geometry_->volume(i, j) : 1.0; };
  const auto suspect = [&](int j) {  // what is put back in a row may come from two rows away
    for (int b = std::max(0, j - 2); b <= std::min(ny - 1, j + 2); ++b)
      if (excess_[b] > 0) return true;
    return false;
  };
  const auto repair = [&](CellField& share, auto&& room_here, auto&& room_beside) {
    for (int j = 0; j < ny; ++j) {
      if (!suspect(j)) continue;
      for (int i = 0; i < nx; ++i) {
        const double kept = std::clamp(share(i, j), 0.0, std::max(0.0, room_here(i, j)));
        double left = (share(i, j) - kept) * volume(i, j);
        if (left == 0) continue;  // in solids too, which hold nothing
        share(i, j) = kept;
        clipped_ += std::abs(left);
        for (int ring = 1; ring <= 2 && left != 0; ++ring) {
          const auto each_beside = [&](auto&& visit) {
            for (int b = -ring; b <= ring; ++b)
              for (int a = -ring; a <= ring; ++a) {
                const int ii = ends_.periodic ? (i + a + nx) % nx : i + a, jj = j + b;
                if (std::max(std::abs(a), std::abs(b)) != ring || ii < 0 || ii >= nx || jj < 0 || jj >= ny)
                  continue;
                if (volume(ii, jj) > 0)
                  visit(share(ii, jj), left > 0 ? room_beside(ii, jj) : share(ii, jj), volume(ii, jj));
              }
          };
          double available = 0;
          each_beside([&](double&, double room, double v) { available += v * std::max(0.0, room); });
          if (available <= 0) continue;
          const double part = std::clamp(left / available, -1.0, 1.0);
          each_beside([&](double& x, double room, double) { x += part * std::max(0.0, room); });
          left = std::abs(left) <= available ? 0.0 : left - part * available;
        }
        lost_ += std::abs(left);
      }
    }
  };
  const auto taken = [&](std::size_t tracers, int i, int j) {
    double sum = 0;
    for (std::size_t m = 0; m < tracers; ++m) sum += fields.tracers[m](i, j);
    return sum;
  };
  const auto& grains = fields.grains;
  const auto air = [&](int i, int j) { return 1 - grains(i, j); };
  repair(
      fields.grains, [](int, int) { return 1.0; }, air);
  for (std::size_t k = 0; k < fields.tracers.size(); ++k)
    repair(
        fields.tracers[k], [&](int i, int j) { return grains(i, j) - taken(k, i, j); },
        [&](int i, int j) { return grains(i, j) - taken(fields.tracers.size(), i, j); });
  fill_halos({0, ny}, fields);
}

std::size_t Vof::bytes() const {
  std::size_t sum = owner_.bytes() + excess_.bytes() + carrier_.bytes();
  for (const XFaceField& f : flux_x_) sum += f.bytes();
  for (const YFaceField& f : flux_y_) sum += f.bytes();
  return sum;
}

}  // namespace hourglass
