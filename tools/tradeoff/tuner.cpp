#include "tradeoff/tuner.h"

#include <algorithm>
#include <numeric>

namespace burnish::tools {
namespace {

/// Whether a is no dearer than b in any dial.
bool no_dearer(const GridPoint& a, const GridPoint& b) {
  for (size_t i = 0; i < a.level.size(); ++i)
    if (a.level[i] > b.level[i]) return false;
  return true;
}

class Target {
 public:
  explicit Target(const TuneTarget& target) : target_(target) {}

  bool met(const TrialOutcome& outcome) const {
    return target_.error > 0 ? promised_error(outcome) <= (1 - kErrorMargin) * target_.error
                             : outcome.frame_ms <= (1 - kTimeMargin) * target_.ms;
  }
  /// Smaller is better: what is left free.
  double cost(const TrialOutcome& outcome) const {
    return target_.error > 0 ? outcome.frame_ms : promised_error(outcome);
  }
  /// How far it is from the target.
  double miss(const TrialOutcome& outcome) const {
    return target_.error > 0 ? promised_error(outcome) : outcome.frame_ms;
  }
  /// Of a point that `tried` is no dearer than: whether it cannot be chosen.
  bool rules_out(const TriedPoint& tried) const {
    return target_.error > 0 ? met(tried.outcome) : tried.outcome.frame_ms > target_.ms;
  }

 private:
  TuneTarget target_;
};

}  // namespace

double promised_error(const TrialOutcome& outcome) {
  return outcome.error.without_noise + 2 * outcome.error.standard_error;
}

TuneResult tune(const std::vector<GridPoint>& grid, const TuneTarget& wanted,
                const TuneCalls& calls) {
  const Target target(wanted);
  TuneResult result;
  for (size_t i = 0; i < grid.size(); ++i) {
    const bool ruled_out =
        std::any_of(result.tried.begin(), result.tried.end(), [&](const TriedPoint& tried) {
          return no_dearer(tried.point, grid[i]) && target.rules_out(tried);
        });
    if (!ruled_out) result.tried.push_back({grid[i], calls.run(grid[i].settings)});
    if (calls.step) calls.step(i + 1, grid.size());
  }
  std::vector<size_t> order(result.tried.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto outcome = [&](size_t i) -> const TrialOutcome& { return result.tried[i].outcome; };
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return target.cost(outcome(a)) < target.cost(outcome(b)); });
  for (const size_t i : order) {
    if (!target.met(outcome(i))) continue;
    result.tried[i].check = calls.check(result.tried[i].point.settings);
    if (!target.met(*result.tried[i].check)) continue;
    result.chosen = i;
    break;
  }
  const auto nearest = std::min_element(order.begin(), order.end(), [&](size_t a, size_t b) {
    return target.miss(outcome(a)) < target.miss(outcome(b));
  });
  if (nearest != order.end()) result.nearest = *nearest;
  return result;
}

}  // namespace burnish::tools
