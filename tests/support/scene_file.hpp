#pragma once
// A sound scene file, line by line, and what is said of it when it is changed.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/scene_yaml.hpp"

namespace hourglass {

namespace fs = std::filesystem;

inline const fs::path root =
    fs::path(__FILE__).parent_path().parent_path().parent_path();  ///< of the repository

/// A scene file that lives as long as the test.
class File {
 public:
  explicit File(const std::string& text)
      : path_(fs::temp_directory_path() / "hourglass_scene_test" / "bad.yaml") {
    fs::create_directories(path_.parent_path());
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~File() { fs::remove_all(path_.parent_path()); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

inline const std::vector<std::string> sound{
    "name: test",                                             // line 1
    "domain: {width: 150, height: 150}",                      // 2
    "grid: {cells_x: 128}",                                   // 3
    "materials:",                                             // 4
    "  sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}",         // 5
    "fill:",                                                  // 6
    "  - {material: sand, box: {x: [0, 150], y: [0, 135]}}",  // 7
    "orifices:",                                              // 8
    "  - {wall: bottom, centre: 75, width: 18.75}",           // 9
    "time: {end: 1}",                                         // 10
};

inline std::string sound_with(int line, const std::string& text) {
  std::string out;
  for (int k = 1; k <= static_cast<int>(sound.size()); ++k) out += (k == line ? text : sound[k - 1]) + "\n";
  return line > static_cast<int>(sound.size()) ? out + text + "\n" : out;
}

inline std::string messages(const Loaded& loaded) {
  std::string out;
  for (const Diagnostic& d : loaded.diagnostics) out += d.text() + "\n";
  return out;
}

/// Loads the sound scene with one line replaced (or one added as line 11); the one message must hold all parts.
inline void expect(int line, const std::string& text, const std::vector<std::string>& parts) {
  const File file(sound_with(line, text));
  const Loaded loaded = load_scene(file.path());
  INFO(text << "\n" << messages(loaded));
  REQUIRE(loaded.diagnostics.size() == 1);
  CHECK_FALSE(loaded.ok());
  for (const std::string& part : parts) CHECK_THAT(loaded.diagnostics[0].text(), Catch::Contains(part));
}

enum class Doubts { none, allowed };

/// The sound scene with this text and these overrides; what is written of it reads as the same scene.
inline Scene round_trip(const std::string& text, const std::vector<std::string>& overrides = {},
                        Doubts doubts = Doubts::none) {
  const File file(sound_with(11, text));
  const Loaded loaded = load_scene(file.path(), overrides);
  INFO(messages(loaded));
  CHECK(loaded.ok());
  if (doubts == Doubts::none) CHECK(loaded.diagnostics.empty());
  const File written(to_yaml(loaded.scene));
  const Loaded again = load_scene(written.path());
  INFO(messages(again));
  CHECK(again.scene == loaded.scene);
  return loaded.scene;
}

}  // namespace hourglass
