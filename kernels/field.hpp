#pragma once
// Typed fields on a staggered patch. The type says where a value lives: passing u where p is meant does not
// compile. Rows (constant j) are contiguous, padded and aligned to 64 bytes at i = 0; `halo` layers surround
// the patch on every side.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <new>

#include "kernels/patch.hpp"

namespace hourglass {

enum class At { cell, xface, yface, corner };

/// Points in x and y of a location on a patch, halo not counted.
template <At where>
constexpr int extent_x(const Patch& p) {
  return p.nx + (where == At::xface || where == At::corner ? 1 : 0);
}
template <At where>
constexpr int extent_y(const Patch& p) {
  return p.ny + (where == At::yface || where == At::corner ? 1 : 0);
}

template <At where, class T = double>
class Field {
 public:
  static constexpr At location = where;
  using value_type = T;

  Field() = default;
  /// Allocates, halo included, and sets every value to `value`.
  explicit Field(const Patch& patch, T value = T(0)) : patch_(patch) {
    constexpr int line = 64 / static_cast<int>(sizeof(T));
    static_assert(line >= halo);
    const int used = line + patch.nx + 1 + halo;
    int lines = (used + line - 1) / line;
    if (lines % 16 == 0) ++lines;  // rows a multiple of 1 KiB apart would share cache sets
    stride_ = lines * line;
    rows_ = patch.ny + 1 + 2 * halo;
    // Fields of one size would all begin at the same place in a page, and a processor that has just stored to
    // one then holds back loads from the others (addresses are first compared by their low 12 bits).
    shift_ = static_cast<std::size_t>(7 * allocations_++ % 64) * line;
    origin_ = shift_ + static_cast<std::size_t>(halo) * stride_ + line;
    data_.reset(static_cast<T*>(::operator new[](size() * sizeof(T), std::align_val_t{64})));
    fill(value);
  }
  Field(const Field& other) : Field() { *this = other; }
  Field(Field&&) noexcept = default;
  Field& operator=(Field&&) noexcept = default;
  Field& operator=(const Field& other) {
    if (this == &other) return *this;
    if (!other.data_) return *this = Field();
    if (!data_ || !(patch_ == other.patch_)) *this = Field(other.patch_);
    std::copy(other.data_.get() + other.shift_, other.data_.get() + other.size(), data_.get() + shift_);
    return *this;
  }

  /// Row j, -halo <= j < ny() + halo; row(j)[i] with -halo <= i < nx() + halo.
  T* row(int j) { return data_.get() + origin_ + static_cast<std::ptrdiff_t>(j) * stride_; }
  const T* row(int j) const { return data_.get() + origin_ + static_cast<std::ptrdiff_t>(j) * stride_; }
  T& operator()(int i, int j) { return row(j)[i]; }
  const T& operator()(int i, int j) const { return row(j)[i]; }

  int nx() const { return extent_x<where>(patch_); }
  int ny() const { return extent_y<where>(patch_); }
  int stride() const { return stride_; }
  const Patch& patch() const { return patch_; }
  bool allocated() const { return data_ != nullptr; }
  std::size_t bytes() const { return data_ ? (size() - shift_) * sizeof(T) : 0; }
  void fill(T value) { std::fill(data_.get(), data_.get() + size(), value); }
  void swap(Field& other) noexcept { std::swap(*this, other); }

 private:
  struct Free {
    void operator()(T* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  std::size_t size() const { return shift_ + static_cast<std::size_t>(stride_) * rows_; }

  Patch patch_{};
  int stride_ = 0, rows_ = 0;
  std::size_t shift_ = 0, origin_ = 0;
  inline static std::atomic<unsigned> allocations_{0};
  std::unique_ptr<T[], Free> data_;
};

template <class T = double>
using CellFieldOf = Field<At::cell, T>;
template <class T = double>
using XFaceFieldOf = Field<At::xface, T>;
template <class T = double>
using YFaceFieldOf = Field<At::yface, T>;
template <class T = double>
using CornerFieldOf = Field<At::corner, T>;

using CellField = CellFieldOf<>;
using XFaceField = XFaceFieldOf<>;
using YFaceField = YFaceFieldOf<>;
using CornerField = CornerFieldOf<>;

}  // namespace hourglass
