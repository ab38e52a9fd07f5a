#pragma once
// A study: one scene over axes of parameters. docs/studies.md lists the keys of its file.
#include <filesystem>
#include <string>
#include <vector>

#include "io/yaml_tree.hpp"
#include "solver/scene.hpp"
#include "studies/strict_reader.hpp"

namespace hourglass {

/// A key of the scene that differs between runs, or from the base scene.
struct StudySetting {
  std::string path;  ///< dotted
  std::string text;  ///< a formula of the axes, or YAML
  bool is_formula = true;
  int line = 0;
};

struct StudyAxis {
  std::string name;
  std::vector<std::string> values;  ///< as written: numbers, or words
  int line = 0;                     ///< in the file
  /// Of named cases: what each value sets. Empty for an axis that formulas name.
  std::vector<std::vector<StudySetting>> cases{};
};

struct Study {
  std::filesystem::path file;
  std::string name;
  std::filesystem::path scene;
  std::vector<StudyAxis> axes;
  /// Axes that advance together, by number; the last group changes from run to run.
  std::vector<std::vector<int>> groups;
  std::vector<StudySetting> settings;
  bool keep_fields = false, keep_snapshots = false;
};

struct StudyRun {
  std::string name;                 ///< its number from 1, of at least four digits
  std::vector<std::string> values;  ///< by axis
  Scene scene;

  /// "gap=2 mu_s=0.62"
  std::string text(const Study& study) const;
};

/// Throws std::invalid_argument, a line for each thing that is wrong: file, line, key, what is allowed, the cure.
Study read_study(const std::filesystem::path& file);

/// Its keys at the top of the file.
inline const std::vector<std::string> study_keys{"name", "scene", "axes", "cases", "paired", "set", "keep"};

/// The study within a file that says more: its other keys are not looked at, and it may have no axis, hence one run. Throws
/// as read_study(), with what the reader was told before.
Study study_in(const YamlNode& root, StrictReader& strict);

/// Every run with its scene, all checked. Throws std::invalid_argument as read_study() does, naming the runs. Adds to
/// `warnings` what is doubtful about the scenes.
std::vector<StudyRun> runs_of(const Study& study, std::vector<std::string>& warnings);

}  // namespace hourglass
