#include "io/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/xdmf.hpp"

namespace hourglass {
namespace {

struct StoredFrame {
  FieldReader reader;
  int frame = 0;
};

/// Names of the fields that a state is made of, beside the velocity, which is always stored. The second of two materials
/// is the field `tracer`; of more each is stored by itself.
std::vector<std::string> needed_fields(const Scene& scene) {
  std::vector<std::string> names{"grains", "pressure"};
  if (scene.materials.size() == 2) names.push_back("tracer");
  for (std::size_t k = 1; k < scene.materials.size() && scene.materials.size() > 2; ++k)
    names.push_back(fmt::format("tracer_{}", k));
  if (scene.dilatancy) names.push_back("packing");
  return names;
}

[[noreturn]] void refuse(const std::string& why) { throw std::runtime_error(why); }

StoredFrame find_frame(const Scene& scene) {
  const Start& start = *scene.start;
  if (start.run.empty()) refuse("needs run, the folder of a stored run");
  StoredFrame found{FieldReader(start.run)};
  const RunInfo& info = found.reader.info();
  const Patch& patch = info.patch;
  const double width = patch.nx * patch.h, height = patch.ny * patch.h;
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); };
  if (!same(width, scene.width) || !same(height, scene.height))
    refuse(fmt::format(
        "{} is a run of a domain of {:.9g} x {:.9g}, not of {:.9g} x {:.9g}; the grid may differ, the "
        "domain must be the same",
        start.run, width, height, scene.width, scene.height));
  if (info.symmetry != scene.symmetry || info.coordinates != scene.coordinates)
    refuse(fmt::format("{} is a run with other symmetry or coordinates; they must be the same", start.run));
  std::vector<std::string> materials;
  for (const Material& m : scene.materials) materials.push_back(m.name);
  if (info.materials != materials)
    refuse(fmt::format(
        "{} is a run of the materials {}; the scene has {}, and must have the same in the same order",
        start.run, fmt::join(info.materials, ", "), fmt::join(materials, ", ")));
  const std::vector<double>& times = found.reader.times();
  if (times.empty())
    refuse(fmt::format("{} holds no frame; output.fields_every must be above 0 there", start.run));
  found.frame = static_cast<int>(times.size()) - 1;
  if (start.time) {
    const auto nearer = [&](double a, double b) {
      return std::abs(a - *start.time) < std::abs(b - *start.time);
    };
    found.frame = static_cast<int>(std::min_element(times.begin(), times.end(), nearer) - times.begin());
  }
  const std::vector<std::string> stored = found.reader.names(found.frame), needed = needed_fields(scene);
  for (const std::string& name : needed)
    if (std::find(stored.begin(), stored.end(), name) == stored.end())
      refuse(fmt::format("{} does not hold the field {}; run it with {} among output.fields", start.run, name,
                         fmt::join(needed, ", ")));
  return found;
}

}  // namespace

double start_time(const Scene& scene) {
  const StoredFrame found = find_frame(scene);
  return found.reader.times()[static_cast<std::size_t>(found.frame)];
}

void begin(Simulation& simulation) {
  const Scene& scene = simulation.scene();
  if (!scene.start) return;
  const StoredFrame found = find_frame(scene);
  const Frame frame = found.reader.read(found.frame, needed_fields(scene));
  InitialState state{
      frame.velocity_x, frame.velocity_y, frame.field("pressure"), {frame.field("grains")}, {}};
  for (const auto& [name, values] : frame.fields) {  // stored as a share of the grains
    if (name != "tracer" && tracer_number(name) == 0) continue;
    state.shares.push_back(values);
    CellField& tracer = state.shares.back();
    for (int j = 0; j < tracer.ny(); ++j)
      for (int i = 0; i < tracer.nx(); ++i) tracer(i, j) *= state.shares[0](i, j);
  }
  if (scene.dilatancy) state.packing = frame.field("packing");
  simulation.begin_with(state);
}

}  // namespace hourglass
