#include "tradeoff/pareto.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace burnish::tools {
namespace {

using Indices = std::vector<size_t>;

TEST(ParetoFront, HasThePointsThatNoOtherBeats) {
  const std::vector<TradePoint> points = {{4, 2}, {1, 8}, {2, 9}, {2, 4}, {3, 4}, {8, 1}, {9, 1.5}};
  EXPECT_EQ(pareto_front(points), (Indices{1, 3, 0, 5}));
}

TEST(ParetoFront, OfEqualPointsHasTheFirst) {
  EXPECT_EQ(pareto_front(std::vector<TradePoint>{{1, 1}, {1, 1}, {1, 2}}), (Indices{0}));
}

TEST(ParetoFront, LeavesOutWhatWasNotMeasured) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<TradePoint> points = {{0, 0}, {nan, 0}, {1, nan}, {infinity, 0}, {2, 3}};
  EXPECT_EQ(pareto_front(points), (Indices{4}));
  EXPECT_FALSE(near_front(points, 0, {}));
  EXPECT_TRUE(near_front(points, 4, {}));
  EXPECT_EQ(pareto_front({}), Indices{});
}

TEST(ParetoFront, IsWhatComparingAllPairsFinds) {
  const unsigned seed = 7;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::vector<TradePoint> points(300);
  // Small whole numbers, so that many are equal in one of the two.
  for (TradePoint& point : points) point = {1.0 + random() % 40, 1.0 + random() % 40};
  const Indices front = pareto_front(points);
  for (size_t i = 0; i < points.size(); ++i) {
    bool beaten = false;
    for (size_t j = 0; j < points.size(); ++j) {
      const bool as_good = points[j].cost <= points[i].cost && points[j].error <= points[i].error;
      const bool better = points[j].cost < points[i].cost || points[j].error < points[i].error;
      beaten = beaten || (as_good && (better || j < i));
    }
    EXPECT_EQ(std::find(front.begin(), front.end(), i) == front.end(), beaten) << i;
  }
}

TEST(NearFront, ForgivesLessThanTheToleranceOfEither) {
  const std::vector<TradePoint> points = {{1, .10}, {1.04, .10}, {1.06, .10}, {1, .104}, {1, .106}};
  const TradeTolerance tolerance = {.05, .005};
  EXPECT_TRUE(near_front(points, 0, tolerance));
  EXPECT_TRUE(near_front(points, 1, tolerance));
  EXPECT_FALSE(near_front(points, 2, tolerance));
  EXPECT_TRUE(near_front(points, 3, tolerance));
  EXPECT_FALSE(near_front(points, 4, tolerance));
}

TEST(NearFront, DoesNotForgiveOneForTheOther) {
  // A hair cheaper, but with half the error.
  const std::vector<TradePoint> points = {{1, .2}, {.999, .1}};
  EXPECT_FALSE(near_front(points, 0, {.05, .005}));
}

}  // namespace
}  // namespace burnish::tools
