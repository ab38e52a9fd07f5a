#pragma once
// Which part of each pixel polygons and lines cover. Coordinates are in pixels from the lower left corner; what
// lies outside of the raster is left out.
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/polygon.hpp"

namespace hourglass {

/// Union of polygons, by 4 x 4 samples a pixel.
class Cover {
 public:
  Cover(int width, int height) : width_(width), height_(height), samples_(std::size_t(width) * height) {}
  void add(const Polygon& polygon);
  /// Share of the pixel.
  double operator()(int a, int b) const;
  bool none(int a, int b) const { return at(a, b) == 0; }
  bool all(int a, int b) const { return at(a, b) == 0xffff; }
  /// Is the sample nearest this point covered? Of points outside, the nearest one of the raster.
  bool holds(double x, double y) const;

 private:
  std::uint16_t at(int a, int b) const { return samples_[std::size_t(b) * width_ + a]; }

  int width_, height_;
  std::vector<std::uint16_t> samples_;  ///< bit 4 * row + column
};

/// Lines with smooth edges; where they cross they are no darker.
class Strokes {
 public:
  Strokes(int width, int height) : width_(width), height_(height), shares_(std::size_t(width) * height) {}
  void add(const Polygon& points, double width, bool closed = false);
  double operator()(int a, int b) const { return shares_[std::size_t(b) * width_ + a]; }

 private:
  int width_, height_;
  std::vector<float> shares_;
};

}  // namespace hourglass
