#pragma once

#include <span>
#include <vector>

namespace burnish::tools {

/// A point of a trade between a cost and an error; less is better of both. One whose cost or error
/// is not finite, or whose cost is not above 0, was not measured and takes no part.
struct TradePoint {
  double cost = 0;
  double error = 0;
};

/// Indices of the Pareto front, by rising cost: the points than which no other is better in one and
/// as good in the other. Of equal points the first.
std::vector<size_t> pareto_front(std::span<const TradePoint> points);

/// Differences that mean nothing.
struct TradeTolerance {
  double cost = 0.05;  ///< as a fraction: times are not measured more closely
  double error = 0;    ///< absolute: the truth's noise
};

/// Whether a point is on the front as far as one can tell: no other is at least as good in both and
/// better in one by more than the tolerance. False for a point that was not measured.
bool near_front(std::span<const TradePoint> points, size_t index, const TradeTolerance& tolerance);

}  // namespace burnish::tools
