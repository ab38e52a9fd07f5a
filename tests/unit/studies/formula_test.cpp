#include "studies/formula.hpp"

#include <catch2/catch.hpp>

using namespace hourglass;
using Catch::Contains;

TEST_CASE("formulas: arithmetic in the usual order, exactly") {
  const std::map<std::string, double> axes{{"gap", 2.5}, {"W", 9.375}, {"orifices.0.width", 4}};
  const auto value = [&](const char* formula) { return value_of(formula, axes); };
  CHECK(value("1 + 2 * 3") == 7);
  CHECK(value("(1 + 2) * 3") == 9);
  CHECK(value("7 - 2 - 1") == 4);
  CHECK(value("12 / 3 / 2") == 2);
  CHECK(value("2 ^ 3 ^ 2") == 512);
  CHECK(value("-2 ^ 2") == -4);
  CHECK(value("2 ^ -1") == 0.5);
  CHECK(value("--3 - +1") == 2);
  CHECK(value("1.5e1*2") == 30);
  CHECK(value("75 - (W + gap)/2") == 75 - (9.375 + 2.5) / 2);
  CHECK(value("min(gap, W, 1) + max(gap, W)") == 10.375);
  CHECK(value("abs(gap - W) * sqrt(16)") == 27.5);
  CHECK(value("orifices.0.width / 2") == 2);
  CHECK(names_in("75 - (W + gap)/2 + min(gap, x)") == std::set<std::string>{"W", "gap", "x"});
}

TEST_CASE("formulas: what is wrong, and where") {
  const auto refuses = [](const std::string& formula, const char* why) {
    INFO(formula);
    CHECK_THROWS_WITH(value_of(formula, {{"gap", 2}, {"width", 3}}), Contains(why));
  };
  refuses("", "column 1: a number or name is missing");
  refuses("1 +", "column 4: a number or name is missing");
  refuses("(1 + 2", "column 7: a ) is missing");
  refuses("1 + 2)", "column 6: a ) closes nothing");
  refuses("1 2", "column 3: an operator is missing");
  refuses("1 + $", "column 5: '$' cannot stand here");
  refuses("gpa + 1", "'gpa' is no axis with numbers (there are: gap, width). Did you mean 'gap'?");
  refuses("sin(gap)", "'sin' is no function (allowed: min, max, abs, sqrt)");
  refuses("abs(1, 2)", "abs takes one value, here are 2");
  refuses("sqrt 2", "sqrt needs its values in parentheses");
  refuses("1 / (gap - 2)", "no finite number");
  refuses("sqrt(-gap)", "no finite number");
  refuses(std::string(100000, '('), "nested deeper than 50");
  refuses(std::string(100000, '-') + "1", "nested deeper than 50");
}
