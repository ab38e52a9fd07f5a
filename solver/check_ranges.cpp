// Numbers in messages: each against the range that scene_keys.hpp gives its key.
#include "solver/scene_checks.hpp"
#include "solver/scene_keys.hpp"

namespace hourglass {
namespace {

class RangeCheck : public KeyVisitor {
 public:
  explicit RangeCheck(Problems& problems) : problems_(problems) {}

  void number(const char* key, double value, const Key& about) {
    if (about.range.has_ends() && !about.range.holds(value))
      problems_.require(about.range, path_ + key, value, about.cure);
  }
  void number(const char* key, const std::optional<double>& value, const Key& about) {
    if (value) number(key, *value, about);
  }
  void integer(const char* key, long value, const Key& about) {
    number(key, static_cast<double>(value), about);
  }
  void integer_or(const char*, const char* key, long value, const Key& about) { integer(key, value, about); }

  void map(const char* key, auto&& body) { below(key, body); }
  void module(const char* key, auto& value, auto&& body) {
    if (value) below(key, [&] { body(*value); });
  }
  void list(const char* key, auto& values, const char*, auto&& body) {
    below(key, [&] {
      for (std::size_t k = 0; k < values.size(); ++k)
        below(std::to_string(k).c_str(), [&] { body(values[k]); });
    });
  }
  void named(const char* key, auto& values, const char*, auto&& body) {
    below(key, [&] {
      for (auto& value : values) below(value.name.c_str(), [&] { body(value); });
    });
  }

 private:
  void below(const char* key, auto&& body) {
    const std::size_t before = path_.size();
    (path_ += key) += '.';
    body();
    path_.resize(before);
  }

  Problems& problems_;
  std::string path_;  // of what is being walked, with a dot behind
};

}  // namespace

void check_ranges(const Scene& scene, Problems& problems) {
  RangeCheck visitor(problems);
  Scene walked = scene;
  visit_scene(visitor, walked);
}

}  // namespace hourglass
