#pragma once
// JSON, written by hand: the few shapes that summary.json and its like need.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hourglass {

inline std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// Shortest digits that read back to the same double; null for what JSON has no word for (NaN, infinity).
inline std::string json_number(double x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; }
inline std::string json_number(long x) { return fmt::format("{}", x); }

/// Names with values that are JSON already.
using JsonMembers = std::vector<std::pair<std::string, std::string>>;

/// One member a line; lines after the first are indented by `indent` spaces.
inline std::string json_object(const JsonMembers& members, int indent = 0) {
  if (members.empty()) return "{}";
  std::string out = "{\n";
  for (const auto& [name, value] : members) {
    out += fmt::format("{:{}}  {}: {},\n", "", indent, json_string(name), value);
  }
  out.erase(out.size() - 2, 1);  // the last comma
  return out + std::string(indent, ' ') + '}';
}

inline std::string json_array(const std::vector<std::string>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

}  // namespace hourglass
