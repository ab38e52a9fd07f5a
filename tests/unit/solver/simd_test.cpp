#include "solver/simd.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>

TEST_CASE("the engine has the vectors that were asked for") {  // by tests/portable_test.sh
  const char* asked = std::getenv("HOURGLASS_SIMD");
  CHECK(hourglass::simd_bits() >= (asked ? std::atoi(asked) : 128));
  CHECK(hourglass::simd_bits() <= (asked ? std::atoi(asked) : 512));
}
