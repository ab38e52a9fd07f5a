#pragma once
// How many threads the next step runs on. Results do not depend on it (kernels/team.hpp), so it may change
// from step to step: on a shared machine a neighbour that takes a core makes every barrier wait for a time
// slice, and one thread is then many times faster than two.
#include <algorithm>

namespace hourglass {

class ThreadGovernor {
 public:
  explicit ThreadGovernor(int threads) : most_(threads) {}

  /// Threads for the next step: all or one, whichever was faster lately. The other is tried for two steps now
  /// and then, more seldom each time that it loses again.
  int next() {
    if (most_ <= 1) return 1;
    if (trials_ == 0 && rest_-- <= 0) {
      trying_ = favourite() == 1 ? most_ : 1;
      cost_of(trying_) = never;  // what it cost long ago says nothing
      trials_ = 2;
    }
    if (trials_ == 0) return running_ = favourite();
    if (--trials_ == 0) {
      rest_ = pause_;
      pause_ = std::min(2 * pause_, 1000);
    }
    return running_ = trying_;
  }

  /// A step of so much work (any unit) took so long on the threads that next() gave.
  void record(double work, double seconds) {
    const int before = favourite();
    double& cost = cost_of(running_);
    const double now = seconds / work;
    // A step that is several times dearer is not noise: somebody took a core. Try the other choice at once.
    if (cost != never && now > 3 * cost) rest_ = 0;
    cost = cost == never ? now : 0.7 * cost + 0.3 * now;
    if (favourite() != before) pause_ = 30;
  }

 private:
  static constexpr double never = -1;
  double& cost_of(int threads) { return threads == 1 ? one_ : all_; }
  int favourite() const { return one_ != never && (all_ == never || one_ < all_) ? 1 : most_; }

  int most_, running_ = 1;
  int trying_ = 1, trials_ = 0;       // the other choice, and steps left of its trial
  int rest_ = 6, pause_ = 30;         // steps to the next trial, and from it to the one after
  double one_ = never, all_ = never;  // seconds per unit of work
};

}  // namespace hourglass
