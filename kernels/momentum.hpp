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
#include <utility>

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

/// Σ M (q_face - q) of one velocity component, M outward [M/L^2 x L/T], on consecutive rows: what crosses a face between
/// two rows is found once and kept for the next row. where: At::xface for u, At::yface for v.
template <At where>
class MomentumAdvection {
 public:
  /// Values of scratch that rows of n points need.
  static constexpr int scratch_size(int n) { return 5 * (n + 4); }

  /// Rows first, first + 1, ... In: u, v halo 2; mass halo 1.
  MomentumAdvection(const XFaceField& u, const YFaceField& v, const MassTransport& mass, double dt_h,
                    int first, double* scratch)
      : u_(u), v_(v), mass_(mass), dt_h_(dt_h), row_(first), n_(where == At::xface ? u.nx() : v.nx()) {
    for (double** buffer : {&along_slope_, &along_carried_, &slope_, &next_slope_, &carried_}) {
      *buffer = scratch + 2;
      scratch += n_ + 4;
    }
    find_slope(first - 1, next_slope_);
    find_slope(first, slope_);
    const ComponentRow m = component(first - 1), c = component(first);
    const FaceRow face = below(first);
    for (int i = 0; i < n_; ++i) carried_[i] = carry(face, i, m.q[i], c.q[i], next_slope_[i], slope_[i]);
  }

  /// out[i], i = 0 .. n-1, of the next row.
  void next(double* __restrict out) {
    along(out);
    const ComponentRow c = component(row_), p = component(row_ + 1), pp = component(row_ + 2);
    const FaceRow low = below(row_), high = below(row_ + 1);
    const double* __restrict here = slope_;
    double* __restrict there = next_slope_;
    double* __restrict crossed = carried_;
#pragma omp simd
    for (int i = 0; i < n_; ++i) {
      const double ahead = p.flag(i) * limited(p.q[i] - c.q[i], pp.q[i] - p.q[i]);
      const double above = carry(high, i, c.q[i], p.q[i], here[i], ahead);
      out[i] += high.flux(i) * (above - c.q[i]) - low.flux(i) * (crossed[i] - c.q[i]);
      there[i] = ahead;
      crossed[i] = above;
    }
    std::swap(slope_, next_slope_);
    ++row_;
  }

 private:
  ComponentRow component(int k) const {
    // Row k of v lies between cell rows k - 1 and k; beyond the halo the flag is that of the halo, 0.
    if constexpr (where == At::xface) return {u_.row(k), mass_.uniform.row(k) - 1, mass_.uniform.row(k)};
    return {v_.row(k), mass_.uniform.row(std::max(k - 1, -1)), mass_.uniform.row(std::min(k, u_.ny()))};
  }
  /// Faces between rows k - 1 and k.
  FaceRow below(int k) const {
    if constexpr (where == At::xface) return {mass_.y.row(k) - 1, mass_.y.row(k), v_.row(k) - 1, v_.row(k)};
    return {mass_.y.row(k - 1), mass_.y.row(k), v_.row(k - 1), v_.row(k)};
  }
  /// Faces of the row itself: face(i) lies between points i - 1 and i.
  FaceRow beside() const {
    if constexpr (where == At::xface)
      return {mass_.x.row(row_) - 1, mass_.x.row(row_), u_.row(row_) - 1, u_.row(row_)};
    return {mass_.x.row(row_ - 1), mass_.x.row(row_), u_.row(row_ - 1), u_.row(row_)};
  }
  /// Upwind value on a face between a and b, half a step ahead.
  [[gnu::always_inline]] double carry(const FaceRow& face, int i, double a, double b, double slope_a,
                                      double slope_b) const {
    const double ahead = 0.5 * (1 - face.courant(i, dt_h_));
    const double from_a = a + ahead * slope_a, from_b = b - ahead * slope_b;
    return face.flux(i) > 0 ? from_a : from_b;
  }
  void find_slope(int k, double* __restrict out) const {
    const ComponentRow m = component(k - 1), c = component(k), p = component(k + 1);
#pragma omp simd
    for (int i = 0; i < n_; ++i) out[i] = c.flag(i) * limited(c.q[i] - m.q[i], p.q[i] - c.q[i]);
  }
  void along(double* __restrict out) const {
    const ComponentRow row = component(row_);
    const FaceRow face = beside();
    const double* __restrict q = row.q;
    double* __restrict slope = along_slope_;
    double* __restrict crossed = along_carried_;
#pragma omp simd
    for (int i = -1; i <= n_; ++i) slope[i] = row.flag(i) * limited(q[i] - q[i - 1], q[i + 1] - q[i]);
#pragma omp simd
    for (int i = 0; i <= n_; ++i) crossed[i] = carry(face, i, q[i - 1], q[i], slope[i - 1], slope[i]);
#pragma omp simd
    for (int i = 0; i < n_; ++i)
      out[i] = face.flux(i + 1) * (crossed[i + 1] - q[i]) - face.flux(i) * (crossed[i] - q[i]);
  }

  const XFaceField& u_;
  const YFaceField& v_;
  const MassTransport& mass_;
  const double dt_h_;
  int row_;
  const int n_;
  double *along_slope_, *along_carried_, *slope_, *next_slope_, *carried_;
};

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
