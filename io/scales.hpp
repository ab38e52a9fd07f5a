#pragma once
// What a picture or a plot says with colours and numbers: ranges, colour maps, ticks, number labels.
#include <array>
#include <span>
#include <string>
#include <vector>

namespace hourglass {

using Colour = std::array<unsigned char, 3>;

enum class ColourMap {
  viridis,  ///< perceptually uniform; S. van der Walt & N. Smith 2015, public domain (CC0)
  mixture,  ///< sand to blue at even steps of CIE lightness: which of two materials
  signs     ///< blue over nearly white to red, lightness even on both sides of the middle: which sign
};

/// A log scale reaches down this far from its largest value unless told otherwise.
inline constexpr double log_decades = 5;

/// A range to show values that lie between lo and hi: from 0 if lo is nearly there, on a log scale at least
/// one and at most log_decades decades, around the value if there is only one, and some range if there is
/// none (lo > hi).
std::array<double, 2> nice_range(double lo, double hi, bool log);

class ColourScale {
 public:
  /// range: lo < hi, and 0 < lo on a log scale.
  ColourScale(std::array<double, 2> range, bool log, ColourMap map);

  /// Where a value lies in the range: 0 at its low end, 1 at its high end.
  double position(double value) const;
  Colour colour_at(double position) const;
  /// Beyond the range, the colour of its end; NaN is magenta.
  Colour colour_of(double value) const;
  double lo() const { return lo_; }
  double hi() const { return hi_; }
  bool log() const { return log_; }

 private:
  double lo_, hi_;
  bool log_;
  std::span<const unsigned> points_;
};

/// Plain between 1e-3 and 1e5, otherwise as 1.6×10⁶; with at most so many digits.
std::string number_text(double x, int digits = 6);

struct Tick {
  double value;
  std::string label;  ///< empty: a minor tick
};

/// At multiples of 1, 2 or 5 times a power of ten; `most` intervals at most.
std::vector<Tick> linear_ticks(double lo, double hi, int most);
/// Decades, with minor ticks between; 2s and 5s are labelled too when there is hardly a decade.
std::vector<Tick> log_ticks(double lo, double hi);

}  // namespace hourglass
