#include "solver/range.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace hourglass {

std::string Range::words() const {
  if (!has_ends()) return "";
  if (high == infinity) return fmt::format("{} {}", without_low ? ">" : ">=", written(low));
  if (!without_low && !without_high) return fmt::format("{} to {}", written(low), written(high));
  return fmt::format("{} {}, {} {}", without_low ? "above" : "at least", written(low),
                     without_high ? "below" : "at most", written(high));
}

std::string written(double number) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::scientific).ptr;
  std::string scientific(text, end);
  if (const std::size_t e = scientific.find('e'); e != std::string::npos)
    scientific = fmt::format("{}e{}", scientific.substr(0, e), std::stoi(scientific.substr(e + 1)));
  const std::string plain = fmt::format("{}", number);
  const std::size_t worth = std::abs(number) < 1e5 ? 1 : 0;  // characters less than a plain number
  return scientific.size() + worth <= plain.size() ? scientific : plain;
}

}  // namespace hourglass
