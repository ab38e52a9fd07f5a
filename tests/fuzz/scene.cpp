// Scene files, with overrides: lines after one of "%%" are --set. What loads must survive a round trip.
#include "fuzz/scratch.hpp"
#include "io/scene_yaml.hpp"

using namespace hourglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  std::string text = fuzz::text_of(data, size);
  std::vector<std::string> sets;
  if (const std::size_t at = text.find("\n%%\n"); at != std::string::npos) {
    std::string rest = text.substr(at + 4);
    text.resize(at + 1);
    for (std::size_t end; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1))
      sets.push_back(rest.substr(0, end));
  }
  const Loaded loaded = load_scene(scratch.write("scene.yaml", text), sets);
  for (const Diagnostic& d : loaded.diagnostics) FUZZ_REQUIRE(!d.text().empty());
  if (loaded.ok()) {
    const Loaded again = load_scene(scratch.write("again.yaml", to_yaml(loaded.scene)));
    FUZZ_REQUIRE(again.ok() && again.scene == loaded.scene);
  }
  return 0;
}
