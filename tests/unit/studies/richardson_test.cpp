#include "studies/richardson.hpp"

#include <catch2/catch.hpp>
#include <vector>

using namespace hourglass;

namespace {

/// limit + c h^order on n grids, each of half the cell size.
std::vector<double> sequence(double limit, double c, double order, int n) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(limit + c * std::pow(0.5, order * k));
  return values;
}

}  // namespace

TEST_CASE("Richardson: a power law is extrapolated exactly, at its own order") {
  for (const double order : {0.6, 1.0, 1.5, 2.0, 2.4})
    for (const double c : {-0.3, 0.2}) {
      const auto values = sequence(0.55, c, order, 3);
      const Richardson r = richardson(values);
      CHECK(r.value == Approx(0.55).epsilon(1e-12));
      CHECK(r.order == Approx(order).epsilon(1e-12));
      CHECK(r.error_bar ==
            Approx(1.25 * std::abs(values[2] - 0.55)).epsilon(1e-10));  // the grid convergence index
      CHECK(r.doubt.empty());
    }
  const auto thirds = std::vector{1 + 1.0, 1 + 1.0 / 9, 1 + 1.0 / 81};
  CHECK(richardson(thirds, 3).value == Approx(1).epsilon(1e-12));
  CHECK(richardson(thirds, 3).order == Approx(2).epsilon(1e-12));
}

TEST_CASE("Richardson: of more than three grids the finest three count") {
  std::vector<double> values = sequence(2, 0.1, 1.3, 3);
  const Richardson three = richardson(values);
  values.insert(values.begin(), 17);
  CHECK(richardson(values).value == three.value);
}

TEST_CASE("Richardson: two grids assume an order and a wide bar") {
  const auto values = sequence(0.55, 0.2, assumed_order, 2);
  const Richardson r = richardson(values);
  CHECK(r.value == Approx(0.55).epsilon(1e-12));
  CHECK(r.order == 1.5);
  CHECK(r.error_bar == Approx(3 * (values[1] - 0.55)).epsilon(1e-12));
  CHECK(r.doubt.empty());
}

TEST_CASE("Richardson: what cannot be trusted is said and gets three times the larger difference") {
  const Richardson to_and_fro = richardson(std::vector{1.0, 1.4, 1.3});
  CHECK(to_and_fro.value == 1.3);
  CHECK(to_and_fro.order == 0);
  CHECK(to_and_fro.error_bar == Approx(1.2));
  CHECK_FALSE(to_and_fro.doubt.empty());

  const Richardson slow = richardson(std::vector{1.0, 1.1, 1.19});  // order 0.15
  CHECK(slow.order == 0.5);
  CHECK(slow.value == Approx(1.19 + 0.09 / (std::sqrt(2.0) - 1)));
  CHECK(slow.error_bar == Approx(0.3));
  CHECK_FALSE(slow.doubt.empty());

  const Richardson fast = richardson(std::vector{1.0, 1.1, 1.101});  // order 6.6
  CHECK(fast.order == 2.5);
  CHECK(fast.error_bar == Approx(0.3));
  CHECK_FALSE(fast.doubt.empty());

  CHECK(richardson(std::vector{1.0, 1.1, 1.1}).order == 2.5);
  CHECK(richardson(std::vector{1.0, 1.0, 1.1}).order == 0.5);
}

TEST_CASE("Richardson: equal values leave no doubt, one is too few") {
  const Richardson r = richardson(std::vector{2.0, 2.0, 2.0});
  CHECK(r.value == 2);
  CHECK(r.error_bar == 0);
  CHECK(r.doubt.empty());
  CHECK_THROWS_AS(richardson(std::vector{2.0}), std::invalid_argument);
}
