#pragma once
// The one render window of the process: OpenGL on Mesa's surfaceless EGL platform, so that no display and no
// graphics card is needed. The first picture takes a second or two for starting up, later ones reuse the
// window.
#include <vtkSmartPointer.h>

#include <filesystem>
#include <stdexcept>
#include <string>

class vtkAbstractContextItem;
class vtkContext2D;
class vtkImageData;
class vtkTextProperty;

namespace hourglass {

/// This machine cannot draw; what() says what is missing.
struct NoGraphics : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Smooth edges of slanting lines; a third of the time is enough without.
enum class Edges { crisp, smooth };

/// Draws a 2D item (a chart, or one with a Paint of its own) on white, width x height pixels, into a PNG
/// file, which is replaced in one go; an empty path writes none. Call from one thread only, always the same. Throws NoGraphics if EGL or
/// OpenGL is missing, std::runtime_error if the file cannot be written.
void draw_png(vtkAbstractContextItem& item, int width, int height, const std::filesystem::path& path,
              Edges edges = Edges::smooth);

/// The same as the bytes of a PNG file, each `halved` time at half the size.
std::string png_of(vtkAbstractContextItem& item, int width, int height, Edges edges = Edges::smooth,
                   int halved = 0);
/// A PNG file at half its size, so many times. Throws std::runtime_error if it cannot be read.
std::string smaller_png(const std::filesystem::path& path, int halved);

/// The type of all pictures, in dark grey.
void style_text(vtkTextProperty* text, int size);
inline constexpr int tick_font = 27, label_font = 31;  // pixels

/// Which part of a text stands at its place; up: begin is its foot.
enum class Align { begin, middle, end };
/// A line of text.
void draw_text(vtkContext2D* context, const std::string& text, double x, double y, int size, Align across,
               Align up);
/// Its width in pixels.
int text_width(const std::string& text, int size);
/// A line of text that reads upwards. VTK turns text too, but cuts off its tall letters.
vtkSmartPointer<vtkImageData> upright_text(const std::string& text, int size);

}  // namespace hourglass
