#pragma once
// The colours of a picture with all that is drawn over them, pixel by pixel. For the files that draw pictures only.
#include <vtkImageData.h>
#include <vtkNew.h>

#include <algorithm>

#include "io/render_layout.hpp"

namespace hourglass {

inline constexpr Colour white{255, 255, 255}, dark{40, 40, 40};

/// A picture of w x h pixels, each painted by paint(pixel, a, b).
template <class Paint>
vtkNew<vtkImageData> image_of(int w, int h, Paint&& paint) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(w, h, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer());
  for (int b = 0; b < h; ++b) {
    for (int a = 0; a < w; ++a, pixel += 4) {
      paint(pixel, a, b);
      pixel[3] = 255;
    }
  }
  return image;
}

inline void set(unsigned char* pixel, const Colour& colour) {
  std::copy(colour.begin(), colour.end(), pixel);
}

/// Every cell in its colour, air blank, the overlays, the free surface as a black line, the arrows, and the solids.
vtkNew<vtkImageData> field_image(const Picture& picture, const ColourScale& scale, const Layout& l);

/// The sign of an overlay in the legend.
vtkNew<vtkImageData> key_image(Overlay overlay, int width, int height);

}  // namespace hourglass
