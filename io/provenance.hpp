#pragma once
// Which program made a result, and where.
#include <string>

namespace hourglass {

struct Provenance {
  std::string version;   ///< of hourglass
  std::string revision;  ///< git, with -dirty for uncommitted changes; "unknown" outside a checkout
  std::string compiler, flags, build_type;
  int simd_bits = 0;  ///< width of the vectors that the engine uses
  std::string host, cpu;
  int cores = 0;     ///< that this process may run on
  int threads = 0;   ///< that the run used
  std::string date;  ///< ISO 8601 with offset
};

/// Of this program, here and now. threads = 0: as many as there are cores to run on.
Provenance provenance(int threads = 0);

/// For `hourglass --version`: version, git revision, compiler, flags, SIMD width, threads; a line each.
std::string version_text();

/// A JSON object, indented by `indent` spaces after its first line.
std::string to_json(const Provenance& provenance, int indent = 0);

}  // namespace hourglass
