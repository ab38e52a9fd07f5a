// Compiled twice: HOURGLASS_TWIN is the name of the maker, and for the bare one `hourglass` the name of another namespace.
#include "perf/twin_steps.hpp"

#include "tests/support/make_scene.hpp"

namespace twins {
namespace {

class Steps final : public Silo {
 public:
  explicit Steps(int cells) : simulation_(hourglass::silo(cells)) {}
  void step() override { simulation_.step(); }
  double fingerprint() const override {
    const hourglass::Fields& f = simulation_.fields();
    double sum = 0;
    for (int j = 0; j < f.p.ny(); ++j)
      for (int i = 0; i < f.p.nx(); ++i) sum += f.u(i, j) + 3 * f.v(i, j) + 7 * f.p(i, j);
    return sum;
  }

 private:
  hourglass::Simulation simulation_;
};

}  // namespace

std::unique_ptr<Silo> HOURGLASS_TWIN(int cells) { return std::make_unique<Steps>(cells); }

}  // namespace twins
