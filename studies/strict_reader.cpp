#include "studies/strict_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace hourglass {

using Kind = YamlNode::Kind;

YamlNode StrictReader::root() {
  YamlNode root;
  try {
    root = parse_yaml(read_yaml_text(file_, kind_));
  } catch (const YamlError& error) {
    say(error.line, "", error.what());
    refuse();
  }
  if (root.kind != Kind::map) {
    say(root.line, "", fmt::format("found {} (expected a {}: a map of its keys).", what_is(root), kind_));
    refuse();
  }
  return root;
}

void StrictReader::say(int line, const std::string& key, const std::string& what) {
  wrong_.push_back(fmt::format("{}{}{}{}: {}", file_.string(), line > 0 ? fmt::format(":{}", line) : "",
                               key.empty() ? "" : " ", key, what));
}

void StrictReader::refuse() const {
  if (!wrong_.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(wrong_, "\n")));
}

void StrictReader::known_keys(const YamlNode& map, const std::string& below,
                              const std::vector<std::string>& allowed) {
  for (const auto& [key, value] : map.keys) {
    if (std::ranges::count(allowed, key) > 0) continue;
    const std::string meant = nearest(key, allowed);
    say(value.line, below + shown(key),
        fmt::format("unknown key (allowed: {}).{}", fmt::join(allowed, ", "),
                    meant.empty() ? " Remove it." : fmt::format(" Did you mean '{}'?", meant)));
  }
  once(map, below);
}

void StrictReader::once(const YamlNode& map, const std::string& below) {
  for (std::size_t k = 0; k < map.keys.size(); ++k)
    for (std::size_t i = 0; i < k; ++i)
      if (map.keys[i].first == map.keys[k].first)
        say(map.keys[k].second.line, below + shown(map.keys[k].first), "is given twice. Keep one.");
}

double StrictReader::number(const YamlNode& map, const std::string& below, const std::string& key,
                            std::optional<double> other) {
  const YamlNode* at = map.find(key);
  if (!at && other) return *other;
  const auto value = at && at->kind == Kind::scalar ? number_in(at->text) : std::nullopt;
  if (!value)
    say(at ? at->line : map.line, below + key,
        fmt::format("{} (expected a number).", at ? "found " + what_is(*at) : "is missing"));
  return value.value_or(0);
}

std::string StrictReader::text(const YamlNode& map, const std::string& below, const std::string& key,
                               const std::optional<std::string>& other) {
  const YamlNode* at = map.find(key);
  if (!at && other) return *other;
  if (at && at->kind == Kind::scalar && !at->text.empty()) return at->text;
  say(at ? at->line : map.line, below + key,
      fmt::format("{} (expected a text).", at ? "found " + what_is(*at) : "is missing"));
  return {};
}

std::string StrictReader::word(const YamlNode& map, const std::string& below, const std::string& key,
                               const std::vector<std::string>& words,
                               const std::optional<std::string>& other) {
  const std::size_t before = said();
  std::string found = text(map, below, key, other);
  if (said() == before && std::ranges::count(words, found) == 0) {
    const std::string meant = nearest(found, words);
    say(map.find(key)->line, below + key,
        fmt::format("found '{}' (allowed: {}).{}", shown(found), fmt::join(words, ", "),
                    meant.empty() ? "" : fmt::format(" Did you mean '{}'?", meant)));
  }
  return found;
}

std::vector<double> StrictReader::numbers(const YamlNode& map, const std::string& below,
                                          const std::string& key) {
  const YamlNode* at = map.find(key);
  std::vector<double> values;
  const auto add = [&](const YamlNode& item) {
    const auto value = item.kind == Kind::scalar ? number_in(item.text) : std::nullopt;
    if (value)
      values.push_back(*value);
    else
      say(item.line, below + key, fmt::format("found {} (expected a number).", what_is(item)));
  };
  if (at && at->kind == Kind::scalar) add(*at);
  if (at && at->kind == Kind::list) std::ranges::for_each(at->items, add);
  if (!at || at->kind == Kind::map || (at->kind == Kind::list && at->items.empty()))
    say(at ? at->line : map.line, below + key,
        fmt::format("{} (expected a number or a list of them).",
                    at ? "found " + what_is(*at) : "is missing"));
  return values;
}

std::optional<std::array<double, 2>> StrictReader::interval(const YamlNode& map, const std::string& below,
                                                            const std::string& key) {
  const YamlNode* at = map.find(key);
  if (!at) return std::nullopt;
  const std::vector<double> ends = numbers(map, below, key);
  if (ends.size() == 2 && ends[0] < ends[1]) return std::array{ends[0], ends[1]};
  say(at->line, below + key, "is no interval (expected two numbers, [least, greatest]).");
  return std::nullopt;
}

}  // namespace hourglass
