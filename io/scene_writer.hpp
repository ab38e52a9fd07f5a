#pragma once
// The visitor of solver/scene_keys.hpp that writes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "solver/scene_keys.hpp"

namespace hourglass {

/// Writes every key of a scene, in block style.
class SceneWriter {
 public:
  std::string out;

  void text(const char* key, const std::string& value, const Key&) { line(key, quoted(value)); }
  void number(const char* key, double value, const Key&) { line(key, fmt::format("{}", value)); }
  void number(const char* key, const std::optional<double>& value, const Key& about) {
    if (value) number(key, *value, about);
  }
  void integer(const char* key, long value, const Key&) { line(key, fmt::format("{}", value)); }
  void integer_or(const char*, const char* key, long value, const Key& about) { integer(key, value, about); }
  void pair(const char* key, const std::array<double, 2>& value, const Key&) { line(key, point(value)); }
  void texts(const char* key, const std::vector<std::string>& values, const Key&) {
    std::vector<std::string> words;
    for (const std::string& value : values) words.push_back(quoted(value));
    line(key, fmt::format("[{}]", fmt::join(words, ", ")));
  }
  template <class Enum, std::size_t n>
  bool choice(const char* key, Enum value, const std::array<const char*, n>& words, const Key&) {
    line(key, words[static_cast<int>(value)]);
    return true;
  }
  template <std::size_t n>
  bool word(const char*, int&, const std::array<const char*, n>&) {
    return false;
  }
  template <class... Rest>
  void preset(const Rest&...) {}  // its parts are written
  template <class Body>
  void map(const char* key, Body&& body) {
    line(key, "");
    indent_ += 2;
    const std::size_t before = out.size();
    body();
    indent_ -= 2;
    if (out.size() == before) out.insert(before - 1, " {}");
  }
  template <class T, class Body>
  void module(const char* key, std::optional<T>& value, Body&& body) {
    if (value) map(key, [&] { body(*value); });
  }
  template <class T, class Body>
  void list(const char* key, std::vector<T>& values, const char*, Body&& body) {
    line(key, values.empty() ? "[]" : "");
    for (T& value : values) {
      indent_ += 4;
      const std::size_t before = out.size();
      body(value);
      out[before + indent_ - 2] = '-';
      indent_ -= 4;
    }
  }
  template <class T, class Body>
  void named(const char* key, std::vector<T>& values, const char*, Body&& body) {
    map(key, [&] {
      for (T& value : values) map(value.name.c_str(), [&] { body(value); });
    });
  }
  void material(const char* key, int index, const std::vector<Material>& materials, const Key&) {
    line(key, index < 0 ? "air" : materials[index].name);
  }
  void shape(const std::vector<std::array<double, 2>>& p, const Key&, const Key&) {
    if (p.size() == 4 && p[0][1] == p[1][1] && p[1][0] == p[2][0] && p[2][1] == p[3][1] &&
        p[3][0] == p[0][0] && p[0][0] < p[1][0] && p[1][1] < p[2][1]) {
      line("box", fmt::format("{{x: {}, y: {}}}", point({p[0][0], p[1][0]}), point({p[1][1], p[2][1]})));
      return;
    }
    line("polygon", fmt::format("{{points: {}}}", listed(p)));
  }
  void points(const char* key, const std::vector<std::array<double, 2>>& p, const Key&) {
    line(key, listed(p));
  }
  bool has(const char*) { return false; }  // alternatives are not written
  void skip(std::initializer_list<const char*>) {}
  void foreign(std::initializer_list<const char*>) {}

 private:
  void line(const char* key, const std::string& value) {
    out += fmt::format("{:{}}{}:{}{}\n", "", indent_, key, value.empty() ? "" : " ", value);
  }
  static std::string point(const std::array<double, 2>& p) { return fmt::format("[{}, {}]", p[0], p[1]); }
  static std::string listed(const std::vector<std::array<double, 2>>& p) {
    std::vector<std::string> points;
    for (const auto& corner : p) points.push_back(point(corner));
    return fmt::format("[{}]", fmt::join(points, ", "));
  }
  static std::string quoted(const std::string& value) {
    const bool plain = !value.empty() && std::all_of(value.begin(), value.end(), [](unsigned char c) {
      return std::isalnum(c) || c == '_';
    });
    if (plain && !std::isdigit(static_cast<unsigned char>(value[0])) && value != "null" && value != "Null" &&
        value != "NULL")
      return value;
    std::string out_text = "'";
    for (const char c : value) out_text += c == '\'' ? "''" : std::string(1, c);
    return out_text + "'";
  }

  int indent_ = 0;
};

}  // namespace hourglass
