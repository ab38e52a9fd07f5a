#include "solver/initial_state.hpp"

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

using Line = std::vector<double>;

/// Monotonised central slope: what it reaches at the ends of a cell lies between the neighbours. 0 at the edge.
double slope(const Line& c, std::size_t i) {
  if (i == 0 || i + 1 == c.size()) return 0;
  const double left = c[i] - c[i - 1], right = c[i + 1] - c[i];
  if (left * right <= 0) return 0;
  return std::copysign(std::min({2 * std::abs(left), 2 * std::abs(right), 0.5 * std::abs(left + right)}),
                       left);
}

/// Slopes of all fields in cell i; each after the first stays between 0 and what those before it leave.
void slopes(const std::vector<Line>& in, std::size_t i, Line& out) {
  double room = in[0][i], room_slope = out[0] = slope(in[0], i);
  for (std::size_t k = 1; k < in.size(); ++k) {
    const double share = in[k][i], rest = std::max(0.0, room - share);
    const double low = std::max(-2 * share, room_slope - 2 * rest),
                 high = std::min(2 * share, room_slope + 2 * rest);
    out[k] = std::clamp(slope(in[k], i), std::min(low, high), high);  // low is not above but by rounding
    room = rest;
    room_slope -= out[k];
  }
}

/// Lines of n cells to lines of m cells over the same length.
void regrid_lines(const std::vector<Line>& in, std::vector<Line>& out) {
  const long n = static_cast<long>(in[0].size()), m = static_cast<long>(out[0].size());
  if (n == m) {
    out = in;
    return;
  }
  Line s(in.size());
  for (Line& line : out) std::fill(line.begin(), line.end(), 0.0);
  for (long i = 0; i < n; ++i) {
    slopes(in, static_cast<std::size_t>(i), s);
    for (long k = i * m / n; k < m && k * n < (i + 1) * m;
         ++k) {  // in units of 1/m of a cell of the old line
      const long low = std::max(i * m, k * n), high = std::min((i + 1) * m, (k + 1) * n);
      const double weight = static_cast<double>(high - low) / static_cast<double>(n);
      const double middle = static_cast<double>(low + high - (2 * i + 1) * m) / static_cast<double>(2 * m);
      for (std::size_t f = 0; f < in.size(); ++f) out[f][k] += weight * (in[f][i] + s[f] * middle);
    }
  }
}

}  // namespace

std::vector<CellField> regrid(const std::vector<CellField>& shares, const Patch& to) {
  const Patch from = shares[0].patch();
  const Patch between{to.nx, from.ny, to.h, from.x0, from.y0};  // rows still those of before
  std::vector<CellField> wide(shares.size(), CellField(between)), result(shares.size(), CellField(to));
  std::vector<Line> in(shares.size(), Line(from.nx)), out(shares.size(), Line(to.nx));
  for (int j = 0; j < from.ny; ++j) {
    for (std::size_t f = 0; f < shares.size(); ++f) std::copy_n(shares[f].row(j), from.nx, in[f].begin());
    regrid_lines(in, out);
    for (std::size_t f = 0; f < shares.size(); ++f) std::copy(out[f].begin(), out[f].end(), wide[f].row(j));
  }
  in.assign(shares.size(), Line(from.ny));
  out.assign(shares.size(), Line(to.ny));
  for (int i = 0; i < to.nx; ++i) {
    for (std::size_t f = 0; f < shares.size(); ++f)
      for (int j = 0; j < from.ny; ++j) in[f][j] = wide[f](i, j);
    regrid_lines(in, out);
    for (std::size_t f = 0; f < shares.size(); ++f)
      for (int j = 0; j < to.ny; ++j) result[f](i, j) = out[f][j];
  }
  return result;
}

CellField regrid(const CellField& field, const Patch& to) {
  return std::move(regrid(std::vector{field}, to).front());
}

}  // namespace hourglass
