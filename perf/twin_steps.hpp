#pragma once
// Steps of the base silo by two builds of the engine in one program: as it is, and without its modules
// (kernels/modules.hpp) in a namespace of its own.
#include <memory>

namespace twins {

class Silo {
 public:
  virtual ~Silo() = default;
  virtual void step() = 0;
  /// Sum of all velocities and pressures, to the last bit.
  virtual double fingerprint() const = 0;
};

std::unique_ptr<Silo> full(int cells);
std::unique_ptr<Silo> bare(int cells);

}  // namespace twins
