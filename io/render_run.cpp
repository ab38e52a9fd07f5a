#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "io/render.hpp"
#include "io/xdmf.hpp"

namespace hourglass {
namespace {

/// Whole sides that are no wall, and orifices.
std::vector<Opening> openings_of(const RunInfo& info) {
  const Patch& p = info.patch;
  std::vector<Opening> openings;
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top}) {
    const Wall wall = info.walls[static_cast<int>(side)];
    if (wall == Wall::no_slip || wall == Wall::free_slip) continue;
    const bool upright = side == Side::left || side == Side::right;
    const double begin = upright ? p.y0 : p.x0;
    openings.push_back({side, begin, begin + (upright ? p.ny : p.nx) * p.h});
  }
  for (const Orifice& o : info.orifices)
    openings.push_back({o.wall, o.centre - o.width / 2, o.centre + o.width / 2});
  return openings;
}

std::vector<int> frames_at(const std::vector<double>& all, const std::vector<double>& wanted) {
  std::vector<int> frames;
  for (int k = 0; k < static_cast<int>(all.size()) && wanted.empty(); ++k) frames.push_back(k);
  const double slack = 1e-6 * (all.back() - all.front());
  for (const double t : wanted) {
    if (!(t >= all.front() - slack && t <= all.back() + slack)) {
      throw std::invalid_argument(fmt::format("time {} is outside the run, whose frames go from {} to {}", t,
                                              all.front(), all.back()));
    }
    const auto nearer = [t](double a, double b) { return std::abs(a - t) < std::abs(b - t); };
    frames.push_back(static_cast<int>(std::min_element(all.begin(), all.end(), nearer) - all.begin()));
  }
  return frames;
}

}  // namespace

Picture picture_of(const std::string& field, const Frame& frame, const RunInfo& info) {
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
  if (field == "tracer") {
    picture.title =
        info.materials.size() == 2 ? fmt::format("{} share of grains", info.materials[1]) : about.label;
    picture.colours = ColourMap::mixture;
    picture.range = {{0, 1}};
  } else if (field == "grains") {
    picture.show_air = true;
    picture.range = {{0, 1}};
  }
  return picture;
}

std::filesystem::path snapshot_path(const std::filesystem::path& run, const std::string& field, int number) {
  return run / "snapshots" / fmt::format("{}_{:04}.png", field, number);
}

int render_run(const std::filesystem::path& run, const std::vector<std::string>& fields,
               const std::vector<double>& times) {
  const FieldReader reader(run);
  if (reader.times().empty()) throw std::runtime_error(fmt::format("{}: no frames", run.string()));
  const std::vector<int> frames = frames_at(reader.times(), times);
  std::filesystem::create_directories(run / "snapshots");
  for (const std::string& field : fields.empty() ? reader.names(frames.front()) : fields) {
    field_info(field);
    const auto picture = [&](int frame) {
      return picture_of(field, reader.read(frame, {"grains", field}), reader.info());
    };
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (const int frame : frames) {
      const auto extremes = shown_extremes(picture(frame));
      lo = std::min(lo, extremes[0]);
      hi = std::max(hi, extremes[1]);
    }
    for (const int frame : frames) {
      Picture one = picture(frame);
      if (!one.range) one.range = nice_range(lo, hi, one.log_scale);
      const std::filesystem::path path =
          reader.info().snapshots_are_frames
              ? snapshot_path(run, field, frame)
              : run / "snapshots" / fmt::format("{}_t{:.9g}.png", field, reader.times()[frame]);
      render_png(one, path);
      fmt::print("{}\n", path.string());
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace hourglass
