#pragma once
// What the pages of runs and of studies have in common; all of it is HTML.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/html.hpp"
#include "io/yaml_tree.hpp"
#include "solver/scene.hpp"
#include "studies/measured.hpp"

namespace hourglass {

/// How it ended: good, bad, or not yet.
enum class Ending { good, bad, open };

std::string status_html(Ending ending, const std::string& status, const std::string& reason);

/// "mass_error": "mass error"
std::string spaced(std::string words);

/// A number for readers and, as many digits as it has a right to, its error.
std::string value_text(double value, std::optional<double> error = {});

struct Card {
  std::string name, value, unit{};  ///< plain text
};
std::string cards_html(const std::vector<Card>& cards);

std::string charts_html(const std::vector<Chart>& charts);

/// The summary of a run by key; a key that it lacks, or null, is none.
class SummaryFile {
 public:
  /// Of a run folder. Throws std::runtime_error if it cannot be read.
  explicit SummaryFile(const std::filesystem::path& run);
  bool there() const { return !root_.keys.empty(); }
  const YamlNode* node(const std::string& key) const;
  std::string text(const std::string& key) const;  ///< empty: none
  std::optional<double> number(const std::string& key) const;

 private:
  YamlNode root_;
};

/// Which program made it, and where.
std::string provenance_html(const SummaryFile& summary);

/// How to make it again: commands, and the file that they need.
std::string again_html(const SummaryFile& summary, const std::string& command, const std::string& file,
                       const std::string& text);

/// Pictures of a run: of its stored frames, each field in one range of colours, or those that it drew itself; at most
/// `most` in all, the first and the last among them. Where neither can be had, none.
std::vector<Filmstrip> filmstrips(const std::filesystem::path& run, const Scene& scene, int most, int halved);

std::string run_report(const std::filesystem::path& run);
std::string study_report(const std::filesystem::path& folder);

}  // namespace hourglass
