#pragma once
// Formulas of a study: arithmetic of named numbers, and nothing else. Our own recursive descent, for a formula is input
// that strangers write: it reads no files, calls nothing, and its depth is limited.
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace hourglass {

/// What is wrong with a formula, what is allowed and the cure; the words name the column.
struct FormulaError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Whether a word may name an axis: letters, digits, _ and dots, the first a letter or _; none of the functions.
bool is_formula_name(const std::string& word);

/// + - * / ^ (to the right first, before a sign in front of it: -2^2 = -4), parentheses, numbers, names, min, max of one
/// or more, abs, sqrt.
/// Throws FormulaError where it is none, where a name is not among the values, or where the result is no finite number.
double value_of(const std::string& formula, const std::map<std::string, double>& values);

/// The names in a formula. Throws FormulaError where it is none.
std::set<std::string> names_in(const std::string& formula);

}  // namespace hourglass
