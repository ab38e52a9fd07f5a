#pragma once
// Reading of a YAML file that refuses what it does not know, and tells all that is wrong at once.
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/yaml_tree.hpp"

namespace hourglass {

/// A finite number and nothing else.
inline std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

class StrictReader {
 public:
  /// `kind` names the file in messages: "study".
  StrictReader(std::filesystem::path file, std::string kind)
      : file_(std::move(file)), kind_(std::move(kind)) {}

  const std::filesystem::path& file() const { return file_; }

  /// The map that the file is. Throws std::invalid_argument if it is none.
  YamlNode root();

  void say(int line, const std::string& key, const std::string& what);
  std::size_t said() const { return wrong_.size(); }
  /// Throws std::invalid_argument with all that was said, a line each, if something was.
  void refuse() const;

  /// Says which keys of a map are unknown or given twice; `below` is the path to it, with its dot.
  void known_keys(const YamlNode& map, const std::string& below, const std::vector<std::string>& allowed);
  void once(const YamlNode& map, const std::string& below);

  // Values of a map by key. What is missing and not optional, or of another kind, is said and stands for `other`.
  double number(const YamlNode& map, const std::string& below, const std::string& key,
                std::optional<double> other = {});
  std::string text(const YamlNode& map, const std::string& below, const std::string& key,
                   const std::optional<std::string>& other = {});
  /// One of the words.
  std::string word(const YamlNode& map, const std::string& below, const std::string& key,
                   const std::vector<std::string>& words, const std::optional<std::string>& other = {});
  std::vector<double> numbers(const YamlNode& map, const std::string& below, const std::string& key);
  /// Two numbers, the first the smaller.
  std::optional<std::array<double, 2>> interval(const YamlNode& map, const std::string& below,
                                                const std::string& key);

 private:
  std::filesystem::path file_;
  std::string kind_;
  std::vector<std::string> wrong_;
};

}  // namespace hourglass
