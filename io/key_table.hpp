#pragma once
// The reference of keys in docs/scene.md, made of the table that reads, writes and checks them (solver/scene_keys.hpp),
// so that it cannot say anything else.
#include <string>
#include <vector>

#include "solver/scene_keys.hpp"

namespace hourglass {

struct KeyRow {
  std::string path;  ///< "orifices.width" of each orifice, "materials.NAME.mu_s" of each material
  std::string unit;
  std::string allowed;             ///< the range, or what is expected
  std::string by_default;          ///< "-": it must be given
  std::string meaning;             ///< Markdown
  Range range{};                   ///< without ends: nothing is checked by itself
  std::vector<std::string> words;  ///< the only ones; empty: it is no word
};

/// A row for each key that any scene can have, with the defaults that this one has.
std::vector<KeyRow> key_rows(const Scene& defaults = {});

/// As tables of Markdown: every key; and what the words of `accuracy` stand for.
std::string key_table();
std::string accuracy_table();

/// A page with what stands between its markers (<!-- keys --> or <!-- words of accuracy -->, and <!-- end -->) made anew.
/// Throws std::invalid_argument where a marker is missing.
std::string with_key_tables(std::string page);

}  // namespace hourglass
