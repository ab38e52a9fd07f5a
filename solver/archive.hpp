#pragma once
// A state under names, for exact restart: one list of members (walk()) both stores and restores it, so that neither side
// can forget one. Numbers are kept to the last bit.
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "kernels/velocity.hpp"

namespace hourglass {

/// Where the state goes to or comes from. Names are unique within a group. Whatever is restored must have been stored
/// under the same name and extents; std::runtime_error if not, or if it cannot be read or written.
class Archive {
 public:
  virtual ~Archive() = default;
  virtual bool restoring() const = 0;

  virtual void number(const std::string& name, double& value) = 0;
  virtual void numbers(const std::string& name, std::vector<double>& values) = 0;
  virtual void texts(const std::string& name, std::vector<std::string>& values) = 0;
  /// `rows` rows of `length` numbers; row(k) begins row k.
  virtual void table(const std::string& name, int rows, int length,
                     const std::function<double*(int)>& row) = 0;

  /// A whole number, or a truth; throws std::runtime_error if what is stored is none of that type.
  template <class Number>
  requires std::is_integral_v<Number>
  void number(const std::string& name, Number& value) {
    auto wide = static_cast<double>(value);
    number(name, wide);
    const bool whole = std::abs(wide) < 1e15;
    value = static_cast<Number>(whole ? static_cast<long long>(wide) : 0);
    if (!whole || static_cast<double>(value) != wide)
      throw std::runtime_error(name + ": not a number of its kind");
  }
  void number(const std::string& name, std::optional<double>& value) {
    std::vector<double> some;
    if (value) some.push_back(*value);
    numbers(name, some);
    value = some.empty() ? std::nullopt : std::optional(some[0]);
  }
  /// None, or as many as the other has.
  void numbers_like(const std::string& name, std::vector<double>& values, const std::vector<double>& other) {
    numbers(name, values);
    if (!values.empty() && values.size() != other.size())
      throw std::runtime_error(name + ": another number of them than the scene has");
  }
  /// The field with its halo.
  template <At where>
  void field(const std::string& name, Field<where>& f) {
    table(name, f.ny() + 2 * halo, f.nx() + 2 * halo, [&](int k) { return f.row(k - halo) - halo; });
  }
  template <std::size_t n>
  void history(const std::string& name, std::vector<std::array<double, n>>& samples) {
    double size = static_cast<double>(samples.size());
    number(name + "_size", size);
    if (!(size >= 0 && size < 1e9)) throw std::runtime_error(name + ": no such number of samples");
    samples.resize(static_cast<std::size_t>(size));
    table(name, static_cast<int>(samples.size()), static_cast<int>(n),
          [&](int k) { return samples[static_cast<std::size_t>(k)].data(); });
  }
  /// Names of what `body` walks begin with this one.
  template <class Body>
  void group(const std::string& name, Body&& body) {
    const std::size_t before = prefix_.size();
    prefix_ += name + "_";
    body();
    prefix_.resize(before);
  }

 protected:
  std::string prefixed(const std::string& name) const { return prefix_ + name; }

 private:
  std::string prefix_;
};

/// Walks a state: hands all its members to the archive.
using Walk = std::function<void(Archive&)>;

}  // namespace hourglass
