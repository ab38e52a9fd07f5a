#pragma once
// Largest magnitudes of rows.
#include <bit>
#include <cstdint>

namespace hourglass {

/// max |x[i]|, NaN if any is NaN. Magnitudes are compared as integers: the bit patterns of non-negative
/// numbers are ordered, NaN is above all, and unlike a maximum of floating-point numbers this one is a vector
/// instruction.
inline double max_magnitude(const float* __restrict x, int n) {
  std::uint32_t m = 0;
#pragma omp simd reduction(max : m)
  for (int i = 0; i < n; ++i) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x[i]) & 0x7fffffffu;
    m = bits > m ? bits : m;
  }
  return static_cast<double>(std::bit_cast<float>(m));
}
inline double max_magnitude(const double* __restrict x, int n) {
  std::uint64_t m = 0;
#pragma omp simd reduction(max : m)
  for (int i = 0; i < n; ++i) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x[i]) & 0x7fffffffffffffffu;
    m = bits > m ? bits : m;
  }
  return std::bit_cast<double>(m);
}

}  // namespace hourglass
