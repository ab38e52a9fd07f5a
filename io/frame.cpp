#include "io/frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "solver/quasi_static.hpp"
#include "solver/solids.hpp"

namespace hourglass {

RunInfo info_of(const Scene& scene) {
  RunInfo info;
  info.name = scene.name;
  info.units = scene.units;
  info.patch = scene.patch();
  info.walls = scene.walls;
  info.orifices = scene.orifices;
  for (const Material& m : scene.materials) info.materials.push_back(m.name);
  info.symmetry = scene.symmetry;
  info.coordinates = scene.coordinates;
  info.solids = outlines_of(scene);
  if (!scene.materials.empty()) info.slow_speed = quasi_static_speed(scene);
  return info;
}

const CellField& Frame::field(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& [known, values] : fields) {
    if (known == name) return values;
    names.push_back(known);
  }
  throw std::invalid_argument(fmt::format("no field '{}' here; there are: {}", name, fmt::join(names, ", ")));
}

std::vector<std::string> asked_fields(const Scene& scene) {
  std::vector<std::string> names;
  for (const std::string& name : scene.output.fields) {
    if (!has_field(scene, field_info(name))) continue;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> stored_fields(const Scene& scene) {
  std::vector<std::string> names = asked_fields(scene);
  if (std::find(names.begin(), names.end(), "grains") == names.end()) names.push_back("grains");
  return names;
}

namespace {

template <class Flow>
Frame frame_at(double t, const Flow& flow, const std::vector<std::string>& fields) {
  Frame frame;
  frame.t = t;
  for (const std::string& name : fields) frame.fields.emplace_back(name, flow.derived(name));
  frame.velocity_x = flow.derived("velocity_x");
  frame.velocity_y = flow.derived("velocity_y");
  return frame;
}

}  // namespace

Frame frame_of(const Simulation& simulation, const std::vector<std::string>& fields) {
  return frame_at(simulation.t(), simulation, fields);
}
Frame frame_of(const SteadyFlow& flow, const std::vector<std::string>& fields) {
  return frame_at(0, flow, fields);
}

const FieldInfo& field_info(const std::string& name) {
  std::vector<std::string> names;
  for (const FieldInfo& info : known_fields()) {
    if (name == info.name) return info;
    names.push_back(info.name);
  }
  throw std::invalid_argument(fmt::format("unknown field '{}'; known: {}", name, fmt::join(names, ", ")));
}

std::string unit_text(const std::string& dimension, Units units) {
  struct Entry {
    const char *dimension, *grain, *SI;
  };
  // M is mass per unit depth, so M/T^2 is a pressure.
  static constexpr Entry table[] = {{"1", "", ""},
                                    {"L", "d", "m"},
                                    {"T", "√(d/g)", "s"},
                                    {"1/T", "√(g/d)", "1/s"},
                                    {"L/T", "√(g d)", "m/s"},
                                    {"M", "ρ d²", "kg/m"},
                                    {"M/T", "ρ √(g d³)", "Pa s"},
                                    {"M/T^2", "ρ g d", "Pa"},
                                    {"M/L^2", "ρ", "kg/m³"}};
  for (const Entry& entry : table) {
    if (dimension == entry.dimension) return units == Units::grain ? entry.grain : entry.SI;
  }
  return dimension;
}

}  // namespace hourglass
