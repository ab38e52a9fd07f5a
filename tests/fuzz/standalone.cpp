// A driver for compilers without libFuzzer: the corpus as it is, then so many mutations of it, from a fixed seed.
//   fuzz_<target> -runs=N FILE|FOLDER...
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size);

namespace {

using Random = std::mt19937_64;
std::size_t below(Random& random, std::size_t n) { return n == 0 ? 0 : random() % n; }

/// One of: a bit or a byte changed, a piece cut out, doubled, or taken from another text, a number exchanged.
void mutate(std::string& text, const std::vector<std::string>& corpus, Random& random) {
  static const std::vector<std::string> numbers{
      "0", "-1", "1e308", "nan", "-inf", "1e-320", "4294967296", "~", "[", "{", "*a", "&a", "!!x", "..", "/"};
  const std::size_t at = below(random, text.size()),
                    length = 1 + below(random, std::min<std::size_t>(64, text.size() - at));
  switch (random() % 6) {
    case 0:
      if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << random() % 8));
      break;
    case 1:
      if (!text.empty()) text[at] = static_cast<char>(random());
      break;
    case 2:
      text.erase(at, length);
      break;
    case 3:
      text.insert(below(random, text.size()), text.substr(at, length));
      break;
    case 4: {
      const std::string& other = corpus[below(random, corpus.size())];
      const std::size_t from = below(random, other.size());
      text.insert(at, other.substr(from, 1 + below(random, 64)));
      break;
    }
    default: {
      const std::size_t digit = text.find_first_of("0123456789", at);
      if (digit == std::string::npos) break;
      const std::size_t end = text.find_first_not_of("0123456789.e+-", digit);
      text.replace(digit, end == std::string::npos ? end : end - digit,
                   numbers[below(random, numbers.size())]);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  long runs = 0;
  std::vector<std::string> corpus;
  const auto add = [&](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  };
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.starts_with("-runs="))
      runs = std::atol(word.c_str() + 6);
    else if (fs::is_directory(word))
      for (const auto& entry : fs::directory_iterator(word)) add(entry.path());
    else
      add(word);
  }
  if (corpus.empty()) return std::fputs("no corpus\n", stderr), 2;
  const auto run = [](const std::string& text) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const unsigned char*>(text.data()), text.size());
  };
  for (const std::string& text : corpus) run(text);
  Random random(12345);
  for (long k = 0; k < runs; ++k) {
    std::string text = corpus[below(random, corpus.size())];
    for (std::size_t times = 1 + below(random, 4); times > 0; --times) mutate(text, corpus, random);
    run(text);
  }
  std::fprintf(stderr, "%zu texts and %ld mutations\n", corpus.size(), runs);
}
