#pragma once
// What must not happen to a run, and what deserves a word: docs/theory.md, Trouble.
#include <string>
#include <vector>

#include "solver/simulation_state.hpp"

namespace hourglass {

/// Something wrong with a step, in words with place and time; empty: nothing.
struct Trouble {
  std::string what;
  bool hopeless = false;  ///< going on from here would be a silent wrong answer
  explicit operator bool() const { return !what.empty(); }
};

class Watchdog {
 public:
  /// Of a run that begins in this state with this mass of grains.
  Watchdog(const Simulation::Impl& state, double initial_mass);

  /// After a step: a solve that missed its tolerance, a speed that nothing in the scene explains.
  Trouble of_step(const StepReport& report);
  /// Every `look_every` steps: what the state as a whole has lost.
  Trouble of_state();
  /// The same for what can be lived with: each is said once.
  std::vector<std::string> doubts();

  void walk(Archive& archive) {
    archive.number("initial_mass", initial_mass_);
    archive.number("most_speed", most_speed_);
    archive.number("looks_outside", looks_outside_);
    archive.number("said_mass", said_mass_);
    archive.number("said_pressure", said_pressure_);
  }

  static constexpr long look_every = 64;  ///< steps

 private:
  std::string doubt_of_mass();
  std::string doubt_of_pressure();
  std::string place(int i, int j) const;

  const Simulation::Impl& s_;
  double initial_mass_;
  double most_speed_;  ///< [L/T]; infinity: no limit is known
  int looks_outside_ = 0;
  bool said_mass_ = false, said_pressure_ = false;
};

/// Share of the grains' cells where p lies outside of [-1 %, 100 %] of what the column of grains and their speed account
/// for: rho (|g_x| width + |g_y| height) + rho speed^2.
double pressure_outside(const Scene& scene, const Fields& fields, const Geometry* geometry, double fastest);

}  // namespace hourglass
