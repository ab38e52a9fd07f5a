#include "io/scales.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

constexpr Colour not_a_number{255, 0, 255};

constexpr unsigned viridis[] = {0x440154, 0x470d60, 0x48186a, 0x482374, 0x472e7c, 0x453882, 0x424186,
                                0x3e4a89, 0x3a548c, 0x365d8d, 0x32658e, 0x2e6d8e, 0x2b758e, 0x287d8e,
                                0x25848e, 0x228c8d, 0x1f948c, 0x1e9c89, 0x20a386, 0x25ab82, 0x2eb37c,
                                0x3aba76, 0x48c16e, 0x58c765, 0x6ccd5a, 0x7fd34e, 0x93d741, 0xa8db34,
                                0xc0df25, 0xd5e21a, 0xeae51a, 0xfde725};
constexpr unsigned mixture[] = {0xfcd187, 0xf0c789, 0xe3bd8a, 0xd7b38b, 0xcba98b, 0xbe9f8c,
                                0xb2968c, 0xa68c8c, 0x99838d, 0x8c7a8d, 0x7f718c, 0x71688c,
                                0x63608c, 0x54578b, 0x434f8b, 0x2d478a, 0x053f8a};
constexpr unsigned signs[] = {0x2158a8, 0x4869b2, 0x657bbb, 0x7e8ec5, 0x96a1ce, 0xaeb5d8,
                              0xc5cae1, 0xdcdeea, 0xf3f3f3, 0xf0dbd2, 0xeac2b2, 0xe2aa93,
                              0xd99274, 0xce7a56, 0xc26239, 0xb44a1b, 0xa62f00};

std::span<const unsigned> points_of(ColourMap map) {
  if (map == ColourMap::viridis) return viridis;
  if (map == ColourMap::signs) return signs;
  return mixture;
}

std::string superscript(int n) {
  static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (const char c : std::to_string(n)) out += c == '-' ? "⁻" : digits[c - '0'];
  return out;
}

}  // namespace

std::array<double, 2> nice_range(double lo, double hi, bool log) {
  if (log) {
    if (!(lo <= hi && hi > 0)) return {std::pow(10.0, -log_decades), 1};
    return {std::clamp(lo, hi * std::pow(10.0, -log_decades), hi / 10), hi};
  }
  if (!(lo <= hi)) return {0, 1};
  if (lo < 0.2 * hi && lo > -0.02 * hi) return {0, hi};
  if (hi - lo > 1e-9 * std::max(std::abs(lo), std::abs(hi))) return {lo, hi};
  const double around = lo == 0 ? 0.5 : std::abs(lo) / 2;
  return {lo - around, lo + around};
}

ColourScale::ColourScale(std::array<double, 2> range, bool log, ColourMap map)
    : lo_(range[0]), hi_(range[1]), log_(log), points_(points_of(map)) {}

double ColourScale::position(double value) const {
  return log_ ? std::log(value / lo_) / std::log(hi_ / lo_) : (value - lo_) / (hi_ - lo_);
}

Colour ColourScale::colour_at(double position) const {
  const double s = std::clamp(position, 0.0, 1.0) * static_cast<double>(points_.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(s), points_.size() - 2);
  Colour out;
  for (int c = 0; c < 3; ++c) {
    const double a = points_[k] >> (16 - 8 * c) & 0xff, b = points_[k + 1] >> (16 - 8 * c) & 0xff;
    out[c] = static_cast<unsigned char>(std::lround(a + (s - static_cast<double>(k)) * (b - a)));
  }
  return out;
}

Colour ColourScale::colour_of(double value) const {
  if (std::isnan(value)) return not_a_number;
  return colour_at(log_ && value <= 0 ? 0 : position(value));
}

std::string number_text(double x, int digits) {
  const double size = std::abs(x);
  if (!std::isfinite(x)) return fmt::format("{}", x);
  std::string out;
  if (x == 0 || (size >= 1e-3 && size < 1e5)) {
    out = fmt::format("{:.{}g}", x, std::max(digits, size >= 1 ? static_cast<int>(std::log10(size)) + 1 : 1));
  } else {
    // The exponent comes from the rounded number: 9.99e5 at two digits is 10⁶.
    const std::string text = fmt::format("{:.{}e}", x, digits - 1);
    const std::size_t e = text.find('e');
    std::string mantissa = fmt::format("{:g}", std::stod(text.substr(0, e)));
    if (mantissa == "1" || mantissa == "-1") {
      mantissa.pop_back();
    } else {
      mantissa += "×";
    }
    out = mantissa + "10" + superscript(std::stoi(text.substr(e + 1)));
  }
  if (out[0] == '-') out.replace(0, 1, "−");
  return out;
}

std::vector<Tick> linear_ticks(double lo, double hi, int most) {
  const double least = (hi - lo) / std::max(most, 1), power = std::pow(10.0, std::floor(std::log10(least)));
  double step = 10 * power;
  for (const double s : {5.0, 2.0, 1.0}) {
    if (s * power >= least * (1 - 1e-9)) step = s * power;
  }
  std::vector<Tick> ticks;
  const long first = std::lround(std::ceil(lo / step - 1e-6)),
             last = std::lround(std::floor(hi / step + 1e-6));
  for (long k = first; k <= last; ++k) {
    const double value = static_cast<double>(k) * step;
    ticks.push_back({value, number_text(value)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(double lo, double hi) {
  std::vector<Tick> ticks;
  const bool narrow = hi / lo < 30;
  for (int e = static_cast<int>(std::floor(std::log10(lo))); e <= std::log10(hi) + 1e-9; ++e) {
    for (int m = 1; m < 10; ++m) {
      const double value = m * std::pow(10.0, e);
      if (value < lo * (1 - 1e-9) || value > hi * (1 + 1e-9)) continue;
      const bool labelled = m == 1 || (narrow && (m == 2 || m == 5));
      ticks.push_back({value, !labelled ? "" : narrow ? number_text(value) : "10" + superscript(e)});
    }
  }
  return ticks;
}

}  // namespace hourglass
