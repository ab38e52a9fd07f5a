#include "io/montage.hpp"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "io/canvas.hpp"

namespace hourglass {
namespace {

constexpr int gap = 12, label_height = 40;  // pixels

struct Image {
  int width = 0, height = 0;
  std::vector<Colour> pixels;  ///< row by row from below
};

Image read_png(const std::filesystem::path& path) {
  vtkNew<vtkPNGReader> reader;
  if (!reader->CanReadFile(path.c_str())) throw std::runtime_error(path.string() + ": is no picture");
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* data = reader->GetOutput();
  const int parts = data->GetNumberOfScalarComponents();
  Image image{data->GetDimensions()[0], data->GetDimensions()[1], {}};
  if (data->GetScalarType() != VTK_UNSIGNED_CHAR || parts < 3)
    throw std::runtime_error(path.string() + ": is no picture with red, green and blue of 8 bits");
  const auto* from = static_cast<const unsigned char*>(data->GetScalarPointer());
  image.pixels.resize(std::size_t(image.width) * image.height);
  for (Colour& pixel : image.pixels) {
    std::copy(from, from + 3, pixel.begin());
    from += parts;
  }
  return image;
}

/// Each pixel the mean of those that it covers.
Image scaled_to(const Image& image, int width) {
  if (width >= image.width) return image;
  const double scale = double(image.width) / width;
  Image out{width, static_cast<int>(image.height / scale), {}};
  // Along one axis: the pixels that one covers, and how much of each.
  const auto covered = [&](int at, int end) {
    std::vector<std::pair<int, double>> parts;
    const double from = at * scale, to = std::min<double>((at + 1) * scale, end);
    for (int k = static_cast<int>(from); k < end && k < to; ++k)
      parts.emplace_back(k, std::min<double>(k + 1, to) - std::max<double>(k, from));
    return parts;
  };
  for (int b = 0; b < out.height; ++b) {
    const auto rows = covered(b, image.height);
    for (int a = 0; a < width; ++a) {
      std::array<double, 3> sum{};
      double weight = 0;
      for (const auto& [i, across] : covered(a, image.width))
        for (const auto& [j, up] : rows) {
          for (int c = 0; c < 3; ++c)
            sum[c] += across * up * image.pixels[std::size_t(j) * image.width + i][c];
          weight += across * up;
        }
      Colour pixel;
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<unsigned char>(std::lround(sum[c] / weight));
      out.pixels.push_back(pixel);
    }
  }
  return out;
}

}  // namespace

void draw_montage(const std::vector<Panel>& panels, int columns, int panel_width,
                  const std::filesystem::path& path) {
  std::vector<Image> images;
  for (const Panel& panel : panels) images.push_back(scaled_to(read_png(panel.picture), panel_width));
  int width = 0, height = 0;
  for (const Image& image : images) {
    width = std::max(width, image.width);
    height = std::max(height, image.height);
  }
  const int n = static_cast<int>(panels.size()), across = std::min(columns, n),
            rows = (n + columns - 1) / columns;
  Canvas canvas(across * width + (across - 1) * gap, rows * (height + label_height));
  for (int k = 0; k < n; ++k) {
    const Image& image = images[k];
    const int x = k % columns * (width + gap), y = (rows - 1 - k / columns) * (height + label_height);
    for (int b = 0; b < image.height; ++b)
      for (int a = 0; a < image.width; ++a)
        canvas.set(x + a, y + b, image.pixels[std::size_t(b) * image.width + a]);
    canvas.text(panels[k].label, x + image.width / 2.0, y + height + label_height / 2.0, Align::middle,
                Align::middle);
  }
  canvas.write(path);
}

}  // namespace hourglass
