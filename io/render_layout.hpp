#pragma once
// Where everything of a picture goes. For the files that draw pictures only.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/offscreen.hpp"
#include "io/render.hpp"
#include "io/render_ground.hpp"
#include "io/scales.hpp"

namespace hourglass {

// Sizes in pixels.
inline constexpr int margin = 26, wall = 6, tick = 10, gap = 10, bar_width = 32;
inline constexpr int key_width = 52;  // of an overlay's sign in the legend

/// A text above the domain.
struct Note {
  std::string text;
  int size = tick_font;          ///< of the font
  std::optional<Overlay> key{};  ///< whose sign stands before it
  int x = 0, y = 0;              ///< its lower left corner

  int width() const { return text_width(text, size) + (key ? key_width + gap : 0); }
};

/// Where everything goes, in pixels from the lower left corner.
struct Layout {
  int width = 0, height = 0;
  int x = 0, y = 0, w = 0, h = 0;    ///< the domain
  double cell = 1;                   ///< pixels to a cell
  bool bar_below = false;            ///< the domain is too low for a colour bar at its side
  bool under = false, over = false;  ///< there are values beyond the range
  int bar_x = 0, bar_y = 0, bar_w = 0, bar_h = 0;
  std::vector<Tick> x_ticks, y_ticks, bar_ticks;
  std::string bar_title;
  std::vector<Note> notes;               ///< above the domain
  std::shared_ptr<const Ground> ground;  ///< of the picture
};

Layout layout_of(const Picture& picture, const ColourScale& scale);

/// Width of the widest label.
int widest(const std::vector<Tick>& ticks);

}  // namespace hourglass
