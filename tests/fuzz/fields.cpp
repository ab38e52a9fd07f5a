// fields.h5 of a run folder, damaged: read, or a std::exception.
#include <exception>

#include "fuzz/scratch.hpp"
#include "io/xdmf.hpp"

using namespace hourglass;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::Scratch scratch;
  scratch.write("fields.h5", fuzz::text_of(data, size));
  try {
    const FieldReader reader(scratch.folder());
    for (std::size_t k = 0; k < reader.times().size() && k < 3; ++k)
      reader.read(static_cast<int>(k), reader.names(static_cast<int>(k)));
  } catch (const std::exception& error) {
    FUZZ_REQUIRE(*error.what());
  }
  return 0;
}
