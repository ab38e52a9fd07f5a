// Study files over a sound scene, base.yaml.
#include <stdexcept>

#include "fuzz/scratch.hpp"
#include "io/scene_yaml.hpp"
#include "studies/study.hpp"

using namespace hourglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  static const auto base =
      scratch.write("base.yaml",
                    "domain: {width: 40, height: 40}\ngrid: {cells_x: 16}\nmaterials: {sand: {}}\n"
                    "fill: [{material: sand, box: {x: [0, 40], y: [0, 30]}}]\n"
                    "orifices: [{centre: 20, width: 20}]\ntime: {end: 1}\n");
  try {
    const Study study = read_study(scratch.write("study.yaml", fuzz::text_of(data, size)));
    std::size_t runs = 1;
    for (const auto& group : study.groups)
      runs *= study.axes[static_cast<std::size_t>(group.front())].values.size();
    if (runs > 50) return 0;  // each is a scene of its own to load, which takes time and finds nothing new
    std::vector<std::string> warnings;
    for (const StudyRun& run : runs_of(study, warnings))
      for (const Problem& problem : check(run.scene)) FUZZ_REQUIRE(!problem.fatal);
  } catch (const std::invalid_argument& error) {
    FUZZ_REQUIRE(*error.what());
  }
  return 0;
}
