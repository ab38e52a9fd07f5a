#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "io/movie.hpp"
#include "io/render.hpp"
#include "io/xdmf.hpp"

namespace hourglass {
namespace {

constexpr int frames_per_second = 10;

/// Whole sides that are no wall, and orifices.
std::vector<Opening> openings_of(const RunInfo& info) {
  const Patch& p = info.patch;
  std::vector<Opening> openings;
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top}) {
    const Wall wall = info.walls[static_cast<int>(side)];
    const bool middle = side == Side::left && info.left_is_middle();
    if (!middle && (wall == Wall::no_slip || wall == Wall::free_slip)) continue;
    const bool upright = side == Side::left || side == Side::right;
    const double begin = upright ? p.y0 : p.x0;
    openings.push_back({side, begin, begin + (upright ? p.ny : p.nx) * p.h});
  }
  for (const Orifice& o : info.orifices)
    openings.push_back({o.wall, o.centre - o.width / 2, o.centre + o.width / 2});
  return openings;
}

}  // namespace

Picture picture_of(const std::string& field, const Frame& frame, const RunInfo& info,
                   const PictureOptions& options) {
  const FieldInfo& about = field_info(field);
  Picture picture;
  picture.grains = frame.field("grains");
  picture.values = frame.field(field);
  picture.velocity_x = frame.velocity_x;
  picture.velocity_y = frame.velocity_y;
  picture.title = about.label;
  picture.unit = unit_text(about.dimension, info.units);
  picture.velocity_unit = unit_text("L/T", info.units);
  picture.length_unit = unit_text("L", info.units);
  picture.time_unit = unit_text("T", info.units);
  picture.time = frame.t;
  picture.log_scale = about.logarithmic;
  picture.openings = openings_of(info);
  picture.solids = info.solids;
  picture.axial = info.coordinates == Coordinates::axisymmetric;
  picture.overlays = options.overlays;
  picture.slow_speed = info.slow_speed;
  const auto wants = [&](Overlay o) {
    return std::ranges::find(options.overlays, o) != options.overlays.end();
  };
  if (wants(Overlay::quasi_static) && !(info.slow_speed > 0)) {
    throw std::invalid_argument(
        "overlay quasi_static needs the speed 1e-3 sqrt(g d), which this run has not stored: it is of an "
        "earlier "
        "version, or without gravity");
  }
  if (field == "tracer") {
    picture.title =
        info.materials.size() == 2 ? fmt::format("{} share of grains", info.materials[1]) : about.label;
    picture.colours = ColourMap::mixture;
    picture.range = {{0, 1}};
  } else if (field == "grains") {
    picture.show_air = true;
    picture.range = {{0, 1}};
  } else if (!about.logarithmic && about.dimension != std::string("1")) {
    picture.tails = 0.002;  // a few cells at the edge of an orifice or a corner must not bleach the rest
  }
  if (!info.left_is_middle() || options.half) return picture;
  return mirrored(picture, field == "velocity_x");
}

Picture mirrored(const Picture& half, bool odd) {
  Patch patch = half.values.patch();
  const double middle = patch.x0;
  const int n = patch.nx;
  patch.nx *= 2;
  patch.x0 -= n * patch.h;
  const auto doubled = [&](const CellField& f, double sign) {
    if (!f.allocated()) return f;
    CellField out(patch);
    for (int j = 0; j < patch.ny; ++j) {
      for (int i = 0; i < n; ++i) {
        out(n + i, j) = f(i, j);
        out(n - 1 - i, j) = sign * f(i, j);
      }
    }
    return out;
  };
  Picture whole = half;
  whole.values = doubled(half.values, odd ? -1 : 1);
  whole.grains = doubled(half.grains, 1);
  whole.velocity_x = doubled(half.velocity_x, -1);
  whole.velocity_y = doubled(half.velocity_y, 1);
  whole.openings.clear();
  for (const Opening& o : half.openings) {
    if (o.side == Side::right) {
      whole.openings.push_back(o);
      whole.openings.push_back({Side::left, o.begin, o.end});
    } else if (o.side != Side::left) {
      const bool reaches_middle = o.begin < middle + 1e-6 * patch.h;
      whole.openings.push_back({o.side, reaches_middle ? 2 * middle - o.end : o.begin, o.end});
      if (!reaches_middle) whole.openings.push_back({o.side, 2 * middle - o.end, 2 * middle - o.begin});
    }
  }
  for (Polygon outline : half.solids) {
    for (auto& corner : outline) corner[0] = 2 * middle - corner[0];
    whole.solids.push_back(outline);
  }
  return whole;
}

namespace {

std::filesystem::path numbered(const std::filesystem::path& run, const char* folder, const std::string& field,
                               int number) {
  return run / folder / fmt::format("{}_{:04}.png", field, number);
}

void tell(const std::filesystem::path& path) {
  fmt::print("{}\n", path.string());
  std::fflush(stdout);
}

}  // namespace

std::filesystem::path snapshot_path(const std::filesystem::path& run, const std::string& field, int number) {
  return numbered(run, "snapshots", field, number);
}
std::filesystem::path picture_path(const std::filesystem::path& run, const std::string& field, int number) {
  return numbered(run, "pictures", field, number);
}
std::filesystem::path video_frame_path(const std::filesystem::path& run, const std::string& field,
                                       int number) {
  return numbered(run, "frames", field, number);
}

int render_run(const std::filesystem::path& run, const RenderOptions& options) {
  const FieldReader reader(run);
  if (reader.times().empty()) throw std::runtime_error(fmt::format("{}: no frames", run.string()));
  const std::vector<int> frames = frames_at(reader.times(), options.times);
  for (const std::string& field : options.fields.empty() ? reader.names(frames.front()) : options.fields) {
    field_info(field);
    const auto picture = [&](int frame) {
      return picture_of(field, reader.read(frame, {"grains", field}), reader.info(), options);
    };
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const int frame : frames) {
      const auto extremes = shown_extremes(picture(frame));
      lo = std::min(lo, extremes[0]);
      hi = std::max(hi, extremes[1]);
    }
    const auto scaled = [&](int frame) {
      Picture one = picture(frame);
      if (!one.range) one.range = nice_range(lo, hi, one.log_scale);
      return one;
    };
    std::array<int, 2> size{0, 0};
    for (const int frame : frames) {
      if (!options.animate) break;
      const auto one = size_of(scaled(frame));
      for (int c = 0; c < 2; ++c)
        size[c] = std::max(size[c], one[c] + one[c] % 2);  // even, as encoders want it
    }
    std::vector<std::filesystem::path> drawn;
    for (const int frame : frames) {
      Picture one = scaled(frame);
      one.least_size = size;
      drawn.push_back(options.animate ? video_frame_path(run, field, frame)
                                      : picture_path(run, field, frame));
      std::filesystem::create_directories(drawn.back().parent_path());
      render_png(one, drawn.back());
      tell(drawn.back());
    }
    if (!options.animate) continue;
    const std::filesystem::path video = run / (field + ".ogv");
    write_movie(drawn, video, frames_per_second);
    tell(video);
    fmt::print("As MP4: ffmpeg -framerate {} -i '{}' -pix_fmt yuv420p '{}'\n", frames_per_second,
               (run / "frames" / (field + "_%04d.png")).string(), (run / (field + ".mp4")).string());
  }
  return 0;
}

}  // namespace hourglass
