#pragma once
// A state in memory, to be compared number by number.
#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "solver/archive.hpp"

namespace hourglass {

class MemoryArchive : public Archive {
 public:
  bool restore = false;
  std::map<std::string, std::vector<double>> values;
  std::map<std::string, std::vector<std::string>> words;

  bool restoring() const override { return restore; }
  void number(const std::string& name, double& value) override {
    std::vector<double> one{value};
    numbers(name, one);
    value = one.at(0);
  }
  void numbers(const std::string& name, std::vector<double>& some) override {
    exchange(values, prefixed(name), some);
  }
  void texts(const std::string& name, std::vector<std::string>& some) override {
    exchange(words, prefixed(name), some);
  }
  void table(const std::string& name, int rows, int length, const std::function<double*(int)>& row) override {
    std::vector<double> all;
    for (int k = 0; k < rows && !restore; ++k) all.insert(all.end(), row(k), row(k) + length);
    exchange(values, prefixed(name), all);
    if (all.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(length))
      throw std::runtime_error(prefixed(name) + ": other extents");
    for (int k = 0; k < rows; ++k)
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(k) * length, length, row(k));
  }

  /// Names under which the two differ in any bit; wall times are not looked at.
  std::vector<std::string> differences(const MemoryArchive& other) const {
    std::vector<std::string> names;
    for (const auto& [name, mine] : values) {
      if (name == "stage_seconds" || name == "run_stepping" || name == "run_outside" ||
          name == "run_wall_seconds")
        continue;
      const auto at = other.values.find(name);
      if (at == other.values.end() || at->second.size() != mine.size() ||
          (!mine.empty() && std::memcmp(at->second.data(), mine.data(), mine.size() * sizeof(double)) != 0))
        names.push_back(name);
    }
    for (const auto& [name, mine] : words)
      if (const auto at = other.words.find(name); at == other.words.end() || at->second != mine)
        names.push_back(name);
    if (values.size() != other.values.size() || words.size() != other.words.size())
      names.push_back("the number of names");
    return names;
  }

 private:
  template <class T>
  void exchange(std::map<std::string, std::vector<T>>& all, const std::string& name, std::vector<T>& some) {
    if (restore) {
      some = all.at(name);
    } else if (!all.emplace(name, some).second) {
      throw std::runtime_error(name + ": stored twice");
    }
  }
};

}  // namespace hourglass
