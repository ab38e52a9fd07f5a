#pragma once
// A YAML text as a plain tree that remembers lines and keeps duplicate keys, which yaml-cpp's own nodes do
// not. Scenes and studies need no aliases and no tags, so both are refused.
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hourglass {

struct YamlNode {
  enum class Kind { null, scalar, list, map };

  Kind kind = Kind::null;
  std::string text;     ///< of a scalar
  bool quoted = false;  ///< a scalar in quotes is text, whatever it looks like
  int line = 0;         ///< in the file, of the key if there is one; 0 if `override_index` tells the origin
  int override_index = -1;
  std::vector<YamlNode> items;                         ///< of a list
  std::vector<std::pair<std::string, YamlNode>> keys;  ///< of a map, in the order of the text

  // Defined where the type is complete, as its vector of pairs of itself needs.
  YamlNode();
  YamlNode(const YamlNode&);
  YamlNode(YamlNode&&) noexcept;
  YamlNode& operator=(const YamlNode&);
  YamlNode& operator=(YamlNode&&) noexcept;
  ~YamlNode();

  /// A map's value or, for a number, a list's item; nullptr if there is none.
  const YamlNode* find(const std::string& key) const;
};

struct YamlError : std::runtime_error {
  YamlError(int at, const std::string& what) : std::runtime_error(what), line(at) {}
  int line;  ///< in the text, from 1; 0 if unknown
};

/// The text of a scene or study; `kind` names it in messages. Throws YamlError if there is none, or too much of it.
std::string read_yaml_text(const std::filesystem::path& path, const std::string& kind);

/// Throws YamlError on anything that is not one plain YAML document.
YamlNode parse_yaml(const std::string& text);

/// Puts `value` at a dotted path, adding maps, and items at the end of lists, on the way. Throws YamlError if
/// a step of the path leads nowhere.
void assign(YamlNode& root, const std::string& path, YamlNode value);

/// "domain.width" -> {"domain", "width"}
std::vector<std::string> split_path(const std::string& path);

/// What a node is, for messages: "the number 5", "the text 'abc'", "a list", "a map", "nothing".
std::string what_is(const YamlNode& node);

/// A short form of a text that is safe to print.
std::string shown(const std::string& text);

/// The word nearest to `word` by edit distance, if it is near enough to be what was meant; else empty.
std::string nearest(const std::string& word, const std::vector<std::string>& words);

}  // namespace hourglass
