#pragma once
// Piecewise-linear interface in one cell: the phase is {n . x <= alpha} in the unit square, its share is c.
// All functions are pure. Lengths are in cell sides, areas in cell areas. Sums are ordered, and ties decided,
// so that a mirrored block gives the mirrored line to the last bit.
//
// Line constant and area: Scardovelli & Zaleski 2000, JCP 164:228. Normal: ELVIRA, Pilliod & Puckett 2004,
// JCP 199:465, with the sum of |misfit| for their sum of squares. The reversed vortex of tests/verification
// ends with an error of 3.4e-2, 3.3e-3, 9.9e-4 at 32, 64, 128 cells; by the sum of squares 4.9e-2, 4.2e-3,
// 1.1e-3; with the mixed Youngs-centred normal (Aulisa et al. 2007, JCP 225:2301) 6.3e-2, 1.0e-2, 1.1e-3.
#include <algorithm>
#include <cmath>

namespace hourglass {

/// Shares of a cell and its eight neighbours: block[1 + di][1 + dj].
using Block = double[3][3];

/// Normal out of the phase, |nx| + |ny| = 1, and alpha measured from the corner that the phase fills first:
/// {|nx| x' + |ny| y' <= alpha}. nx = ny = 0 where the block is symmetric and shows no direction.
struct Line {
  double nx = 0, ny = 0, alpha = 0;
};

/// Area of {n1 x + n2 y <= alpha} in the unit square; n1, n2 >= 0 in any scale.
inline double area_below(double n1, double n2, double alpha) {
  if (alpha <= 0) return 0;
  const double rest = (n1 + n2) - alpha;
  if (rest <= 0) return 1;
  const double low = std::min(n1, n2), high = std::max(n1, n2);
  if (alpha < low) return 0.5 * (alpha / low) * (alpha / high);
  if (rest < low) return 1 - 0.5 * (rest / low) * (rest / high);
  return (alpha - 0.5 * low) / high;
}

/// Inverse of area_below for n1 + n2 = 1 and 0 <= c <= 1.
inline double line_constant(double n1, double n2, double c) {
  const double low = std::min(n1, n2), high = std::max(n1, n2);
  const double part = std::min(c, 1 - c);
  const double alpha = 2 * high * part < low ? std::sqrt(2 * low * high * part) : high * part + 0.5 * low;
  return c <= 0.5 ? alpha : (n1 + n2) - alpha;
}

/// Area of {n1 x + n2 y <= alpha} in the rectangle with lower corner (x, y) and sides dx, dy.
inline double area_in_rectangle(double n1, double n2, double alpha, double x, double y, double dx,
                                double dy) {
  return dx * dy * area_below(n1 * dx, n2 * dy, (alpha - n1 * x) - n2 * y);
}

/// The line in the middle cell, 0 < c < 1, that keeps its share and fits the other eight best, of six whose
/// slopes are differences of column heights: backward, centred, forward; columns along y, along x. Exact
/// wherever the interface is straight throughout the block.
inline Line reconstruct(const Block& c) {
  const double left = (c[0][0] + c[0][2]) + c[0][1], right = (c[2][0] + c[2][2]) + c[2][1];
  const double below = (c[0][0] + c[2][0]) + c[1][0], above = (c[0][2] + c[2][2]) + c[1][2];
  const double mid_x = (c[1][0] + c[1][2]) + c[1][1], mid_y = (c[0][1] + c[2][1]) + c[1][1];
  const double side_x = left > right ? 1 : left < right ? -1 : 0;
  const double side_y = below > above ? 1 : below < above ? -1 : 0;

  constexpr int lanes = 8;         // six candidates, padded to a vector
  constexpr double no_line = 100;  // above any misfit
  const double nx[lanes] = {left - mid_x, mid_x - right, 0.5 * (left - right), side_x, side_x, side_x, 1, 1};
  const double ny[lanes] = {side_y, side_y, side_y, below - mid_y, mid_y - above, 0.5 * (below - above),
                            1,      1};
  const double part = std::min(c[1][1], 1 - c[1][1]);
  double misfit[lanes];
#pragma omp simd
  for (int k = 0; k < lanes; ++k) {  // here the normal is scaled to a greater component of 1
    const double size_x = std::abs(nx[k]), size_y = std::abs(ny[k]);
    const double scale = 1 / (size_x < size_y ? size_y : size_x);
    const double x = nx[k] * scale, y = ny[k] * scale;
    const double low = (size_x < size_y ? size_x : size_y) * scale, per_square = 0.5 / low;
    const double root = std::sqrt(2 * low * part), linear = part + 0.5 * low;
    const double from_near = 2 * part < low ? root : linear;
    const double alpha = c[1][1] <= 0.5 ? from_near : (1 + low) - from_near;
    const auto off = [&](int a, int b) {  // |misfit| in cell (a, b); area_below without branches
      const double at = (alpha - a * x) - b * y, rest = (1 + low) - at;
      const double closer = at < rest ? at : rest;
      const double depth = closer > 0 ? closer : 0;
      const double area = depth < low ? depth * depth * per_square : depth - 0.5 * low;
      return std::abs((at < rest ? area : 1 - area) - c[1 + a][1 + b]);
    };
    const double sum = ((off(-1, -1) + off(1, 1)) + (off(-1, 1) + off(1, -1))) +
                       ((off(-1, 0) + off(1, 0)) + (off(0, -1) + off(0, 1)));
    misfit[k] = size_x + size_y > 0 ? sum : no_line;
  }
  // Backward and forward change places in a mirror: if they tie, the centred slope it is.
  const auto best_of = [&](int k) {
    if (misfit[k] < misfit[k + 1]) return misfit[k] < misfit[k + 2] ? k : k + 2;
    if (misfit[k + 1] < misfit[k]) return misfit[k + 1] < misfit[k + 2] ? k + 1 : k + 2;
    return k + 2;
  };
  const int along_y = best_of(0), along_x = best_of(3);
  const int best = misfit[along_y] <= misfit[along_x] ? along_y : along_x;
  if (misfit[best] == no_line) return {};
  const double size = std::abs(nx[best]) + std::abs(ny[best]);
  const double x = nx[best] / size, y = ny[best] / size;
  return {x, y, line_constant(std::abs(x), std::abs(y), c[1][1])};
}

/// Phase in the strip of width |shift| <= 1 that leaves the middle cell of the block through its upper
/// (shift > 0) or lower side along the first axis.
inline double area_leaving(const Block& block, double shift) {
  const double width = std::abs(shift);
  const Line line = reconstruct(block);
  if (line.nx == 0 && line.ny == 0) return width * block[1][1];
  const bool far = (line.nx > 0) == (shift > 0);  // from the corner that the phase fills first
  return std::min(block[1][1], area_in_rectangle(std::abs(line.nx), std::abs(line.ny), line.alpha,
                                                 far ? 1 - width : 0.0, 0, width, 1));
}

}  // namespace hourglass
