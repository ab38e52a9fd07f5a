#include "solver/simd.hpp"

namespace hourglass {

int simd_bits() {
#if defined(__AVX512F__)
  return 512;
#elif defined(__AVX__)
  return 256;
#else
  return 128;  // SSE2, NEON
#endif
}

}  // namespace hourglass
