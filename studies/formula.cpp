#include "studies/formula.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>

#include "io/yaml_tree.hpp"

namespace hourglass {
namespace {

constexpr int deepest = 50;  ///< of parentheses and signs
constexpr const char* functions[] = {"min", "max", "abs", "sqrt"};

bool is_function(const std::string& word) { return std::ranges::count(functions, word) > 0; }
bool begins_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool goes_on_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; }

class Evaluator {
 public:
  using Lookup = std::function<double(const std::string& name)>;  ///< throws FormulaError

  Evaluator(const std::string& text, Lookup lookup) : text_(text), lookup_(std::move(lookup)) {}

  double whole() {
    const double value = sum();
    if (!at_end())
      fail(peek() == ')' ? "a ) closes nothing. Remove it" : "an operator is missing (one of + - * / ^)");
    return value;
  }

 private:
  double sum() {
    double value = product();
    for (;;) {
      if (take('+'))
        value += product();
      else if (take('-'))
        value -= product();
      else
        return value;
    }
  }
  double product() {
    double value = sign();
    for (;;) {
      if (take('*'))
        value *= sign();
      else if (take('/'))
        value /= sign();
      else
        return value;
    }
  }
  double sign() {
    const Level level(*this);
    if (take('-')) return -sign();
    if (take('+')) return sign();
    const double base = atom();
    return take('^') ? std::pow(base, sign()) : base;
  }
  double atom() {
    if (at_end()) fail("a number or name is missing at its end");
    if (take('(')) {
      const double value = sum();
      close();
      return value;
    }
    if (begins_name(peek())) return named();
    double value = 0;
    const char *begin = text_.data() + at_, *end = text_.data() + text_.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc())
      fail(fmt::format("'{}' cannot stand here (numbers, names of axes, + - * / ^ ( ), min, max, abs, sqrt)",
                       shown(std::string(1, peek()))));
    at_ += stop - begin;
    return value;
  }
  double named() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && goes_on_name(text_[at_])) ++at_;
    const std::string name = text_.substr(begin, at_ - begin);
    if (!is_function(name)) {
      if (!at_end() && peek() == '(')
        at_ = begin,
        fail(fmt::format("'{}' is no function (allowed: {})", shown(name), fmt::join(functions, ", ")));
      return lookup_(name);
    }
    if (!take('(')) fail(fmt::format("{} needs its values in parentheses", name));
    std::vector<double> values{sum()};
    while (take(',')) values.push_back(sum());
    close();
    if (name == "min") return std::ranges::min(values);
    if (name == "max") return std::ranges::max(values);
    if (values.size() != 1) fail(fmt::format("{} takes one value, here are {}", name, values.size()));
    return name == "abs" ? std::abs(values[0]) : std::sqrt(values[0]);
  }

  /// A level of nesting while it lives.
  struct Level {
    explicit Level(Evaluator& e) : depth(e.depth_) {
      if (++depth > deepest) e.fail(fmt::format("is nested deeper than {}. Split it up", deepest));
    }
    ~Level() { --depth; }
    int& depth;
  };

  void close() {
    if (!take(')')) fail(at_end() ? "a ) is missing at its end" : "an operator or a ) is missing");
  }
  bool at_end() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
    return at_ == text_.size();
  }
  char peek() const { return text_[at_]; }
  bool take(char c) {
    if (at_end() || peek() != c) return false;
    ++at_;
    return true;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FormulaError(fmt::format("formula '{}', column {}: {}.", shown(text_), at_ + 1, what));
  }

  const std::string& text_;
  Lookup lookup_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

bool is_formula_name(const std::string& word) {
  return !word.empty() && begins_name(word[0]) && std::ranges::all_of(word, goes_on_name) &&
         !is_function(word);
}

double value_of(const std::string& formula, const std::map<std::string, double>& values) {
  const auto lookup = [&](const std::string& name) {
    const auto at = values.find(name);
    if (at != values.end()) return at->second;
    std::vector<std::string> known;
    for (const auto& [axis, value] : values) known.push_back(axis);
    const std::string meant = nearest(name, known);
    throw FormulaError(fmt::format("formula '{}': '{}' is no axis with numbers (there are: {}).{}",
                                   shown(formula), shown(name), fmt::join(known, ", "),
                                   meant.empty() ? "" : fmt::format(" Did you mean '{}'?", meant)));
  };
  const double value = Evaluator(formula, lookup).whole();
  if (!std::isfinite(value))
    throw FormulaError(
        fmt::format("formula '{}': gives no finite number (division by 0, or the root of a "
                    "negative number).",
                    shown(formula)));
  return value;
}

std::set<std::string> names_in(const std::string& formula) {
  std::set<std::string> names;
  Evaluator(formula, [&](const std::string& name) { return names.insert(name), 1.0; }).whole();
  return names;
}

}  // namespace hourglass
