#pragma once
// What a scene switches on, where its equations are well posed, and what it allocates: for `hourglass plan` and `check`.
// Steps and seconds: io/forecast.
#include <string>
#include <utility>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {

/// A module or option of the physics or the numerics.
struct Switch {
  std::string key;   ///< dotted path of the key that switches it on
  std::string what;  ///< what is on, with its parameters
};
struct Switches {
  std::vector<Switch> on;
  std::vector<std::string> off;  ///< keys; neither stored nor paid for
};
Switches switches_of(const Scene& scene);
std::string text_of(const Switches& switches);

/// C(I) of Barker, Schaeffer, Bohorquez & Gray 2015 for each material: the range of I where mu(I) is well posed, or that
/// there is none, and what holds the short waves; a line or more each.
std::string well_posedness_text(const Scene& scene);

/// Of a model in closed form: the formula with its parameters, discharge, what is stored, and how long it takes here.
std::string steady_text(const Scene& scene);

/// Arrays that live as long as the run.
struct ArrayGroup {
  std::string name;    ///< of Simulation::memory()
  std::string arrays;  ///< what it holds
  std::size_t bytes = 0;
};
std::vector<ArrayGroup> arrays_of(const Simulation& simulation);
std::size_t total_bytes(const std::vector<ArrayGroup>& groups);
/// One line a group with bytes and bytes a cell, and the total; below it what a frame or picture takes while it is made.
std::string memory_text(const Simulation& simulation);

}  // namespace hourglass
