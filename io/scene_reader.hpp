#pragma once
// The visitor of solver/scene_keys.hpp that reads: strict about keys, types and words, and patient: it notes
// everything that does not fit and goes on.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/yaml_tree.hpp"
#include "solver/scene_keys.hpp"

namespace hourglass {

/// A value that cannot be read becomes NaN,
/// so that check() says nothing more about what depends on it.
class SceneReader {
 public:
  using Kind = YamlNode::Kind;
  struct Finding {
    const YamlNode* node;  // where
    std::string path, message;
    bool value_lost = true;  // the scene holds NaN or a default instead
  };

  explicit SceneReader(const YamlNode& root) { levels_.push_back({&root, &root, "", {}, {}, true}); }

  void text(const char* key, std::string& value, const Key&) {
    const YamlNode* node = child(key);
    if (!node) return;
    if (node->kind != Kind::scalar) return wrong_type(*node, key, "a text");
    value = node->text;
  }

  void number(const char* key, double& value, const Key& about) {
    const YamlNode* node = child(key, about.missing);
    if (node || about.missing) value = std::numeric_limits<double>::quiet_NaN();
    if (node)
      read_number(*node, join(here().path, key), value);
    else if (about.multiple && here().sound)
      unscaled.push_back({join(here().path, key), value, about.multiple->scale});
  }
  void number(const char* key, std::optional<double>& value, const Key&) {
    if (const YamlNode* node = child(key)) value = 0, read_number(*node, join(here().path, key), *value);
  }

  template <class Integer>
  void integer(const char* key, Integer& value, const Key&) {
    const YamlNode* node = child(key);
    if (node) value = 0;
    double read = 0;
    if (!node || !read_number(*node, join(here().path, key), read, "a whole number")) return;
    if (read != std::floor(read))
      report(*node, key, fmt::format("{} is not a whole number.", shown(node->text)));
    else if (std::abs(read) > 1e9)
      report(*node, key, fmt::format("{} is out of range (at most 1e9).", shown(node->text)));
    else
      value = static_cast<Integer>(read);
  }

  /// Or this word, which leaves the value as it is.
  template <class Integer>
  void integer_or(const char* word, const char* key, Integer& value, const Key& about) {
    const YamlNode* node = here().node ? here().node->find(key) : nullptr;
    if (node && node->kind == Kind::scalar && node->text == word)
      child(key);
    else
      integer(key, value, about);
  }

  void pair(const char* key, std::array<double, 2>& value, const Key& about) {
    const YamlNode* node = child(key, about.missing);
    if (node) read_pair(*node, join(here().path, key), value);
  }

  void texts(const char* key, std::vector<std::string>& values, const Key&) {
    const YamlNode* node = child(key);
    if (!node) return;
    values.clear();
    if (node->kind != Kind::list) return wrong_type(*node, key, "a list of texts, e.g. [speed, pressure]");
    for (std::size_t k = 0; k < node->items.size(); ++k) {
      const YamlNode& item = node->items[k];
      if (item.kind != Kind::scalar) wrong_type(item, fmt::format("{}.{}", key, k), "a text");
      values.push_back(item.text);
    }
  }

  /// One of the words; says whether it was one.
  template <class Enum, std::size_t n>
  bool choice(const char* key, Enum& value, const std::array<const char*, n>& words, const Key& about) {
    const YamlNode* node = child(key, about.missing);
    const int index = node ? read_word(*node, key, {words.begin(), words.end()}) : -1;
    if (index < 0) return false;
    value = static_cast<Enum>(index);
    return true;
  }
  /// Whether a single word stands where there could be a map; `index` is -1 if it is none of the words.
  template <std::size_t n>
  bool word(const char* key, int& index, const std::array<const char*, n>& words) {
    const YamlNode* node = here().node ? here().node->find(key) : nullptr;
    if (!node || node->kind != Kind::scalar) return false;
    child(key);
    index = read_word(*node, key, {words.begin(), words.end()}, ", or a map");
    return true;
  }

  /// A word that stands for a whole value, whose parts later keys may change.
  template <class T, std::size_t n>
  void preset(const char* key, T& value, const std::array<const char*, n>& words,
              const std::array<T, n>& values, const Key&) {
    const YamlNode* node = child(key);
    const int index = node ? read_word(*node, key, {words.begin(), words.end()}) : -1;
    if (index >= 0) value = values[index];
  }

  template <class Body>
  void map(const char* key, Body&& body, bool missed = true) {
    const YamlNode* node = child(key);
    const bool is_map = node && node->kind == Kind::map, sound = is_map || !node || node->kind == Kind::null;
    levels_.push_back({is_map ? node : nullptr,
                       node ? node : here().place,
                       join(here().path, key),
                       {},
                       {},
                       sound && missed});
    body();
    const std::vector<std::string> known = here().known;
    leave();
    if (!sound) wrong_type(*node, key, "a map with " + listed(known));
  }

  /// A block that switches something on by being there, even if empty.
  template <class T, class Body>
  void module(const char* key, std::optional<T>& value, Body&& body) {
    const YamlNode* node = here().node ? here().node->find(key) : nullptr;
    T unused;  // an absent block's keys are known all the same, and not missed
    if (node) value.emplace();
    map(
        key, [&] { body(node ? *value : unused); }, node);
  }

  template <class T, class Body>
  void list(const char* key, std::vector<T>& values, const char* required, Body&& body) {
    const YamlNode* node = child(key, required);
    if (!node) return;
    values.clear();
    if (node->kind == Kind::null) return;
    if (node->kind != Kind::list) return wrong_type(*node, key, "a list, each item of which begins with '-'");
    for (std::size_t k = 0; k < node->items.size(); ++k) {
      values.emplace_back();
      enter_item(node->items[k], join(here().path, fmt::format("{}.{}", key, k)),
                 [&] { body(values.back()); });
    }
  }

  template <class T, class Body>
  void named(const char* key, std::vector<T>& values, const char* required, Body&& body) {
    const YamlNode* node = child(key, required);
    values.clear();
    if (!node || node->kind == Kind::null) return;
    if (node->kind != Kind::map) return wrong_type(*node, key, "a map of names, e.g. sand: {mu_s: 0.62}");
    std::vector<std::string> names;
    for (const auto& [name, item] : node->keys) {
      if (contains(names, name)) continue;  // finish() reports it
      names.push_back(name);
      values.emplace_back();
      values.back().name = name;
      enter_item(item, join(join(here().path, key), name), [&] { body(values.back()); });
    }
  }

  void material(const char* key, int& index, const std::vector<Material>& materials, const Key& about) {
    const YamlNode* node = child(key, about.missing);
    if (!node) return;
    std::vector<std::string> names{"air"};
    for (const Material& m : materials) names.push_back(m.name);
    const int found = read_word(*node, key, names);
    if (found >= 0) index = found - 1;
  }

  void shape(std::vector<std::array<double, 2>>& points, const Key& in_box, const Key& in_polygon) {
    const YamlNode *box = child("box"), *polygon = child("polygon");
    if (!here().node) return;
    if (!box == !polygon) {
      findings.push_back(
          {here().place, here().path,
           fmt::format("has {} (exactly one of box, polygon). E.g. box: {{x: [0, 150], y: [0, 135]}}.",
                       box ? "both box and polygon" : "no shape")});
      return;
    }
    if (box) {
      std::array<double, 2> x{NAN, NAN}, y{NAN, NAN};
      map("box", [&] {
        pair("x", x, in_box.required("from and to, e.g. [0, 150]"));
        pair("y", y, in_box.required("from and to, e.g. [0, 135]"));
        for (const auto& [key, range] : {std::pair{"x", x}, std::pair{"y", y}})
          if (range[0] >= range[1])
            report(
                *here().node->find(key), key,
                fmt::format("[{}, {}] is empty (the first must be below the second).", range[0], range[1]));
      });
      points = {{x[0], y[0]}, {x[1], y[0]}, {x[1], y[1]}, {x[0], y[1]}};
    } else {
      map("polygon", [&] { this->points("points", points, in_polygon); });
    }
  }

  void points(const char* key, std::vector<std::array<double, 2>>& values, const Key&) {
    const YamlNode* node = child(key, "its corners in order, e.g. [[0, 0], [10, 0], [5, 8]]");
    if (!node) return;
    if (node->kind != Kind::list)
      return wrong_type(*node, key, "a list of points, e.g. [[0, 0], [10, 0], [5, 8]]");
    for (std::size_t k = 0; k < node->items.size(); ++k)
      read_pair(node->items[k], join(here().path, fmt::format("{}.{}", key, k)), values.emplace_back());
  }

  bool has(const char* key) { return here().node && here().node->find(key); }

  /// Keys that nothing can be said about, nor about what they would have set.
  void skip(std::initializer_list<const char*> keys) {
    ignore(keys);
    skipped.push_back(here().path);
  }
  /// Keys of other shapes, if they are not those of this one.
  void foreign(std::initializer_list<const char*> keys) {
    ignore(keys);
    for (const char* key : keys)
      if (has(key) && !contains(here().known, key))
        report(*here().node->find(key), key,
               fmt::format("does not belong to a {} (which has {}). Remove it.",
                           here().node->find("shape")->text, listed(here().known)));
  }

  /// Call last: unknown keys, with what they were meant to be, and keys given twice.
  void finish(const YamlNode& root) {
    leave();
    for (const Unknown& u : unknown_) {
      const std::string key = u.path.substr(u.path.rfind('.') + 1), near = nearest(key, u.allowed);
      const auto elsewhere =
          std::find_if(known_paths_.begin(), known_paths_.end(),
                       [&](const std::string& path) { return key.size() > 1 && path.ends_with("." + key); });
      const std::string meant = !near.empty() ? near : elsewhere != known_paths_.end() ? *elsewhere : "";
      findings.push_back({u.node, u.path,
                          meant.empty() ? fmt::format("unknown key (allowed here: {}).", listed(u.allowed))
                                        : fmt::format("unknown key. Did you mean '{}'?", meant),
                          false});
    }
    find_duplicates(root, "");
  }

  /// A number that the scene has and the file does not give: its default, to be multiplied by a scale.
  struct Unscaled {
    std::string path;
    double& value;
    double Scales::*scale;
  };

  std::vector<Finding> findings;
  std::vector<Unscaled> unscaled;
  std::vector<std::string> skipped;  ///< paths of maps that were not read

 private:
  struct Level {
    const YamlNode* node;   // null: absent or not a map
    const YamlNode* place;  // the nearest that is there
    std::string path;
    std::vector<std::string> known, ignored;
    bool sound;  // false: already reported, what it should hold is not missed
  };
  struct Unknown {
    const YamlNode* node;
    std::string path;
    std::vector<std::string> allowed;
  };

  Level& here() { return levels_.back(); }

  void ignore(std::initializer_list<const char*> keys) {
    here().ignored.insert(here().ignored.end(), keys.begin(), keys.end());
  }

  void report(const YamlNode& node, const std::string& key, std::string message) {
    findings.push_back({&node, join(here().path, key), std::move(message)});
  }
  void wrong_type(const YamlNode& node, const std::string& key, const std::string& expected) {
    report(node, key, fmt::format("found {} (expected {}).", what_is(node), expected));
  }

  const YamlNode* child(const char* key, const char* required = nullptr) {
    here().known.push_back(key);
    known_paths_.push_back(join(here().path, key));
    const YamlNode* node = here().node ? here().node->find(key) : nullptr;
    if (!node && required && here().sound)
      report(*here().place, key, fmt::format("is missing ({}).", required));
    return node;
  }

  void leave() {
    if (here().node)
      for (const auto& [key, node] : here().node->keys)
        if (!contains(here().known, key) && !contains(here().ignored, key))
          unknown_.push_back({&node, join(here().path, key), here().known});
    levels_.pop_back();
  }
  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }
  static std::string listed(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
  }
  static bool contains(const std::vector<std::string>& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }

  template <class Body>
  void enter_item(const YamlNode& item, const std::string& path, Body&& body) {
    const bool is_map = item.kind == Kind::map;
    levels_.push_back({is_map ? &item : nullptr, &item, path, {}, {}, is_map || item.kind == Kind::null});
    body();
    const std::vector<std::string> known = here().known;
    const bool sound = here().sound;
    leave();
    if (!sound)
      findings.push_back(
          {&item, path, fmt::format("found {} (expected a map with {}).", what_is(item), listed(known))});
  }

  bool read_number(const YamlNode& node, const std::string& path, double& value,
                   const char* expected = "a number") {
    value = std::numeric_limits<double>::quiet_NaN();
    const bool plus = node.text.size() > 1 && node.text[0] == '+' && node.text[1] != '-';
    const char *begin = node.text.data() + plus, *end = node.text.data() + node.text.size();
    double read = 0;
    const auto [stop, error] = std::from_chars(begin, end, read);
    std::string lower;
    for (const char* c = begin; c < end; ++c)
      lower += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
    const bool not_finite = lower == ".nan" || lower == ".inf" || lower == "-.inf" || !std::isfinite(read);
    std::string message;
    if (node.kind == Kind::scalar && !node.quoted && (not_finite || (stop == end && error != std::errc())))
      message = fmt::format("{} is not a finite number.", shown(node.text));
    else if (node.kind != Kind::scalar || node.quoted || stop != end || error != std::errc())
      message = fmt::format("found {} (expected {}).{}", what_is(node), expected,
                            node.quoted ? " Remove the quotes." : "");
    if (message.empty()) {
      value = read;
      return true;
    }
    findings.push_back({&node, path, std::move(message)});
    return false;
  }

  void read_pair(const YamlNode& node, const std::string& path, std::array<double, 2>& value) {
    value.fill(std::numeric_limits<double>::quiet_NaN());
    if (node.kind != Kind::list || node.items.size() != 2) {
      const std::string found =
          node.kind == Kind::list ? fmt::format("a list of {}", node.items.size()) : what_is(node);
      findings.push_back(
          {&node, path, fmt::format("found {} (expected two numbers, e.g. [0, 150]).", found)});
      return;
    }
    for (int k = 0; k < 2; ++k) read_number(node.items[k], fmt::format("{}.{}", path, k), value[k]);
  }

  int read_word(const YamlNode& node, const char* key, const std::vector<std::string>& words,
                const char* or_else = "") {
    const auto found = std::find(words.begin(), words.end(), node.text);
    if (node.kind == Kind::scalar && found != words.end()) return static_cast<int>(found - words.begin());
    const std::string near = node.kind == Kind::scalar ? nearest(node.text, words) : "";
    report(node, key,
           fmt::format("found {} (allowed: {}{}).{}", what_is(node), listed(words), or_else,
                       near.empty() ? "" : fmt::format(" Did you mean '{}'?", near)));
    return -1;
  }

  void find_duplicates(const YamlNode& node, const std::string& path) {
    for (std::size_t k = 0; k < node.items.size(); ++k)
      find_duplicates(node.items[k], join(path, std::to_string(k)));
    std::vector<std::pair<std::string, std::size_t>>
        sorted;  // equal keys side by side, in the order of the file
    for (std::size_t k = 0; k < node.keys.size(); ++k) {
      sorted.emplace_back(node.keys[k].first, k);
      find_duplicates(node.keys[k].second, join(path, node.keys[k].first));
    }
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 1; k < sorted.size(); ++k)
      if (sorted[k].first == sorted[k - 1].first)
        findings.push_back({&node.keys[sorted[k].second].second, join(path, sorted[k].first),
                            fmt::format("is given twice, first on line {}. Keep one.",
                                        node.keys[sorted[k - 1].second].second.line),
                            false});
  }

  std::vector<Level> levels_;
  std::vector<Unknown> unknown_;
  std::vector<std::string> known_paths_;
};

}  // namespace hourglass
