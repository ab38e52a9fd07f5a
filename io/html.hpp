#pragma once
// One HTML page in one file: no network, no library. Light and dark, on paper and on a phone.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/chart.hpp"

namespace hourglass {

/// Text as it stands between tags and in attributes in quotes, of HTML and of XML.
std::string html_text(std::string_view text);

std::string base64(std::string_view bytes);

/// A whole page around what stands in its body, with its own style and script.
std::string html_page(const std::string& title, const std::string& body);

/// A chart as a figure with vectors; the value under the pointer is told.
std::string svg_figure(const Chart& chart);

/// A picture within the page; `more`: further attributes, each with a space behind it.
std::string html_image(std::string_view png, const std::string& alt, const std::string& more = {});

/// A table that scrolls by itself where it is too wide. Cells are HTML; the first row is the head, the first column names
/// the row.
std::string html_table(const std::vector<std::vector<std::string>>& rows);

/// Names and what they stand for, plain text; on a narrow page one below the other.
std::string html_pairs(const std::vector<std::pair<std::string, std::string>>& rows);

/// Pictures of one field over time.
struct Filmstrip {
  std::string name;                   ///< of the field, for its button
  std::vector<std::string> captions;  ///< of each picture: "t = 5.48 √(d/g)"
  std::vector<std::string> pngs;      ///< bytes of files
};
/// One picture at a time with a slider, buttons and the keyboard; the last one at first. Fields with the same number of
/// pictures keep their place when another is chosen.
std::string html_viewer(const std::vector<Filmstrip>& strips);

}  // namespace hourglass
