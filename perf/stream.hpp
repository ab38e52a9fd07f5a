#pragma once
// The triad of STREAM (McCalpin 1995), the measure of what memory gives: 24 B an element. What a store reads
// first is not counted, here as in the kernels.
#include <cstddef>
#include <vector>

#include "kernels/team.hpp"

namespace hourglass {

class Triad {
 public:
  /// Three arrays of `bytes` in all; no less than a page each.
  explicit Triad(double bytes)
      : n_(std::max(512, static_cast<int>(bytes / 24))), a_(n_), b_(n_, 1.0), c_(n_, 2.0) {}

  void run(Team& team) {
    const Rows part = team.rows(n_);
    double* __restrict a = a_.data();
    const double *b = b_.data(), *c = c_.data();
#pragma omp simd
    for (int i = part.begin; i < part.end; ++i) a[i] = b[i] + 3.0 * c[i];
  }
  double bytes() const { return 24.0 * n_; }
  bool right() const { return a_.front() == 7 && a_.back() == 7; }

 private:
  int n_;
  std::vector<double> a_, b_, c_;
};

}  // namespace hourglass
