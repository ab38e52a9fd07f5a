#include "studies/takes.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "solver/diagnostics.hpp"
#include "tests/support/make_scene.hpp"

using namespace hourglass;

namespace {

std::vector<TablePoint> points(std::initializer_list<double> y) {
  std::vector<TablePoint> out;
  for (const double value : y) out.push_back({double(out.size()), value, nullptr});
  return out;
}
double take_of(const std::string& word, std::initializer_list<double> y) { return take(word, points(y)); }

}  // namespace

TEST_CASE("takes of one point and of the size of several") {
  CHECK(take_of("only", {3}) == 3);
  CHECK(std::isnan(take_of("only", {3, 4})));
  CHECK(take_of("mean", {1, 2, 6}) == 3);
  CHECK(take_of("min", {4, 2, 6}) == 2);
  CHECK(take_of("max", {4, 2, 6}) == 6);
  CHECK(take_of("spread", {1, 2, 6}) == Approx(5.0 / 3));
  CHECK(take_of("last_change", {1, 3, 4}) == 0.25);
  for (const std::string& word : take_words) CHECK(std::isnan(take_of(word, {})));
  CHECK(std::isnan(take_of("mean", {1, NAN})));
  CHECK_THROWS_AS(take("mode", points({1})), std::invalid_argument);
}

TEST_CASE("steps against a direction count over the mean size") {
  CHECK(take_of("largest_rise", {4, 2, 3, 3}) == Approx(1 / 3.0));
  CHECK(take_of("largest_fall", {4, 2, 3, 3}) == Approx(2 / 3.0));
  CHECK(take_of("largest_rise", {4, 3, 1}) == 0);
}

TEST_CASE("a dip is as deep as the lower of its sides") {
  CHECK(take_of("dip", {10, 8, 9}) == Approx(9.0 / 8 - 1));
  CHECK(take_of("dip", {9, 8, 10}) == Approx(9.0 / 8 - 1));
  CHECK(take_of("dip_at", {10, 9, 5, 8, 9}) == 2);
  CHECK(take_of("dip", {10, 9, 8, 7}) == 0);
  CHECK(take_of("dip", {7, 8, 9}) == 0);
  CHECK(std::isnan(take_of("dip_at", {10, 9, 8, 7})));
}

TEST_CASE("observed order of errors that fall by 4 with each halving of the cells is 2") {
  std::vector<TablePoint> p;
  for (const double cells : {32, 64, 128, 256})
    p.push_back({cells, 7 - 3 * std::pow(64 / cells, 2), nullptr});
  CHECK(take("order", p) == Approx(2));
}

TEST_CASE("the law of Beverloo comes back from rates that obey it") {
  constexpr double C = 1.2, k = 1.5;
  std::vector<Scene> scenes;
  for (const double width : {5.0, 8.0, 12.0, 20.0, 30.0}) scenes.push_back(silo(64, 0, 75, width));
  std::vector<TablePoint> p;
  for (const Scene& scene : scenes) {
    const double width = scene.orifices[0].width;
    p.push_back({width, C * std::pow(width - k, 1.5), &scene});
  }
  CHECK(take("beverloo_C", p) == Approx(C));
  CHECK(take("beverloo_k", p) == Approx(k));
  CHECK(take("beverloo_k_interval", p) < 1e-6);
  CHECK(take("beverloo_misfit", p) < 1e-9);
  CHECK(take("beverloo_misfit_k0", p) > 0.02);
}
