#pragma once
// Largest magnitudes of rows.
#include <bit>
#include <cstdint>
#include <type_traits>

namespace hourglass {

/// max |x[i]|, NaN if any is NaN. Magnitudes are compared as integers: the bit patterns of non-negative
/// numbers are ordered, NaN is above all, and unlike a maximum of floating-point numbers this one is a vector
/// instruction.
template <class T>
double max_magnitude(const T* __restrict x, int n) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  Bits m = 0;
#pragma omp simd reduction(max : m)
  for (int i = 0; i < n; ++i) {
    const Bits bits = std::bit_cast<Bits>(x[i]) & (~Bits(0) >> 1);
    m = bits > m ? bits : m;
  }
  return static_cast<double>(std::bit_cast<T>(m));
}

}  // namespace hourglass
