#include "io/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "build_info.hpp"
#include "io/json.hpp"
#include "solver/simd.hpp"

namespace hourglass {
namespace {

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(std::min(line.find(':') + 2, line.size()));
  }
  return "unknown";
}

int cores_to_run_on() {
  cpu_set_t set;
  return ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

}  // namespace

Provenance provenance(int threads) {
  const int cores = cores_to_run_on();
  return {.version = HOURGLASS_VERSION,
          .revision = HOURGLASS_REVISION,
          .compiler = HOURGLASS_COMPILER,
          .flags = HOURGLASS_FLAGS,
          .build_type = HOURGLASS_BUILD_TYPE,
          .simd_bits = simd_bits(),
          .host = host_name(),
          .cpu = cpu_name(),
          .cores = cores,
          .threads = threads > 0 ? threads : cores,
          .date = fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", fmt::localtime(std::time(nullptr)))};
}

std::string version_text() {
  const Provenance p = provenance();
  return fmt::format(
      "hourglass {}\ngit revision  {}\ncompiler      {}\nflags         {} ({})\nSIMD width    {} bits\n"
      "threads       {}",
      p.version, p.revision, p.compiler, p.flags, p.build_type, p.simd_bits, p.threads);
}

std::string to_json(const Provenance& p, int indent) {
  return json_object({{"version", json_string(p.version)},
                      {"revision", json_string(p.revision)},
                      {"compiler", json_string(p.compiler)},
                      {"flags", json_string(p.flags)},
                      {"build_type", json_string(p.build_type)},
                      {"simd_bits", json_number(long{p.simd_bits})},
                      {"host", json_string(p.host)},
                      {"cpu", json_string(p.cpu)},
                      {"cores", json_number(long{p.cores})},
                      {"threads", json_number(long{p.threads})},
                      {"date", json_string(p.date)}},
                     indent);
}

}  // namespace hourglass
