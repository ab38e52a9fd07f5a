#pragma once
// One directional sweep of c_t + div(c u) = 0 for volume fractions, conservative for a solenoidal velocity:
//
//   c <- c - (F_upper - F_lower) + s (u_upper - u_lower) dt / h,   s = (c^n > 1/2), frozen for the whole step
//
// Weymouth & Yue 2010, JCP 229:2853. F is the area of the phase swept through a face, from the interface
// reconstructed in the cell upstream; or, where it is not, that cell's share of what passes (first order: donor cell).
// Either way c stays in [0, 1] while (|u| + |v|) dt / h < 1/2.
//
// Tracers ride on the flux of the grains. Tracer k may fill what the grains and the tracers before it leave,
// its room, and takes of the flux of its room what a line in the share of the room says: the free surface
// does not tilt that line. It never carries more than the room does, nor leaves to the others more than they
// have. A room full of the tracer passes on its flux as it is, so a pure material stays pure, and a tracer
// equal to the grains moves exactly as the grains do.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>

#include "kernels/boundary.hpp"
#include "kernels/plic.hpp"
#include "kernels/team.hpp"

namespace hourglass {

/// Shares closer than this to empty or to full are set to it: rounding must not breed interface cells.
inline constexpr double wisp = 1e-12;

/// A cell with less room than this says nothing of how the tracers lie in their room.
inline constexpr double least_room = 1e-6;

/// Which phase of a cell takes the dilation s of the sweeps: 0 air, 1 the grains' rest (material 0), k + 1
/// tracer k.
using DilationOwner = CellFieldOf<int>;

/// Cells or faces that the inner loops take at a time; their temporaries stay in the first cache.
inline constexpr int vof_block = 64;

/// Cells on either side of the faces of row j, so that face i lies between lower[i] and upper[i].
template <At face>
struct CellsBeside {
  const double *lower, *upper;
  CellsBeside(const CellField& c, int j) : lower(c.row(j) - 1), upper(c.row(j)) {
    if constexpr (face == At::yface) lower = c.row(j - 1);
  }
};

// in: c, rows; out: halo of those rows, 1 layer, 2 where periodic or mirrored, and of the row below or above if row 0 or
// the last is among the rows (then its neighbour must be too). For reconstruction only: what flows in is air
// and is set by the fluxes. Linear continuation lets an interface meet a wall at any angle; against a copy of
// the edge cell it takes the errors beside the walls down by a factor of two to four.
inline void fill_vof_halo(Ends ends, Rows rows, CellField& c) {
  const int nx = c.nx(), ny = c.ny();
  const auto beyond = [](double edge, double inside) { return std::clamp(2 * edge - inside, 0.0, 1.0); };
  for (int j = rows.begin; j < rows.end; ++j) {
    double* row = c.row(j);
    row[-1] = beyond(row[0], row[nx > 1 ? 1 : 0]);
    row[nx] = beyond(row[nx - 1], row[nx > 1 ? nx - 2 : 0]);
    fill_ends(ends, row, nx);
  }
  const auto continue_row = [&](int out, int edge, int inside) {
    for (int i = -halo; i < nx + halo; ++i) c(i, out) = beyond(c(i, edge), c(i, inside));
  };
  if (rows.begin == 0) continue_row(-1, 0, ny > 1 ? 1 : 0);
  if (rows.end == ny) continue_row(ny, ny - 1, ny > 1 ? ny - 2 : 0);
}

// in: grains, tracers [1]; out: owner, interior. Each phase takes the dilation where it
// is the greater part of its room. 12 B/cell, and 8 for each tracer.
inline void freeze_dilation(const CellField& grains, std::span<const CellField> tracers, Rows rows,
                            DilationOwner& owner) {
  const int nx = grains.nx();
  for (int j = rows.begin; j < rows.end; ++j) {
    const double* c = grains.row(j);
    int* o = owner.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i) o[i] = c[i] > 0.5;
    for (int first = 0; !tracers.empty() && first < nx; first += vof_block) {
      const int last = std::min(first + vof_block, nx);
      double room[vof_block];
      std::copy(c + first, c + last, room);
      for (std::size_t k = 0; k < tracers.size(); ++k) {
        const double* f = tracers[k].row(j);
        const int name = static_cast<int>(k) + 2;
#pragma omp simd
        for (int i = first; i < last; ++i) {
          o[i] = o[i] == 1 && f[i] > 0.5 * room[i - first] ? name : o[i];
          room[i - first] -= f[i];
        }
      }
    }
  }
}

/// What the grains and the tracers before it leave to a tracer in cell (i, j).
inline double room_at(const CellField& grains, std::span<const CellField> before, int i, int j) {
  double room = grains(i, j);
  for (const CellField& tracer : before) room -= tracer(i, j);
  return room;
}

/// The block around cell (i, j), first axis along the sweep; value(i, j) of a cell.
template <At face, class Value>
void gather(int i, int j, Value&& value, Block& block) {
  for (int a = -1; a <= 1; ++a)
    for (int b = -1; b <= 1; ++b)
      block[1 + a][1 + b] = face == At::xface ? value(i + a, j + b) : value(i + b, j + a);
}

// in: grains, tracers [1], halo filled; velocity [L/T], times what is open of faces; dt_h = dt / h; rows of faces;
// volume of cells, or none where all are whole. out: flux[0] of the grains, flux[k] of tracer k - 1 [cell areas,
// positive to + axis], all faces. Through a boundary that is not periodic only air comes in. 24 B/face, and 16 for each tracer.
// Without `interfaces` a flux is the cell's share of what passes, whatever lies where in the cell.
template <At face, bool interfaces = true>
void vof_fluxes(const CellField& grains, std::span<const CellField> tracers, const Field<face>& velocity,
                double dt_h, bool periodic, Rows rows, std::span<Field<face>> flux,
                const CellField* volume = nullptr) {
  const int n = velocity.nx();
  const bool wraps = face == At::xface && periodic;
  for (int j = rows.begin; j < rows.end; ++j) {
    const double* u = velocity.row(j);
    const auto donor_i = [&](int i) { return face == At::xface && u[i] > 0 ? i - 1 : i; };
    const auto donor_j = [&](int i) { return face == At::yface && u[i] > 0 ? j - 1 : j; };
    const auto inflow = [&](int i) {  // through the boundary
      if (face == At::yface) return (j == 0 && u[i] > 0) || (j == velocity.ny() - 1 && u[i] < 0);
      return !wraps && ((i == 0 && u[i] > 0) || (i == n - 1 && u[i] < 0));
    };
    // What leaves a cell is taken from as much of it as the flux is of its volume, from all of a small one.
    const auto size = [&](int i) {
      return volume ? std::max((*volume)(donor_i(i), donor_j(i)), std::abs(u[i]) * dt_h) : 1.0;
    };
    for (int first = 0; first < n; first += vof_block) {
      const int last = std::min(first + vof_block, n);
      double room[vof_block], room_flux[vof_block], share[vof_block];  // of the cell upstream
      int mixed = 0;

      const CellsBeside<face> c(grains, j);
      double* F = flux[0].row(j);
#pragma omp simd reduction(| : mixed)
      for (int i = first; i < last; ++i) {
        const double donor = u[i] > 0 ? c.lower[i] : c.upper[i];
        mixed |= (donor > 0) & (donor < 1) & (u[i] != 0);
        room[i - first] = donor;
        F[i] = donor * (u[i] * dt_h);
      }
      for (int i = first; interfaces && mixed && i < last; ++i) {
        if (room[i - first] <= 0 || room[i - first] >= 1 || u[i] == 0) continue;
        Block block;
        gather<face>(donor_i(i), donor_j(i), grains, block);
        F[i] = std::copysign(size(i) * area_leaving(block, u[i] * dt_h / size(i)), u[i]);
      }
      const bool at_side = face == At::xface ? first == 0 || last == n : j == 0 || j == velocity.ny() - 1;
      for (int i = first; at_side && i < last; ++i)
        if (inflow(i)) F[i] = 0;

      if (!tracers.empty()) std::copy(F + first, F + last, room_flux);
      for (std::size_t k = 0; k < tracers.size(); ++k) {
        const CellsBeside<face> f(tracers[k], j);
        double* G = flux[k + 1].row(j);
        mixed = 0;
#pragma omp simd reduction(| : mixed)
        for (int i = first; i < last; ++i) {
          const double donor = u[i] > 0 ? f.lower[i] : f.upper[i];
          const bool pure = donor >= room[i - first] - wisp;
          mixed |= !pure & (donor > 0) & (u[i] != 0);
          share[i - first] = donor;
          const double rest =
              interfaces || donor <= 0 ? 0.0 : room_flux[i - first] * (donor / room[i - first]);
          G[i] = pure ? room_flux[i - first] : rest;
        }
        for (int i = first; interfaces && mixed && i < last; ++i) {
          const double here = share[i - first], others = room[i - first] - here;
          if (here <= 0 || others <= wisp || u[i] == 0) continue;
          const double own = here / room[i - first];
          const auto share_of_room = [&](int a, int b) {
            const double there = room_at(grains, tracers.first(k), a, b);
            return there > least_room ? std::clamp(tracers[k](a, b) / there, 0.0, 1.0) : own;
          };
          Block block;
          gather<face>(donor_i(i), donor_j(i), share_of_room, block);
          const double shift = u[i] * dt_h / size(i), through = std::abs(room_flux[i - first]);
          const double carried = through * (area_leaving(block, shift) / std::abs(shift));
          const double least = std::max(0.0, through - size(i) * others),
                       most = std::min(through, size(i) * here);
          // Not std::clamp: by rounding, and beyond the limit of the step, least may exceed most; most then holds.
          G[i] = std::copysign(std::min(std::max(carried, least), most), u[i]);
        }
        for (int i = first; i < last; ++i) {
          room[i - first] -= share[i - first];
          room_flux[i - first] -= G[i];
        }
      }
    }
  }
}

/// 0 or room if x is as good as that, else x.
inline double without_wisps(double x, double room) {
  return std::abs(x) < wisp ? 0.0 : std::abs(x - room) < wisp ? room : x;
}

// in: flux [cell areas], velocity [L/T], all faces; owner; inverse_volume of cells, unread where these are `whole`. in and
// out: grains, tracers, interior. out: excess[j], by row what lies outside [0, room] [shares]. 36 B/cell, and 24 for each
// tracer.
template <At face, bool whole>
void apply_fluxes(std::span<const Field<face>> flux, const Field<face>& velocity, double dt_h,
                  const DilationOwner& owner, const CellField& inverse_volume, Rows rows, CellField& grains,
                  std::span<CellField> tracers, RowSums& excess) {
  const int nx = grains.nx();
  for (int j = rows.begin; j < rows.end; ++j) {
    const auto upper = [j](const Field<face>& f) { return face == At::xface ? f.row(j) + 1 : f.row(j + 1); };
    const double *u_lower = velocity.row(j), *u_upper = upper(velocity);
    const int* o = owner.row(j);
    const double* inverse = whole ? nullptr : inverse_volume.row(j);
    double outside = 0;
    for (int first = 0; first < nx; first += vof_block) {
      const int last = std::min(first + vof_block, nx);
      double room[vof_block];
      double* c = grains.row(j);
      const double *F_lower = flux[0].row(j), *F_upper = upper(flux[0]);
#pragma omp simd reduction(+ : outside)
      for (int i = first; i < last; ++i) {
        const double dilation = o[i] > 0 ? u_upper[i] - u_lower[i] : 0.0;
        const double v = whole ? 1.0 : inverse[i];
        const double x = without_wisps(c[i] - v * (F_upper[i] - F_lower[i]) + v * (dilation * dt_h), 1);
        outside += std::max(0.0, std::abs(x - 0.5) - 0.5);
        c[i] = x;
      }
      for (std::size_t k = 0; k < tracers.size(); ++k) {
        double* f = tracers[k].row(j);
        const double *G_lower = flux[k + 1].row(j), *G_upper = upper(flux[k + 1]);
        const int name = static_cast<int>(k) + 2;
        if (k == 0) std::copy(c + first, c + last, room);
#pragma omp simd reduction(+ : outside)
        for (int i = first; i < last; ++i) {
          const double dilation = o[i] == name ? u_upper[i] - u_lower[i] : 0.0;
          const double v = whole ? 1.0 : inverse[i];
          const double x =
              without_wisps(f[i] - v * (G_upper[i] - G_lower[i]) + v * (dilation * dt_h), room[i - first]);
          outside += std::max(0.0, std::abs(x - 0.5 * room[i - first]) - 0.5 * room[i - first]);
          f[i] = x;
          room[i - first] -= x;
        }
      }
    }
    excess[j] = outside;
  }
}

}  // namespace hourglass
