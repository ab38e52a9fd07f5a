#pragma once
// What is stored of a run: once, its geometry and names; and frame by frame, its fields.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "kernels/polygon.hpp"
#include "solver/simulation.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {

/// What a picture or a reader needs to know of a run besides its fields.
struct RunInfo {
  std::string name;
  Units units = Units::grain;
  Patch patch;
  std::array<Wall, 4> walls{};  ///< by Side
  std::vector<Orifice> orifices;
  std::vector<std::string> materials;
  Symmetry symmetry = Symmetry::none;
  Coordinates coordinates = Coordinates::cartesian;
  std::vector<Polygon> solids;  ///< outlines of what is solid in the domain; they may overlap
  bool steady = false;          ///< of a model in closed form: there is no time
  double slow_speed = 0;        ///< slower grains count as quasi-static [L/T]; 0: not known

  /// The left edge is not a wall but the middle of what is meant.
  bool left_is_middle() const {
    return symmetry == Symmetry::mirror || coordinates == Coordinates::axisymmetric;
  }
};

RunInfo info_of(const Scene& scene);

struct Frame {
  double t = 0;                                           ///< [T]
  std::vector<std::pair<std::string, CellField>> fields;  ///< by names of known_fields(), `grains` among them
  CellField velocity_x, velocity_y;                       ///< at cell centres [L/T]

  /// Throws std::invalid_argument, naming what there is, if the frame has no such field.
  const CellField& field(const std::string& name) const;
};

/// The scene's output.fields that it has (a scene of one material has no tracer).
std::vector<std::string> asked_fields(const Scene& scene);

/// These and `grains`, which pictures need.
std::vector<std::string> stored_fields(const Scene& scene);

/// The state of a simulation, with the given fields, `grains` and the velocity.
Frame frame_of(const Simulation& simulation, const std::vector<std::string>& fields);

/// The same of a steady field, at t = 0.
Frame frame_of(const SteadyFlow& flow, const std::vector<std::string>& fields);

/// Of known_fields(); throws std::invalid_argument, naming the known ones.
const FieldInfo& field_info(const std::string& name);

/// A unit as readers want it: "L/T" is "√(g d)" in grain units, "m/s" in SI; "" for "1".
std::string unit_text(const std::string& dimension, Units units);

}  // namespace hourglass
