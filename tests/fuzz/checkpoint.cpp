// checkpoint.h5 of a run folder, damaged and sealed again: refused with words, or a run that goes on from it. A text is a
// list of damages to a good checkpoint: three bytes say where, one what is flipped there.
#include <fstream>
#include <iterator>

#include "fuzz/scratch.hpp"
#include "io/checkpoint.hpp"
#include "io/run_folder.hpp"
#include "io/scene_yaml.hpp"
#include "support/make_scene.hpp"

using namespace hourglass;
namespace fs = std::filesystem;

namespace {

Scene small_scene(long steps) {
  Scene scene = silo(8, 0);
  scene.name = "fuzz";
  scene.cells_x = 16;
  scene.orifices[0].width = 75;
  scene.nonlocal = Nonlocal{};
  scene.dilatancy = Dilatancy{};
  scene.output.series_every = scene.output.fields_every = 0.1;
  scene.output.snapshots_every = 0;
  scene.time.max_steps = steps;
  scene.threads = 1;
  return scene;
}

void run(const Scene& scene, const fs::path& out, Archive* from) {
  RunFolder folder(scene, to_yaml(scene), {.out = out, .force = true, .quiet = true, .from = from});
  folder.finish(Simulation(scene).run({&folder}, from));
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A run of three steps in a folder, and its checkpoint without the seal.
struct Begun {
  fuzz::Scratch scratch;
  fs::path run_folder = scratch.folder() / "run";
  std::string checkpoint;
  Begun() {
    run(small_scene(3), run_folder, nullptr);
    checkpoint = bytes_of(run_folder / checkpoint_name);
    fs::remove(run_folder / previous_checkpoint_name);
    checkpoint.resize(checkpoint.size() - seal_length);
    fs::copy(run_folder, scratch.folder() / "good");
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Begun begun;
  std::string damaged = begun.checkpoint;
  for (std::size_t k = 0; k + 3 < size; k += 4)
    damaged[(data[k] | data[k + 1] << 8 | data[k + 2] << 16) % damaged.size()] ^=
        static_cast<char>(data[k + 3]);
  fs::remove_all(begun.run_folder);
  fs::copy(begun.scratch.folder() / "good", begun.run_folder);
  const fs::path path = begun.scratch.write(fs::path("run") / checkpoint_name, damaged);
  seal(path);
  try {
    const Scene scene = small_scene(4);
    const Resumption found = resume(begun.run_folder, scene);
    FUZZ_REQUIRE(found.done || found.from);
    if (found.from) run(scene, begun.run_folder, found.from->state.get());
  } catch (const std::exception& error) {
    FUZZ_REQUIRE(*error.what() && damaged != begun.checkpoint);
  }
  return 0;
}
