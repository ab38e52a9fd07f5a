#pragma once
// Explicit momentum predictor, consistent with the transport of mass:
//
//   u* = u - (1/(ρ' V)) Σ_faces M (u_face - u) + Δt (g - β ∂p),   ρ' = density of the control volume after VOF,
//
// M the mass that VOF carried out of the control volume through each face: the mean of the two fluxes around
// it, for which the mean density of two cells is conserved exactly (the consistency of Rudman 1998 on one
// grid), so a uniform velocity stays uniform at any density ratio. u_face: upwind, second order where the
// density is uniform (monotonised-central slope, half a step ahead), first order across the free surface.
#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/team.hpp"
#include "kernels/velocity.hpp"

namespace hourglass {

/// Where mass is and went in this step.
struct MassTransport {
  XFaceField x;       ///< mass through x-faces in this step over h^2 [M/L^2], halo 0 or wrapped
  YFaceField y;       ///< the same through y-faces
  CellField density;  ///< after VOF, halo 2 [M/L^2]
  CellFieldOf<float>
      uniform;  ///< 1 where density varies by less than 1 % over 3 x 3 cells, else 0; 0 in the halo

  explicit MassTransport(const Patch& p) : x(p), y(p), density(p), uniform(p) {}
  std::size_t bytes() const { return x.bytes() + y.bytes() + density.bytes() + uniform.bytes(); }
};

/// Monotonised-central limited difference (van Leer 1977).
inline double limited(double left, double right) {
  const double central = 0.5 * (left + right);
  const double bound = 2 * std::min(std::abs(left), std::abs(right));
  const double size = std::min(std::abs(central), bound);
  return left * right > 0 ? std::copysign(size, central) : 0.0;
}

/// Faces between points of a row or between two rows: mass flux and velocity are means of two neighbours.
struct FaceRow {
  const double *flux_a, *flux_b, *velocity_a, *velocity_b;
  double flux(int i) const { return 0.5 * (flux_a[i] + flux_b[i]); }
  double courant(int i, double dt_h) const { return std::abs(0.5 * (velocity_a[i] + velocity_b[i])) * dt_h; }
};

/// A row of one velocity component and the two cell rows whose density must be uniform for a slope.
struct ComponentRow {
  const double* q;
  const float *flag_a, *flag_b;
  double flag(int i) const { return static_cast<double>(flag_a[i] * flag_b[i]); }
};

/// out[i] += Σ M (q_face - q_i) over the two faces along the row, i = 0 .. n-1. face(i) lies between points
/// i-1 and i. slope, carried: scratch of n + 4 values, used from index 2.
inline void advect_along_row(const ComponentRow& row, const FaceRow& face, double dt_h, int n,
                             double* __restrict slope, double* __restrict carried, double* __restrict out) {
  const double* __restrict q = row.q;
#pragma omp simd
  for (int i = -1; i <= n; ++i) slope[i + 2] = row.flag(i) * limited(q[i] - q[i - 1], q[i + 1] - q[i]);
#pragma omp simd
  for (int i = 0; i <= n; ++i) {
    const double ahead = 0.5 * (1 - face.courant(i, dt_h));
    const double from_left = q[i - 1] + ahead * slope[i + 1], from_right = q[i] - ahead * slope[i + 2];
    carried[i + 2] = face.flux(i) > 0 ? from_left : from_right;
  }
#pragma omp simd
  for (int i = 0; i < n; ++i)
    out[i] += face.flux(i + 1) * (carried[i + 3] - q[i]) - face.flux(i) * (carried[i + 2] - q[i]);
}

/// out[i] += Σ M (q_face - q_i) over the faces below and above. rows[0..4]: the component at rows j-2 .. j+2.
inline void advect_across_rows(const ComponentRow (&rows)[5], const FaceRow& below, const FaceRow& above,
                               double dt_h, int n, double* __restrict out) {
  const ComponentRow &m = rows[1], &c = rows[2], &p = rows[3];
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double sm = m.flag(i) * limited(m.q[i] - rows[0].q[i], c.q[i] - m.q[i]);
    const double sc = c.flag(i) * limited(c.q[i] - m.q[i], p.q[i] - c.q[i]);
    const double sp = p.flag(i) * limited(p.q[i] - c.q[i], rows[4].q[i] - p.q[i]);
    const double ahead_b = 0.5 * (1 - below.courant(i, dt_h)), ahead_a = 0.5 * (1 - above.courant(i, dt_h));
    const double low = below.flux(i) > 0 ? m.q[i] + ahead_b * sm : c.q[i] - ahead_b * sc;
    const double high = above.flux(i) > 0 ? c.q[i] + ahead_a * sc : p.q[i] - ahead_a * sp;
    out[i] += above.flux(i) * (high - c.q[i]) - below.flux(i) * (low - c.q[i]);
  }
}

/// Σ M (u_face - u) of row j of u, i = 0 .. nx, M outward [M/T/L]. in: u, v halo 2, mass halo 1. scratch: 2
/// (nx + 5). With the rows of v in turn 52 B/cell: 4 reads of 8 B, flags of 4 B, 2 writes of 8 B.
inline void advect_u_row(const XFaceField& u, const YFaceField& v, const MassTransport& mass, double dt_h,
                         int j, double* scratch, double* out) {
  const int n = u.nx();
  std::fill(out, out + n, 0.0);
  const auto component = [&](int k) {
    return ComponentRow{u.row(k), mass.uniform.row(k) - 1, mass.uniform.row(k)};
  };
  const FaceRow along{mass.x.row(j) - 1, mass.x.row(j), u.row(j) - 1, u.row(j)};
  advect_along_row(component(j), along, dt_h, n, scratch, scratch + n + 4, out);
  const ComponentRow rows[5] = {component(j - 2), component(j - 1), component(j), component(j + 1),
                                component(j + 2)};
  const auto corner = [&](int k) {
    return FaceRow{mass.y.row(k) - 1, mass.y.row(k), v.row(k) - 1, v.row(k)};
  };
  advect_across_rows(rows, corner(j), corner(j + 1), dt_h, n, out);
}

/// The same of row j of v, i = 0 .. nx - 1.
inline void advect_v_row(const XFaceField& u, const YFaceField& v, const MassTransport& mass, double dt_h,
                         int j, double* scratch, double* out) {
  const int n = v.nx(), ny = v.patch().ny;
  std::fill(out, out + n, 0.0);
  // Row k of v lies between cell rows k - 1 and k; beyond the halo the flag is that of the halo, 0.
  const auto component = [&](int k) {
    return ComponentRow{v.row(k), mass.uniform.row(std::max(k - 1, -1)), mass.uniform.row(std::min(k, ny))};
  };
  const FaceRow along{mass.x.row(j - 1), mass.x.row(j), u.row(j - 1), u.row(j)};
  advect_along_row(component(j), along, dt_h, n, scratch, scratch + n + 4, out);
  const int lowest = std::max(j - 2, -1), highest = std::min(j + 2, ny + 1);
  const ComponentRow rows[5] = {component(lowest), component(j - 1), component(j), component(j + 1),
                                component(highest)};
  const auto cell = [&](int k) { return FaceRow{mass.y.row(k), mass.y.row(k + 1), v.row(k), v.row(k + 1)}; };
  advect_across_rows(rows, cell(j - 1), cell(j), dt_h, n, out);
}

/// Flags of uniform density on row j. in: density halo 1; out: uniform, interior.
inline void uniform_density_row(const CellField& density, int j, float* __restrict out) {
  const double *a = density.row(j - 1), *b = density.row(j), *c = density.row(j + 1);
  const int n = density.nx();
  const auto lo = [&](int i) { return std::min(std::min(a[i], b[i]), c[i]); };
  const auto hi = [&](int i) { return std::max(std::max(a[i], b[i]), c[i]); };
#pragma omp simd
  for (int i = 0; i < n; ++i) {
    const double least = std::min(std::min(lo(i - 1), lo(i)), lo(i + 1));
    const double most = std::max(std::max(hi(i - 1), hi(i)), hi(i + 1));
    out[i] = most - least < 0.01 * most ? 1.0f : 0.0f;
  }
}

}  // namespace hourglass
