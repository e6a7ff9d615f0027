#include "tradeoff/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace burnish::tools {
namespace {

bool measured(const TradePoint& point) {
  return std::isfinite(point.cost) && std::isfinite(point.error) && point.cost > 0;
}

}  // namespace

std::vector<size_t> pareto_front(std::span<const TradePoint> points) {
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::erase_if(order, [&](size_t i) { return !measured(points[i]); });
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    if (points[a].cost != points[b].cost) return points[a].cost < points[b].cost;
    return points[a].error < points[b].error;
  });
  std::vector<size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const size_t i : order) {
    if (!(points[i].error < least)) continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

bool near_front(std::span<const TradePoint> points, size_t index, const TradeTolerance& tolerance) {
  const TradePoint& point = points[index];
  if (!measured(point)) return false;
  return std::none_of(points.begin(), points.end(), [&](const TradePoint& other) {
    if (!measured(other) || other.cost > point.cost || other.error > point.error) return false;
    return other.cost * (1 + tolerance.cost) < point.cost ||
           other.error + tolerance.error < point.error;
  });
}

}  // namespace burnish::tools
