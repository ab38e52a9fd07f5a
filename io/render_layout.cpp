#include "io/render_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hourglass {
namespace {

constexpr int full_width = 1400, tall_height = 1300, least_bar = 420;  // pixels

/// Time, arrows, overlays, and what the colours leave out.
std::vector<Note> notes_of(const Picture& picture, const Ground& ground, double cell_pixels,
                           bool out_of_range) {
  std::vector<Note> notes;
  notes.push_back(
      {picture.time ? fmt::format("t = {} {}", number_text(*picture.time, 4), picture.time_unit) : "steady",
       label_font});
  if (auto note = arrow_note(arrows_of(picture, ground, cell_pixels), picture.velocity_unit); !note.empty())
    notes.push_back({note});
  if (has(picture, Overlay::quasi_static)) {
    notes.push_back({fmt::format("quasi-static: speed < {} {}", number_text(picture.slow_speed, 3),
                                 picture.velocity_unit),
                     tick_font, Overlay::quasi_static});
  }
  if (has(picture, Overlay::streamlines)) notes.push_back({"streamlines", tick_font, Overlay::streamlines});
  if (picture.tails > 0 && out_of_range) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const double value : shown_values(picture)) {
      lo = std::min(lo, value);
      hi = std::max(hi, value);
    }
    notes.push_back({fmt::format("full range: {} to {}", number_text(lo, 3), number_text(hi, 3))});
  }
  return notes;
}

/// Puts notes into rows from the top, `width` wide; returns the height of all.
int arrange(std::vector<Note>& notes, int width) {
  constexpr int row_height = label_font + gap + gap / 2;
  std::vector<int> row_of, ends{0}, members{0};
  for (Note& note : notes) {
    const int start = members.back() == 0 ? 0 : ends.back() + 2 * margin;
    if (start > 0 && start + note.width() > width) {
      ends.push_back(0);
      members.push_back(0);
    }
    note.x = members.back() == 0 ? 0 : start;
    ends.back() = note.x + note.width();
    row_of.push_back(static_cast<int>(members.size()) - 1);
    ++members.back();
  }
  const int rows = static_cast<int>(members.size());
  std::vector<int> placed(rows, 0);
  for (std::size_t k = 0; k < notes.size(); ++k) {  // spread over the width
    const int row = row_of[k], n = members[row];
    if (n > 1) notes[k].x += (width - ends[row]) * placed[row]++ / (n - 1);
    notes[k].y = (rows - 1 - row) * row_height;
  }
  return rows * row_height;
}

}  // namespace

int widest(const std::vector<Tick>& ticks) {
  int w = 0;
  for (const Tick& t : ticks) w = std::max(w, text_width(t.label, tick_font));
  return w;
}

Layout layout_of(const Picture& picture, const ColourScale& scale) {
  const Patch& p = picture.values.patch();
  Layout l;
  l.ground = std::make_shared<const Ground>(picture);
  l.bar_title = picture.unit.empty() ? picture.title : fmt::format("{} [{}]", picture.title, picture.unit);

  for (const double value : shown_values(picture)) {
    l.under |=
        value < scale.lo() - 1e-6 * (scale.hi() - scale.lo()) || (scale.log() && value < 0.999 * scale.lo());
    l.over |= value > scale.hi() + 1e-6 * (scale.hi() - scale.lo());
  }

  // The margins depend on the labels, these on the ticks, these on the size of the domain, and this on the
  // margins: the second turn settles it.
  l.w = full_width - 300;
  l.h = static_cast<int>(std::min<double>(tall_height, l.w * double(p.ny) / p.nx));
  const int tick_line = tick + gap + tick_font, label_line = gap + label_font;
  const int axis = wall + tick_line + label_line;  // height of the x axis with its labels
  int right = 0;
  for (int turn = 0; turn < 2; ++turn) {
    l.bar_below = l.h < least_bar;
    l.x_ticks = linear_ticks(p.x0, p.x0 + p.nx * p.h, std::clamp(l.w / 80, 2, 8));
    if (picture.axial) {
      for (Tick& t : l.x_ticks) t.label = number_text(std::abs(t.value));
    }
    l.y_ticks = linear_ticks(p.y0, p.y0 + p.ny * p.h, std::clamp(l.h / 60, 2, 8));
    const int most = std::clamp(l.bar_below ? l.w / 150 : l.h / 80, 2, 6);
    l.bar_ticks =
        scale.log() ? log_ticks(scale.lo(), scale.hi()) : linear_ticks(scale.lo(), scale.hi(), most);
    l.x = margin + label_line + gap + widest(l.y_ticks) + gap + tick + wall;
    l.y = margin + axis;
    right = margin + wall;
    if (l.bar_below) {
      l.y += margin + bar_width + tick_line + label_line;
      right += widest(l.x_ticks) / 2;
    } else {
      right += margin + bar_width + tick + gap + widest(l.bar_ticks) + gap + label_line;
    }
    l.cell = std::min(double(full_width - l.x - right) / p.nx, double(tall_height) / p.ny);
    l.w = static_cast<int>(std::lround(p.nx * l.cell));
    l.h = static_cast<int>(std::lround(p.ny * l.cell));
  }
  l.bar_x = l.bar_below ? l.x : l.x + l.w + wall + margin;
  l.bar_y = l.bar_below ? margin + label_line + tick_line : l.y;
  l.bar_w = l.bar_below ? l.w : bar_width;
  l.bar_h = l.bar_below ? bar_width : l.h;

  l.notes = notes_of(picture, *l.ground, l.cell, l.under || l.over);
  int header = l.w;
  for (const Note& note : l.notes) header = std::max(header, note.width());
  const int header_height = arrange(l.notes, header);
  l.width = std::max(l.x + l.w + right, header + 2 * margin);
  l.height = std::max(l.y + l.h + wall + header_height + margin, picture.least_size[1]);
  for (Note& note : l.notes) {
    note.x += std::max(margin, std::min(l.x, l.width - margin - header));
    note.y += l.height - margin - header_height + gap;  // from the top, for videos
  }
  l.width = std::max(l.width, picture.least_size[0]);
  return l;
}

}  // namespace hourglass
