#include "io/yaml_tree.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <numeric>
#include <optional>
#include <sstream>

namespace hourglass {

YamlNode::YamlNode() = default;
YamlNode::YamlNode(const YamlNode&) = default;
YamlNode::YamlNode(YamlNode&&) noexcept = default;
YamlNode& YamlNode::operator=(const YamlNode&) = default;
YamlNode& YamlNode::operator=(YamlNode&&) noexcept = default;
YamlNode::~YamlNode() = default;

namespace {

class TreeBuilder : public YAML::EventHandler {
 public:
  YamlNode root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(node(YamlNode::Kind::null, mark)); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw YamlError(mark.line + 1, "aliases (*name) are not used here. Write the value out.");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& value) override {
    refuse_tag(mark, tag);
    YamlNode n = node(YamlNode::Kind::scalar, mark);
    n.text = value;
    n.quoted = tag == "!";
    add(std::move(n));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open_.push_back({node(YamlNode::Kind::list, mark), {}, 0});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open_.push_back({node(YamlNode::Kind::map, mark), {}, 0});
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    std::optional<std::string> key;  // of a map: read, its value still to come
    int key_line;
  };

  static YamlNode node(YamlNode::Kind kind, const YAML::Mark& mark) {
    YamlNode n;
    n.kind = kind;
    n.line = mark.line + 1;
    return n;
  }
  static void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      throw YamlError(mark.line + 1, fmt::format("tags ({}) are not used here. Remove it.", shown(tag)));
  }
  void add(YamlNode n) {
    if (open_.empty()) {
      root = std::move(n);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::list) {
      parent.node.items.push_back(std::move(n));
    } else if (!parent.key) {
      if (n.kind != YamlNode::Kind::scalar) throw YamlError(n.line, "a key must be a plain word.");
      parent.key = std::move(n.text);
      parent.key_line = n.line;
    } else {
      n.line = parent.key_line;
      parent.node.keys.emplace_back(std::move(*parent.key), std::move(n));
      parent.key.reset();
    }
  }
  void close() {
    YamlNode done = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(done));
  }

  std::vector<Open> open_;
};

/// A list's item by its number; -1 if `key` is none.
int item_number(const std::string& key) {
  int n = -1;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), n);
  return error == std::errc() && end == key.data() + key.size() && n >= 0 ? n : -1;
}

constexpr std::size_t largest_file = 1 << 20;  // bytes; a scene is a page, so more is a mistake or an attack

/// yaml-cpp takes some tabs and answers others with errors far from the place.
void refuse_tabs_and_binary(const std::string& text) {
  int line = 1;
  bool indent = true, tab = false;
  for (const char c : text) {
    if (c == '\0') throw YamlError(line, "is not a text file.");
    if (c == '\n') {
      ++line;
      indent = true, tab = false;
    } else if (indent && c == '\t') {
      tab = true;
    } else if (indent && c != ' ' && c != '\r') {
      if (tab && c != '#') throw YamlError(line, "not valid YAML: a tab indents this line. Use spaces.");
      indent = false;
    }
  }
}

/// Letters to add, drop, replace or swap with their neighbour; case does not count.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> before, last, row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::move(last);
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + !same(a[i - 1], b[j - 1])});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const auto& [name, value] : keys)
    if (name == key) return &value;
  const int n = kind == Kind::list ? item_number(key) : -1;
  return n >= 0 && n < static_cast<int>(items.size()) ? &items[n] : nullptr;
}

std::string read_yaml_text(const std::filesystem::path& path, const std::string& kind) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw YamlError(0, fmt::format("is a folder, not a {} file.", kind));
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw YamlError(0, std::filesystem::exists(path, ignored) ? "cannot be opened. Check its permissions."
                                                              : "no such file. Check the path.");
  std::string text(largest_file + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > largest_file)
    throw YamlError(0, fmt::format("is larger than 1 MiB (a {} is a page or two).", kind));
  return text;
}

YamlNode parse_yaml(const std::string& text) {
  refuse_tabs_and_binary(text);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    TreeBuilder builder;
    if (!parser.HandleNextDocument(builder)) return {};
    TreeBuilder another;
    if (parser.HandleNextDocument(another))
      throw YamlError(another.root.line, "a second document begins here (---). Keep one.");
    return std::move(builder.root);
  } catch (const YAML::Exception& error) {
    throw YamlError(error.mark.is_null() ? 0 : error.mark.line + 1,
                    fmt::format("not valid YAML: {}.", shown(error.msg)));
  }
}

void assign(YamlNode& root, const std::string& path, YamlNode value) {
  YamlNode* at = &root;
  YamlNode origin;  // of what is added on the way
  origin.override_index = value.override_index;
  std::string walked;
  const std::vector<std::string> steps = split_path(path);
  if (std::find(steps.begin(), steps.end(), "") != steps.end())
    throw YamlError(0, "is not a dotted path (e.g. materials.sand.mu_s).");
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::string& step = steps[k];
    if (at->kind == YamlNode::Kind::null)
      at->kind = item_number(step) == 0 ? YamlNode::Kind::list : YamlNode::Kind::map;
    if (at->kind == YamlNode::Kind::scalar)
      throw YamlError(0, fmt::format("unknown key: {} is {}, which has no keys below it. Set it whole: --set "
                                     "'{}={{...}}'.",
                                     walked, what_is(*at), walked));
    if (at->kind == YamlNode::Kind::list) {
      const int n = item_number(step), size = static_cast<int>(at->items.size());
      if (n < 0 || n > size)
        throw YamlError(
            0, fmt::format("unknown key: {} is a list of {}; name an item by its number, from 0 (the "
                           "number {} adds one).",
                           walked, size, size));
      if (n == size) at->items.push_back(origin);
      at = &at->items[n];
    } else {
      std::size_t n = 0;
      while (n < at->keys.size() && at->keys[n].first != step) ++n;
      if (n == at->keys.size()) at->keys.emplace_back(step, origin);
      at = &at->keys[n].second;
    }
    walked += (k ? "." : "") + step;
  }
  *at = std::move(value);
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> steps{""};
  for (const char c : path) {
    if (c == '.')
      steps.emplace_back();
    else
      steps.back() += c;
  }
  return steps;
}

std::string what_is(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "nothing";
    case YamlNode::Kind::list:
      return "a list";
    case YamlNode::Kind::map:
      return "a map";
    case YamlNode::Kind::scalar:
      break;
  }
  double number = 0;
  const char *begin = node.text.data(), *end = begin + node.text.size();
  const auto [stop, error] = std::from_chars(begin, end, number);
  const bool is_number = !node.quoted && stop == end && error == std::errc();
  return is_number ? "the number " + shown(node.text) : fmt::format("the text '{}'", shown(node.text));
}

std::string shown(const std::string& text) {
  constexpr std::size_t most = 120;
  std::string out = text.substr(0, most);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  return text.size() > most ? out + "..." : out;
}

std::string nearest(const std::string& word, const std::vector<std::string>& words) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : words) {
    if (word.size() > candidate.size() + 10) continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least && distance < candidate.size()) least = distance, best = candidate;
  }
  return best;
}

}  // namespace hourglass
