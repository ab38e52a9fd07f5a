// Formulas of studies: a finite number, or FormulaError.
#include <cmath>

#include "fuzz/scratch.hpp"
#include "studies/formula.hpp"

using namespace hourglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string formula = fuzz::text_of(data, size);
  try {
    for (const std::string& name : names_in(formula)) FUZZ_REQUIRE(is_formula_name(name));
    FUZZ_REQUIRE(std::isfinite(value_of(formula, {{"gap", 2.5}, {"mu_s", 0.62}, {"orifices.0.width", 9}})));
  } catch (const FormulaError& error) {
    FUZZ_REQUIRE(*error.what());
  }
  return 0;
}
