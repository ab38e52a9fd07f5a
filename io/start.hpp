#pragma once
// A start from a stored run: Scene::start, from the frames of its fields.h5.
#include "solver/simulation.hpp"

namespace hourglass {

/// The time of the frame that the scene begins with. Throws std::runtime_error, in a sentence without its full stop, if
/// there is no such run, if it is one of another domain or other materials, or lacks fields.
double start_time(const Scene& scene);

/// Puts the simulation into the state that its scene begins with; without a `start` that is so already. Throws as above.
void begin(Simulation& simulation);

}  // namespace hourglass
