#include "io/key_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include "solver/simulation.hpp"

namespace hourglass {
namespace {

/// The visitor of solver/scene_keys.hpp that notes what there is, whether the scene has it or not.
class KeyLister : public KeyVisitor {
 public:
  std::vector<KeyRow> rows;

  void text(const char* key, const std::string& value, const Key& about) {
    add(key, about, about.range.note, value.empty() ? "-" : value);
  }
  void texts(const char* key, const std::vector<std::string>& values, const Key& about) {
    std::vector<std::string> names;
    for (const FieldInfo& field : known_fields())
      names.push_back(field.module ? fmt::format("{} ({})", field.name, field.module) : field.name);
    add(key, about, fmt::format("list of {}", fmt::join(names, ", ")),
        fmt::format("[{}]", fmt::join(values, ", ")));
  }
  void number(const char* key, double value, const Key& about) {
    std::string by_default = written(value);
    if (about.multiple) by_default = (value == 1 ? "" : by_default + " ") + about.multiple->words;
    add_number(key, about, by_default);
  }
  void number(const char* key, const std::optional<double>&, const Key& about) {
    add_number(key, about, "-");
  }
  void integer(const char* key, long value, const Key& about) {
    add_number(key, about, std::to_string(value));
  }
  void integer_or(const char* word, const char* key, long, const Key& about) {
    add_number(key, about, word);
    rows.back().allowed += std::string(", or ") + word;
  }
  void pair(const char* key, const std::array<double, 2>& value, const Key& about) {
    add(key, about, about.range.note, fmt::format("[{}]", fmt::join(value, ", ")));
  }
  void points(const char* key, const std::vector<std::array<double, 2>>&, const Key& about) {
    add(key, about, about.range.note, "-");
  }
  void material(const char* key, int, const std::vector<Material>&, const Key& about) {
    add(key, about, about.range.note, "-");
  }
  void shape(const std::vector<std::array<double, 2>>& corners, const Key& in_box, const Key& in_polygon) {
    for (const char* key : {"box.x", "box.y"}) points(key, corners, in_box);
    points("polygon.points", corners, in_polygon);
  }
  template <class Enum, std::size_t n>
  bool choice(const char* key, Enum value, const std::array<const char*, n>& words, const Key& about) {
    add_words(key, words, words[static_cast<std::size_t>(value)], about);
    return true;
  }
  template <class T, std::size_t n>
  void preset(const char* key, const T&, const std::array<const char*, n>& words, const std::array<T, n>&,
              const Key& about) {
    add_words(key, words, "", about);
  }

  void map(const char* key, auto&& body) {
    const std::string before = path_;
    (path_ += key) += '.';
    body();
    path_ = before;
  }
  template <class T>
  void module(const char* key, const std::optional<T>& value, auto&& body) {
    T one = value.value_or(T{});
    map(key, [&] { body(one); });
  }
  template <class T>
  void list(const char* key, const std::vector<T>&, const char*, auto&& body) {
    map(key, [&] {
      T one;
      body(one);
    });
  }
  void list(const char* key, const std::vector<Insert>&, const char*, auto&& body) {
    map(key, [&] {  // one after another, these have all keys
      for (const Shape shape : {Shape::rectangle, Shape::circle, Shape::polygon}) {
        Insert one{.shape = shape, .points = {}};
        body(one);
      }
    });
  }
  template <class T>
  void named(const char* key, const std::vector<T>&, const char*, auto&& body) {
    map(key, [&] {
      T one;
      map("NAME", [&] { body(one); });
    });
  }

 private:
  void add(const char* key, const Key& about, std::string allowed, std::string by_default,
           std::vector<std::string> words = {}) {
    const std::string path = path_ + key;
    if (std::any_of(rows.begin(), rows.end(), [&](const KeyRow& row) { return row.path == path; })) return;
    if (about.default_text) by_default = about.default_text;
    if (about.missing) by_default = "-";
    rows.push_back({path, about.unit, std::move(allowed), std::move(by_default), about.meaning, about.range,
                    std::move(words)});
  }
  void add_number(const char* key, const Key& about, std::string by_default) {
    const std::string range = about.range.words(), note = about.range.note;
    add(key, about, range + (range.empty() || note.empty() ? "" : ", ") + note, std::move(by_default));
  }
  template <std::size_t n>
  void add_words(const char* key, const std::array<const char*, n>& words, const char* by_default,
                 const Key& about) {
    add(key, about, fmt::format("{}", fmt::join(words, ", ")), by_default, {words.begin(), words.end()});
  }

  std::string path_;  // of what is being walked, with a dot behind
};

/// A row of a table; what is under the first row of it says that it is one.
std::string line(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out += cell.empty() ? " |" : " " + cell + " |";
  return out + "\n";
}
std::string head(const std::vector<std::string>& cells) {
  std::string rule = "|";
  for (std::size_t k = 0; k < cells.size(); ++k) rule += "---|";
  return line(cells) + rule + "\n";
}

}  // namespace

std::vector<KeyRow> key_rows(const Scene& defaults) {
  KeyLister lister;
  Scene scene = defaults;
  visit_scene(lister, scene);
  return lister.rows;
}

std::string key_table() {
  std::string table = head({"key", "unit", "range", "default", "meaning"});
  Scene SI;
  SI.units = Units::SI;
  const std::vector<KeyRow> rows = key_rows(), in_SI = key_rows(SI);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const KeyRow& row = rows[k];
    const bool not_in_SI = row.by_default != "-" && in_SI[k].by_default == "-";
    table += line({"`" + row.path + "`", row.unit, row.allowed, row.by_default + (not_in_SI ? "; SI: -" : ""),
                   row.meaning});
  }
  return table;
}

std::string accuracy_table() {
  std::vector<std::vector<KeyRow>> of_word;
  for (const Accuracy& preset : accuracy_presets) {
    Scene scene;
    scene.accuracy = preset;
    of_word.push_back(key_rows(scene));
  }
  std::vector<std::string> names{"word"};
  std::vector<std::vector<std::string>> lines;
  for (const char* word : accuracy_names) lines.push_back({word});
  for (std::size_t k = 0; k < of_word[0].size(); ++k) {
    const auto differs = [&](const auto& rows) { return rows[k].by_default != of_word[0][k].by_default; };
    if (std::none_of(of_word.begin(), of_word.end(), differs)) continue;
    names.push_back(of_word[0][k].path.substr(of_word[0][k].path.find('.') + 1));
    for (std::size_t word = 0; word < lines.size(); ++word)
      lines[word].push_back(of_word[word][k].by_default);
  }
  std::string table = head(names);
  for (const auto& cells : lines) table += line(cells);
  return table;
}

std::string with_key_tables(std::string page) {
  const auto renew = [&](const std::string& marker, const std::string& table) {
    const std::size_t begin = page.find(marker), end = page.find("<!-- end -->", begin);
    if (begin == std::string::npos || end == std::string::npos)
      throw std::invalid_argument(fmt::format("no {} with an <!-- end --> after it.", marker));
    const std::size_t from = begin + marker.size();
    page.replace(from, end - from, "\n\n" + table + "\n");
  };
  renew("<!-- keys -->", key_table());
  renew("<!-- words of accuracy -->", accuracy_table());
  return page;
}

}  // namespace hourglass
