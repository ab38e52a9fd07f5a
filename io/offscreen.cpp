#include "io/offscreen.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextScene.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkImageShrink3D.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkRenderer.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

#include "io/files.hpp"

namespace hourglass {
namespace {

/// Passes VTK's messages on, but for the one of GLEW, which looks for an X11 display, misses it and works.
class Messages : public vtkOutputWindow {
 public:
  static Messages* New();
  vtkTypeMacro(Messages, vtkOutputWindow);
  void DisplayText(const char* text) override {
    if (std::string(text).find("GLEW") == std::string::npos) std::cerr << text;
  }
};
vtkStandardNewMacro(Messages);

void make_context_current() {
  const auto check = [](bool good, const char* what) {
    if (!good) throw NoGraphics(fmt::format("{} (EGL error {:#x})", what, eglGetError()));
  };
  const auto get_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  check(get_display, "this EGL knows no platforms");
  const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  check(display != EGL_NO_DISPLAY, "no EGL display without a screen; install libgl1-mesa-dri");
  check(eglInitialize(display, nullptr, nullptr), "EGL does not start; install libgl1-mesa-dri");
  check(eglBindAPI(EGL_OPENGL_API), "EGL without desktop OpenGL");
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config;
  EGLint count = 0;
  check(eglChooseConfig(display, wanted, &config, 1, &count) && count > 0,
        "EGL without an OpenGL configuration");
  const EGLint core[] = {EGL_CONTEXT_MAJOR_VERSION,
                         3,
                         EGL_CONTEXT_MINOR_VERSION,
                         2,
                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                         EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, core);
  check(context != EGL_NO_CONTEXT, "no OpenGL 3.2");
  check(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context), "OpenGL needs a surface here");
}

struct Window {
  vtkNew<vtkGenericOpenGLRenderWindow> window;

  Window() {
    make_context_current();
    vtkNew<Messages> messages;
    vtkLogger::SetStderrVerbosity(
        vtkLogger::VERBOSITY_OFF);  // it would print what Messages has already sorted
    vtkOutputWindow::SetInstance(messages);
    window->SetOffScreenRendering(true);
    window->SetReadyForRendering(true);
    window->SetIsCurrent(true);
    window->InitializeFromCurrentContext();
  }
};

/// A picture as the bytes of a PNG file.
std::string encoded(vtkImageData* picture, int halved) {
  vtkNew<vtkImageShrink3D> smaller;
  smaller->SetInputData(picture);
  smaller->SetShrinkFactors(1 << halved, 1 << halved, 1);
  smaller->MeanOn();
  vtkNew<vtkPNGWriter> png;
  if (halved > 0)
    png->SetInputConnection(smaller->GetOutputPort());
  else
    png->SetInputData(picture);
  png->WriteToMemoryOn();
  png->Write();
  vtkUnsignedCharArray* bytes = png->GetResult();
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
          static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

}  // namespace

std::string png_of(vtkAbstractContextItem& item, int width, int height, Edges edges, int halved) {
  static Window shared;  // a constructor that throws is tried again by the next call
  vtkGenericOpenGLRenderWindow& window = *shared.window;

  vtkNew<vtkContextActor> actor;
  actor->GetScene()->AddItem(&item);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  renderer->AddActor(actor);
  window.SetMultiSamples(edges == Edges::smooth ? 4 : 0);
  window.SetSize(width, height);
  window.AddRenderer(renderer);

  vtkNew<vtkWindowToImageFilter> picture;
  picture->SetInput(&window);
  picture->ReadFrontBufferOff();
  picture->Update();  // all of it: what follows would ask for a part, which this filter cannot give
  std::string bytes = encoded(picture->GetOutput(), halved);
  window.RemoveRenderer(renderer);
  actor->GetScene()->RemoveItem(&item);
  return bytes;
}

std::string smaller_png(const std::filesystem::path& path, int halved) {
  vtkNew<vtkPNGReader> reader;
  if (!reader->CanReadFile(path.c_str()))
    throw std::runtime_error(fmt::format("{}: no picture", path.string()));
  reader->SetFileName(path.c_str());
  reader->Update();
  return encoded(reader->GetOutput(), halved);
}

void draw_png(vtkAbstractContextItem& item, int width, int height, const std::filesystem::path& path,
              Edges edges) {
  const std::string bytes = png_of(item, width, height, edges);
  if (!path.empty()) write_atomically(path, bytes);
}

void style_text(vtkTextProperty* text, int size) {
  // VTK's own fonts lack √ and superscripts.
  static const char* const font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  static const bool there = std::filesystem::exists(font);
  if (there) {
    text->SetFontFamily(VTK_FONT_FILE);
    text->SetFontFile(font);
  } else {
    text->SetFontFamilyToArial();
  }
  text->SetFontSize(size);
  text->SetColor(40 / 255.0, 40 / 255.0, 40 / 255.0);
}

void draw_text(vtkContext2D* context, const std::string& text, double x, double y, int size, Align across,
               Align up) {
  if (text.empty()) return;
  vtkNew<vtkTextProperty> property;
  style_text(property, size);
  property->SetJustification(static_cast<int>(across));
  property->SetVerticalJustification(static_cast<int>(up));
  context->ApplyTextProp(property);
  context->DrawString(float(std::lround(x)), float(std::lround(y)), text);
}

int text_width(const std::string& text, int size) {
  if (text.empty()) return 0;
  vtkNew<vtkTextProperty> property;
  style_text(property, size);
  int box[4] = {0, 0, 0, 0};
  vtkTextRenderer::GetInstance()->GetBoundingBox(property, text, box, 72);
  return box[1] - box[0] + 1;
}

vtkSmartPointer<vtkImageData> upright_text(const std::string& text, int size) {
  vtkNew<vtkTextProperty> property;
  style_text(property, size);
  vtkNew<vtkImageData> level;
  auto turned = vtkSmartPointer<vtkImageData>::New();
  int extent[2];
  vtkTextRenderer::GetInstance()->RenderString(property, text, level, extent, 72);
  const int w = extent[0], h = extent[1];
  turned->SetDimensions(h, w, 1);
  turned->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const auto* from = static_cast<unsigned char*>(level->GetScalarPointer(x, y, 0));
      std::copy(from, from + 4, static_cast<unsigned char*>(turned->GetScalarPointer(h - 1 - y, x, 0)));
    }
  }
  return turned;
}

}  // namespace hourglass
