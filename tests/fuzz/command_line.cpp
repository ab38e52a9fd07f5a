// The command line, a line a word: main() of the program, in an empty folder. Words that would start work
// find no scene there, and --help after all others keeps it from looking.
#include <filesystem>
#include <vector>

#include "fuzz/scratch.hpp"

int hourglass_main(int argc, char** argv);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const hourglass::fuzz::Scratch scratch;
  static const bool quiet = [] {
    std::filesystem::current_path(scratch.folder());
    return std::freopen("/dev/null", "w", stdout) && std::freopen("errors", "w", stderr);
  }();
  FUZZ_REQUIRE(quiet);
  std::rewind(stderr);
  std::vector<std::string> words{"hourglass"};
  words.emplace_back();
  for (std::size_t k = 0; k < size && words.size() < 40; ++k) {
    if (data[k] == '\n')
      words.emplace_back();
    else if (data[k] != 0)
      words.back() += static_cast<char>(data[k]);
  }
  words.emplace_back("--help");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int status = hourglass_main(static_cast<int>(words.size()), argv.data());
  FUZZ_REQUIRE(status == 0 || status == 1 || status == 2);
  return 0;
}
