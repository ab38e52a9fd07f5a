#pragma once

namespace hourglass {

/// Width of the vectors that the engine which runs was compiled for [bits].
int simd_bits();

}  // namespace hourglass
