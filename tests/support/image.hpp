#pragma once
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <filesystem>

#include "io/scales.hpp"

namespace hourglass {

/// A PNG file read back.
class Image {
 public:
  explicit Image(const std::filesystem::path& path) {
    reader_->SetFileName(path.c_str());
    reader_->Update();
  }
  int width() const { return reader_->GetOutput()->GetDimensions()[0]; }
  int height() const { return reader_->GetOutput()->GetDimensions()[1]; }
  /// From the lower left corner.
  Colour at(int x, int y) const {
    const auto* p = static_cast<unsigned char*>(reader_->GetOutput()->GetScalarPointer(x, y, 0));
    return {p[0], p[1], p[2]};
  }
  int count(const Colour& colour) const {
    int n = 0;
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(); ++x) n += at(x, y) == colour;
    }
    return n;
  }
  /// Is a frame of so many pixels along the edges white, that is, is nothing cut off?
  bool white_margin(int pixels) const {
    for (int y = 0; y < height(); ++y) {
      for (int x = 0; x < width(); ++x) {
        const bool edge = x < pixels || y < pixels || x >= width() - pixels || y >= height() - pixels;
        if (edge && at(x, y) != Colour{255, 255, 255}) return false;
      }
    }
    return true;
  }

 private:
  vtkNew<vtkPNGReader> reader_;
};

}  // namespace hourglass
