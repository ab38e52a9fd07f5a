#pragma once
// |γ̇|^2 = 2 D:D in cells, and its smoothing over a physical length.
#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/boundary.hpp"
#include "kernels/team.hpp"

namespace hourglass {

/// |γ̇|^2 in the cells of row j: 2 (dx u)^2 + 2 (dy v)^2 + (mean over the four corners of dy u + dx v)^2 [1/T^2]. The
/// mean before the square takes out the shortest wave (docs/theory.md). in: u, v, halo 1 filled by
/// fill_velocity_halo; out: nx values. 2 reads + 1 write: 24 B/cell. `deviatoric`: of D without its trace, which is
/// the same where div u = 0.
template <bool deviatoric = false>
void shear_rate_squared_row(const XFaceField& u, const YFaceField& v, int j, double* __restrict out) {
  const int nx = v.nx();
  const double inv_h = 1 / u.patch().h;
  const double *uc = u.row(j), *us = u.row(j - 1), *un = u.row(j + 1);
  const double *vc = v.row(j), *vn = v.row(j + 1);
#pragma omp simd
  for (int i = 0; i < nx; ++i) {
    const double exx = (uc[i + 1] - uc[i]) * inv_h, eyy = (vn[i] - vc[i]) * inv_h;
    // Sum over four corners of dy u + dx v; the inner differences cancel.
    const double shear_u = (un[i] - us[i]) + (un[i + 1] - us[i + 1]);
    const double shear_v = (vc[i + 1] - vc[i - 1]) + (vn[i + 1] - vn[i - 1]);
    const double shear = 0.25 * (shear_u + shear_v) * inv_h;
    const double normal = deviatoric ? (exx - eyy) * (exx - eyy) : 2 * (exx * exx + eyy * eyy);
    out[i] = normal + shear * shear;
  }
}

/// The passes that smooth over a length: each is the stencil (w, 1 - 2w, w) at distance `stride` in x and in
/// y.
struct SmoothingPass {
  int stride;
  double weight;  ///< w <= 1/4
};

/// Passes whose variances 2 w stride^2 h^2 add up to length^2 / 2: one 1-2-1 pass is length h
/// (docs/theory.md, Ill-posedness; docs/accuracy.md measures lengths). Strides double (a trous), so the
/// number of passes grows with the logarithm of length / h. halo = 2 bounds nothing here: strides reach into
/// the patch only.
inline std::vector<SmoothingPass> smoothing_passes(double length, double h) {
  std::vector<SmoothingPass> passes;
  double variance = 0.5 * (length / h) * (length / h);  // in h^2
  for (int stride = 1; variance > 1e-12; stride *= 2) {
    // Two passes a stride: the first takes out what the wider second one cannot see.
    for (int repeat = 0; repeat < 2 && variance > 1e-12; ++repeat) {
      const double w = std::min(0.25, 0.5 * variance / (stride * stride));
      passes.push_back({stride, w});
      variance -= 2 * w * stride * stride;
    }
  }
  return passes;
}

/// One pass in x over a row of numerator or weight: out = a (1 - 2w) + w (a_left + a_right); points outside the
/// patch are left out of both, so that their ratio stays a mean over the grains inside (boundary-aware).
inline void smooth_row(const double* __restrict in, int n, SmoothingPass pass, Ends ends,
                       double* __restrict out) {
  const int s = pass.stride;
  const double w = pass.weight, c = 1 - 2 * w;
  const int inner = n > 2 * s ? s : n;  // points 0 .. inner-1 and the last ones look across an end
  const auto end_point = [&](int i) {
    const auto at = [&](int k) {
      if (ends.periodic) return in[((k % n) + n) % n];
      if (ends.mirror && k < 0) k = -k - 1;
      return k >= 0 && k < n ? in[k] : 0.0;
    };
    out[i] = c * in[i] + w * (at(i - s) + at(i + s));
  };
  for (int i = 0; i < inner; ++i) end_point(i);
  const double *left = in - s, *right = in + s;
#pragma omp simd
  for (int i = inner; i < n - inner; ++i) out[i] = c * in[i] + w * (left[i] + right[i]);
  for (int i = std::max(inner, n - inner); i < n; ++i) end_point(i);
}

/// One pass in y, row j: out = (1 - 2w) in + w (in below + in above).
inline void smooth_column_row(const CellField& in, SmoothingPass pass, int j, double* __restrict out) {
  const int nx = in.nx(), ny = in.ny(), s = pass.stride;
  const double w = pass.weight, c = 1 - 2 * w;
  const double* a = in.row(j);
  const double *below = in.row(std::max(j - s, 0)), *above = in.row(std::min(j + s, ny - 1));
  const double wb = j - s >= 0 ? w : 0, wa = j + s < ny ? w : 0;
#pragma omp simd
  for (int i = 0; i < nx; ++i) out[i] = c * a[i] + (wb * below[i] + wa * above[i]);
}

}  // namespace hourglass
