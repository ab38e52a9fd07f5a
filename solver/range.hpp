#pragma once
// Which numbers a key of a scene takes: the test and its words, from one definition.
#include <limits>
#include <string>

namespace hourglass {

/// All finite numbers unless it has ends; made by above(), at_least() and within().
struct Range {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  double low = -infinity, high = infinity;
  bool without_low = false, without_high = false;  ///< the ends themselves are not in it
  const char* note =
      "";  ///< what besides other keys, the grid or the kind of value ask of it; not tested here

  constexpr Range below(double end) const { return {low, end, without_low, true, note}; }
  constexpr Range at_most(double end) const { return {low, end, without_low, false, note}; }
  constexpr Range also(const char* words) const { return {low, high, without_low, without_high, words}; }

  constexpr bool has_ends() const { return low > -infinity; }
  /// False for what is not finite.
  constexpr bool holds(double x) const {
    return (without_low ? x > low : x >= low) && (without_high ? x < high : x <= high) && x > -infinity &&
           x < infinity;
  }
  /// "> 0", "0 to 8", "above 0, below 2"; "" without ends. The note is left out.
  std::string words() const;
};

constexpr Range above(double low) { return Range{.low = low, .without_low = true}; }
constexpr Range at_least(double low) { return Range{.low = low}; }
constexpr Range within(double low, double high) { return Range{.low = low, .high = high}; }
/// For check() to see to, with what else it knows.
constexpr Range noted(const char* words) { return Range{.note = words}; }

/// A number as short as people write it: 0.5, 1e-5, 1.643e6.
std::string written(double number);

}  // namespace hourglass
