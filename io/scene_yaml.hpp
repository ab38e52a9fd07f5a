#pragma once
// Scene files: YAML in, Scene out, and back. docs/scene.md lists the keys.
#include <filesystem>
#include <string>
#include <vector>

#include "solver/scene.hpp"

namespace hourglass {

/// A thing wrong with a scene file, and where.
struct Diagnostic {
  std::string place;    ///< "silo.yaml:14", or "--set path=value" if an override brought it in
  std::string path;     ///< dotted path of the key; empty if the file as a whole is meant
  std::string message;  ///< what is wrong (what is allowed). cure
  bool fatal = true;    ///< false: a warning

  /// "silo.yaml:14 materials.sand.I_0: 0 is out of range (must be > 0). Glass beads have about 0.28."
  std::string text() const;
};

struct Loaded {
  Scene scene;  ///< to be run only if ok()
  std::vector<Diagnostic> diagnostics;
  std::vector<std::string> notes;  ///< what the file left open and was chosen for it

  bool ok() const;  ///< no diagnostic is fatal
};

/// Reads a scene with `path=value` overrides on top and checks it (check() included). Never throws on bad
/// input: everything that is wrong is in the diagnostics, in the order of the file.
Loaded load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// The scene with every default written out; loads back to an equal scene.
std::string to_yaml(const Scene& scene);

}  // namespace hourglass
