#pragma once
// Random numbers in fields; the same in every run.
#include <cmath>
#include <random>

#include "kernels/velocity.hpp"

namespace hourglass {

class Noise {
 public:
  explicit Noise(unsigned seed = 1) : engine_(seed) {}
  double operator()(double low = -1, double high = 1) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0;
  }
  /// Spread evenly in the logarithm over [low, high].
  double logarithmic(double low, double high) { return low * std::pow(high / low, (*this)(0, 1)); }

 private:
  std::mt19937 engine_;  // its values are fixed by the standard, those of distributions are not
};

/// Fills the interior; halos stay.
template <At where, class T>
void fill_random(Field<where, T>& f, Noise& noise, double low = -1, double high = 1) {
  for (int j = 0; j < f.ny(); ++j)
    for (int i = 0; i < f.nx(); ++i) f(i, j) = static_cast<T>(noise(low, high));
}
template <class T>
void fill_random(VelocityOf<T>& w, Noise& noise, double low = -1, double high = 1) {
  fill_random(w.u, noise, low, high);
  fill_random(w.v, noise, low, high);
}

/// a . b over all points; where periodic, xface(nx) repeats xface(0) and is left out.
template <class Unknown>
double inner_product(const Unknown& a, const Unknown& b, bool periodic = false) {
  double sum = 0;
  for (int k = 0; k < row_count(a); ++k) {
    const auto x = row_of(a, k), y = row_of(b, k);
    const int n = periodic ? a.patch().nx : x.n;
    for (int i = 0; i < n; ++i) sum += static_cast<double>(x.data[i]) * static_cast<double>(y.data[i]);
  }
  return sum;
}

}  // namespace hourglass
