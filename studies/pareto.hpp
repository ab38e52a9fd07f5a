#pragma once
// Which of many runs are worth their time.
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace hourglass {

struct CostAndError {
  double cost = 0, error = 0;
};

/// The points that no other one beats in both cost and error, by rising cost; of equal ones the first. Points that are
/// not finite are never among them.
inline std::vector<std::size_t> pareto_front(std::span<const CostAndError> points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (std::isfinite(points[k].cost) && std::isfinite(points[k].error)) order.push_back(k);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost < points[b].cost ||
           (points[a].cost == points[b].cost && points[a].error < points[b].error);
  });
  std::vector<std::size_t> front;
  for (const std::size_t k : order)
    if (front.empty() || points[k].error < points[front.back()].error) front.push_back(k);
  return front;
}

}  // namespace hourglass
