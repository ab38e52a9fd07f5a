#pragma once
// Orders of convergence, asserted and not only drawn.
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <vector>

namespace hourglass {

/// log2 of the ratio of errors on successive grids, each twice as fine as the one before.
inline std::vector<double> orders(const std::vector<double>& errors) {
  std::vector<double> out;
  for (std::size_t k = 1; k < errors.size(); ++k) out.push_back(std::log2(errors[k - 1] / errors[k]));
  return out;
}

inline std::string listed(const std::vector<double>& values) {
  std::ostringstream out;
  out.precision(4);
  for (double v : values) out << v << ' ';
  return out.str();
}

/// The order between the two finest grids is `order` to within `tolerance`.
inline void expect_order(const std::vector<double>& errors, double order, double tolerance) {
  INFO("errors " << listed(errors) << " orders " << listed(orders(errors)));
  CHECK(orders(errors).back() == Approx(order).margin(tolerance));
}

}  // namespace hourglass
