#include "solver/range.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace hourglass;

TEST_CASE("a range: its ends, and its words") {
  const auto ends = [](const Range& range, double low, double high) {
    return std::array{range.holds(std::nextafter(low, -INFINITY)),
                      range.holds(low),
                      range.holds(std::nextafter(low, INFINITY)),
                      range.holds(std::nextafter(high, -INFINITY)),
                      range.holds(high),
                      range.holds(std::nextafter(high, INFINITY))};
  };
  CHECK(ends(within(1, 8), 1, 8) == std::array{false, true, true, true, true, false});
  CHECK(ends(above(1).below(8), 1, 8) == std::array{false, false, true, true, false, false});
  CHECK(ends(above(1).at_most(8), 1, 8) == std::array{false, false, true, true, true, false});
  CHECK(ends(at_least(1).below(8), 1, 8) == std::array{false, true, true, true, false, false});
  CHECK(above(0).holds(1e300));
  CHECK_FALSE(above(0).holds(0));
  CHECK(at_least(0).holds(0));
  for (const double x : {double(NAN), double(INFINITY), -double(INFINITY)}) {
    CHECK_FALSE(Range{}.holds(x));
    CHECK_FALSE(above(0).holds(x));
    CHECK_FALSE(within(0, 1).holds(x));
  }
  CHECK(Range{}.holds(-1e300));

  CHECK(above(0).words() == "> 0");
  CHECK(at_least(2).words() == ">= 2");
  CHECK(within(0, 1e6).words() == "0 to 1e6");
  CHECK(above(0).below(2).words() == "above 0, below 2");
  CHECK(above(0).at_most(0.5).words() == "above 0, at most 0.5");
  CHECK(at_least(0).below(2).words() == "at least 0, below 2");
  CHECK(above(0).also("whole").words() == "> 0");
  CHECK(above(0).has_ends());
  CHECK_FALSE(noted("> eta_min").has_ends());
  CHECK(noted("> eta_min").words().empty());
}

TEST_CASE("numbers as people write them") {
  for (const auto& [number, words] : {std::pair{0.0, "0"},
                                      {1.0, "1"},
                                      {-150.0, "-150"},
                                      {0.5, "0.5"},
                                      {0.0548, "0.0548"},
                                      {1024.0, "1024"},
                                      {1e6, "1e6"},
                                      {1.643e6, "1.643e6"},
                                      {1e-3, "1e-3"},
                                      {3e-6, "3e-6"},
                                      {0.01, "0.01"},
                                      {0.1 + 0.2, "0.30000000000000004"}})
    CHECK(written(number) == words);
}
