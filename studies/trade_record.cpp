#include "studies/trade_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>

#include "io/csv.hpp"
#include "io/files.hpp"
#include "solver/diagnostics.hpp"
#include "solver/solids.hpp"

namespace hourglass {
namespace {

constexpr int samples = 20, columns = 64, most_rows = 256, bins = 40;

/// Bilinear between the points of a field, level beyond the outermost; x, y in cells from the first point.
template <class F>
double read(const F& f, double x, double y) {
  const double a = std::clamp(x, 0.0, f.nx() - 1.0), b = std::clamp(y, 0.0, f.ny() - 1.0);
  const int i = std::min(static_cast<int>(a), f.nx() - 2), j = std::min(static_cast<int>(b), f.ny() - 2);
  const double s = a - i, t = b - j;
  return (1 - t) * ((1 - s) * f(i, j) + s * f(i + 1, j)) + t * ((1 - s) * f(i, j + 1) + s * f(i + 1, j + 1));
}

/// Where a column's share of grains falls through one half, seen from above [L]; 0: nowhere.
double surface_height(const CellField& grains, int i) {
  const Patch& p = grains.patch();
  for (int j = p.ny - 1; j >= 0; --j) {
    const double here = grains(i, j);
    if (here < 0.5) continue;
    if (j == p.ny - 1) return p.y_corner(p.ny);
    return p.y_centre(j) + p.h * (here - 0.5) / (here - grains(i, j + 1));
  }
  return 0;
}

bool in_solid(const std::vector<Polygon>& solids, double x, double y) {
  return std::any_of(solids.begin(), solids.end(), [&](const Polygon& s) {
    bool left = true, right = true;
    for (std::size_t k = 0; k < s.size(); ++k) {
      const double side = turn(s[k], s[(k + 1) % s.size()], {x, y});
      left = left && side >= 0;
      right = right && side <= 0;
    }
    return left || right;
  });
}

/// In the middle of the fill at a third and two thirds of its height, and above each orifice of the bottom; moved
/// sideways out of solids.
std::vector<std::array<double, 2>> probes_of(const Scene& scene) {
  std::array<double, 2> x{HUGE_VAL, -HUGE_VAL}, y{HUGE_VAL, -HUGE_VAL};
  for (const Fill& f : scene.fill)
    if (f.material >= 0)
      for (const auto& corner : f.points) {
        x = {std::min(x[0], corner[0]), std::max(x[1], corner[0])};
        y = {std::min(y[0], corner[1]), std::max(y[1], corner[1])};
      }
  std::vector<std::array<double, 2>> probes;
  if (x[0] < x[1])
    for (const double share : {1 / 3.0, 2 / 3.0})
      probes.push_back({(x[0] + x[1]) / 2, y[0] + share * (y[1] - y[0])});
  for (const Orifice& o : scene.orifices)
    if (o.wall == Side::bottom) probes.push_back({o.centre, 2 * o.width});
  const std::vector<Polygon> solids = solids_of(scene);
  for (auto& probe : probes)
    for (int k = 0; k < 20 && in_solid(solids, probe[0], probe[1]); ++k) {
      probe[0] += scene.width / 20;
      if (probe[0] > scene.width) probe[0] -= scene.width;
    }
  return probes;
}

}  // namespace

double first_of(const Record& record, const char* quantity) {
  const auto at = record.find(quantity);
  return at == record.end() || at->second.empty() ? NAN : at->second.front();
}

double size_of(const Quantity& quantity, const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += quantity.relative ? v * v : std::abs(v);
  return quantity.relative ? std::sqrt(sum)
                           : sum / static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

namespace {

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) throw std::invalid_argument("records of different scenes");
  std::vector<double> out(a.size());
  std::transform(a.begin(), a.end(), b.begin(), out.begin(), std::minus<>());
  return out;
}

}  // namespace

double distance(const Quantity& quantity, const Record& run, const Record& reference) {
  const auto a = run.find(quantity.key), b = reference.find(quantity.key);
  if (a == run.end() || b == reference.end()) return NAN;
  const double apart = size_of(quantity, difference(a->second, b->second));
  return quantity.relative ? apart / size_of(quantity, b->second) : apart;
}

ReferenceQuantity reference_of(const Quantity& quantity, const std::vector<double>& coarse,
                               const std::vector<double>& middle, const std::vector<double>& fine) {
  const std::vector<double> first = difference(middle, coarse), last = difference(fine, middle);
  double along = 0;
  for (std::size_t k = 0; k < last.size(); ++k) along += first[k] * last[k];
  // The sequence of a single number that moves as far, and to the same side or back.
  const double a = size_of(quantity, first), b = size_of(quantity, last);
  const Richardson r = richardson(std::array{0.0, a, a + (along < 0 ? -b : b)});
  ReferenceQuantity out{fine, r.order, r.error_bar, r.doubt};
  if (r.order > 0 && b > 0)
    for (std::size_t k = 0; k < fine.size(); ++k) out.values[k] += last[k] / (std::pow(2, r.order) - 1);
  if (quantity.relative) out.error_bar /= size_of(quantity, out.values);
  return out;
}

void write_record(const std::filesystem::path& path, const Record& record) {
  std::string text = csv_row({"quantity", "index", "value"});
  for (const auto& [key, values] : record)
    for (std::size_t k = 0; k < values.size(); ++k)
      text += csv_row({key, fmt::format("{}", k), fmt::format("{}", values[k])});
  write_atomically(path, text);
}

Record read_record(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw std::runtime_error(path.string() + ": cannot be read; remove its row of runs.csv, or use --force");
  const std::vector<std::vector<std::string>> rows =
      csv_rows(std::string{std::istreambuf_iterator<char>(in), {}});
  Record record;
  for (std::size_t k = 1; k < rows.size(); ++k) record[rows[k].at(0)].push_back(std::stod(rows[k].at(2)));
  return record;
}

double Recorder::sample_interval(const Scene& whole) { return whole.time.end / samples; }

Recorder::Recorder(const Scene& whole, bool halved)
    : whole_(whole), halved_(halved), developed_(std::min(start_up_time(whole), 0.5 * whole.time.end)),
      probes_(probes_of(whole)), pressure_(probes_.size(), 0.0) {}

Recorder::Place Recorder::place(double x, double y) const {
  if (!halved_) return {x, y, 1};
  const double from_middle = x - whole_.width / 2;
  return {std::abs(from_middle), y, from_middle < 0 ? -1.0 : 1.0};
}

void Recorder::on_fields(const Simulation& simulation) {
  if (simulation.t() < developed_ * (1 - 1e-9)) return;
  const Fields& f = simulation.fields();
  const Patch& p = f.p.patch();
  ++samples_;
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const Place at = place(probes_[k][0], probes_[k][1]);
    pressure_[k] += read(f.p, at.x / p.h - 0.5, at.y / p.h - 0.5);
  }
  if (!velocity_.empty() || simulation.t() < 0.5 * (developed_ + whole_.time.end) * (1 - 1e-9)) return;
  const int rows = std::clamp(static_cast<int>(columns * whole_.height / whole_.width), 4, most_rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const Place at = place((i + 0.5) * whole_.width / columns, (j + 0.5) * whole_.height / rows);
      const double x = at.x / p.h, y = at.y / p.h;
      const bool grains = y <= p.ny && read(f.grains, x - 0.5, y - 0.5) >= 0.5;
      velocity_.push_back(grains ? at.sign * read(f.u, x, y - 0.5) : 0);
      velocity_.push_back(grains ? read(f.v, x - 0.5, y) : 0);
    }
}

void Recorder::at_end(const Simulation& simulation) {
  if (simulation.t() < whole_.time.end * (1 - 1e-9)) return;
  const CellField& grains = simulation.fields().grains;
  std::vector<double> heights;
  for (int i = 0; i < grains.nx(); ++i) heights.push_back(surface_height(grains, i));
  for (int k = 0; k < columns; ++k) {
    const double x = place((k + 0.5) * whole_.width / columns, 0).x / grains.patch().h - 0.5;
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, grains.nx() - 2);
    const double s = std::clamp(x - i, 0.0, 1.0);
    surface_.push_back(((1 - s) * heights[i] + s * heights[i + 1]) / whole_.width);
  }
}

Record Recorder::record(const Summary& summary) const {
  Record r;
  if (!whole_.orifices.empty()) r["discharge"] = {summary.discharge_rate};
  r["quasi_static"] = {summary.quasi_static_fraction};
  if (const auto& limit = summary.extrapolation; limit && !whole_.orifices.empty()) {
    r["discharge"] = {limit->discharge_rate};
    r["quasi_static"] = {limit->quasi_static_fraction};
  }
  r["mass_defect"] = {summary.mass_error};
  if (samples_ > 0 && !probes_.empty()) {
    r["pressure"] = pressure_;
    for (double& p : r["pressure"]) p /= samples_;
  }
  if (!velocity_.empty()) r["velocity"] = velocity_;
  if (surface_.empty()) return r;
  r["surface"] = surface_;
  if (whole_.materials.size() < 2 || whole_.orifices.empty()) return r;

  // What has left by material, at the ends of the bins; the outflow of a row is the mean since the row before.
  const std::size_t materials = whole_.materials.size();
  std::vector<double> gone(materials, 0.0);
  std::vector<std::vector<double>> at_ends(1, gone);
  for (std::size_t k = 1; k < rows_.size(); ++k) {
    const double before = rows_[k - 1].step.t, now = rows_[k].step.t;
    for (double end; at_ends.size() <= bins && (end = whole_.time.end * static_cast<double>(at_ends.size()) /
                                                      bins) <= now * (1 + 1e-12);) {
      std::vector<double> there = gone;
      for (std::size_t m = 0; m < materials; ++m) there[m] += (end - before) * rows_[k].material_outflow[m];
      at_ends.push_back(there);
    }
    for (std::size_t m = 0; m < materials; ++m) gone[m] += (now - before) * rows_[k].material_outflow[m];
  }
  std::vector<double>& shares = r["tracer"];
  for (std::size_t m = 1; m < materials; ++m)
    for (std::size_t b = 1; b < at_ends.size(); ++b) {
      double all = 0;
      for (std::size_t other = 0; other < materials; ++other)
        all += at_ends[b][other] - at_ends[b - 1][other];
      shares.push_back(all > 0 ? (at_ends[b][m] - at_ends[b - 1][m]) / all : 0);
    }
  return r;
}

void add_noise(Simulation& simulation, double speed, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto noise = [&] { return speed * (2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1); };
  Fields& f = simulation.fields();
  for (int j = 0; j < f.p.ny(); ++j)
    for (int i = 1; i < f.p.nx(); ++i) f.u(i, j) += noise();
  for (int j = 1; j < f.p.ny(); ++j)
    for (int i = 0; i < f.p.nx(); ++i) f.v(i, j) += noise();
}

}  // namespace hourglass
