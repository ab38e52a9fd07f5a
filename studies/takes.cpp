#include "studies/takes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

#include "studies/beverloo.hpp"

namespace hourglass {
namespace {

using Points = std::span<const TablePoint>;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double mean(Points p) {
  double sum = 0;
  for (const TablePoint& point : p) sum += point.y;
  return sum / static_cast<double>(p.size());
}
double least(Points p) { return std::ranges::min_element(p, {}, &TablePoint::y)->y; }
double most(Points p) { return std::ranges::max_element(p, {}, &TablePoint::y)->y; }

double largest_step(Points p, double sign) {
  double size = 0, step = 0;
  for (const TablePoint& point : p) size += std::abs(point.y) / static_cast<double>(p.size());
  for (std::size_t i = 1; i < p.size(); ++i) step = std::max(step, sign * (p[i].y - p[i - 1].y) / size);
  return step;
}

struct Dip {
  double size = 0, at = unknown;
};
Dip dip_of(Points p) {
  Dip dip;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const double y = p[i].y, size = std::min(most(p.first(i)), most(p.subspan(i + 1))) / y - 1;
    if (size > dip.size) dip = {size, p[i].x};
  }
  return dip;
}

double order(Points p) {
  const std::size_t n = p.size();
  return std::log((p[n - 2].y - p[n - 3].y) / (p[n - 1].y - p[n - 2].y)) / std::log(p[n - 1].x / p[n - 2].x);
}

BeverlooFit beverloo(Points p, std::optional<double> k) {
  std::vector<DischargePoint> points;
  for (const TablePoint& point : p) points.push_back(discharge_point(*point.scene, point.y));
  const double m = p[0].scene->axisymmetric() ? 2.5 : 1.5;
  return fit_beverloo(points, {k, m}, m);
}
double misfit(Points p, std::optional<double> k) {
  double rate = 0;
  for (const TablePoint& point : p)
    rate += discharge_point(*point.scene, point.y).rate / static_cast<double>(p.size());
  return beverloo(p, k).residual / rate;
}

struct Take {
  std::size_t least_points;
  std::function<double(Points)> number;
};
const std::map<std::string, Take> takes{
    {"only", {1, [](Points p) { return p.size() == 1 ? p[0].y : unknown; }}},
    {"mean", {1, mean}},
    {"min", {1, least}},
    {"max", {1, most}},
    {"spread", {2, [](Points p) { return (most(p) - least(p)) / mean(p); }}},
    {"largest_rise", {2, [](Points p) { return largest_step(p, 1); }}},
    {"largest_fall", {2, [](Points p) { return largest_step(p, -1); }}},
    {"dip", {3, [](Points p) { return dip_of(p).size; }}},
    {"dip_at", {3, [](Points p) { return dip_of(p).at; }}},
    {"last_change", {2, [](Points p) { return std::abs(1 - p[p.size() - 2].y / p.back().y); }}},
    {"order", {3, order}},
    {"beverloo_C", {3, [](Points p) { return beverloo(p, {}).value[0]; }}},
    {"beverloo_k", {3, [](Points p) { return beverloo(p, {}).value[1]; }}},
    {"beverloo_k_interval", {3, [](Points p) { return beverloo(p, {}).interval[1]; }}},
    {"beverloo_misfit", {3, [](Points p) { return misfit(p, {}); }}},
    {"beverloo_misfit_k0", {3, [](Points p) { return misfit(p, 0.0); }}},
};

}  // namespace

double take(const std::string& word, Points points) {
  const auto at = takes.find(word);
  if (at == takes.end()) throw std::invalid_argument("no take: " + word);
  if (points.size() < at->second.least_points ||
      !std::ranges::all_of(points, [](const TablePoint& p) { return std::isfinite(p.y); }))
    return unknown;
  return at->second.number(points);
}

}  // namespace hourglass
