#pragma once
// The one render window of the process: OpenGL on Mesa's surfaceless EGL platform, so that no display and no
// graphics card is needed. The first picture takes a second or two for starting up, later ones reuse the
// window.
#include <filesystem>
#include <stdexcept>

class vtkAbstractContextItem;
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

/// The type of all pictures, in dark grey.
void style_text(vtkTextProperty* text, int size);

}  // namespace hourglass
