#include "tradeoff/tuner.h"

#include <algorithm>

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
  /// Of a point that `tried` is no dearer than: whether it need not be run.
  bool rules_out(const TriedPoint& tried) const {
    if (target_.error > 0) return met(tried.outcome) && (!tried.check || met(*tried.check));
    return tried.outcome.frame_ms > target_.ms;
  }

 private:
  TuneTarget target_;
};

/// Runs what is not run yet and not ruled out.
void run_points(const std::vector<GridPoint>& grid, const Target& target, const TuneCalls& calls,
                std::vector<bool>& was_run, TuneResult& result) {
  for (size_t i = 0; i < grid.size(); ++i) {
    const auto ruled_out = [&](const TriedPoint& tried) {
      return no_dearer(tried.point, grid[i]) && target.rules_out(tried);
    };
    if (!was_run[i] && std::none_of(result.tried.begin(), result.tried.end(), ruled_out)) {
      result.tried.push_back({grid[i], calls.run(grid[i].settings), {}});
      was_run[i] = true;
    }
    if (calls.step) calls.step(i + 1, grid.size());
  }
}

/// The best that meets the target and is not checked yet.
std::optional<size_t> best_unchecked(const std::vector<TriedPoint>& tried, const Target& target) {
  std::optional<size_t> best;
  for (size_t i = 0; i < tried.size(); ++i) {
    if (tried[i].check || !target.met(tried[i].outcome)) continue;
    if (!best || target.cost(tried[i].outcome) < target.cost(tried[*best].outcome)) best = i;
  }
  return best;
}

/// By the check, where there is one.
std::optional<size_t> nearest_of(const std::vector<TriedPoint>& tried, const Target& target) {
  std::optional<size_t> nearest;
  const auto miss = [&](size_t i) {
    return target.miss(tried[i].check ? *tried[i].check : tried[i].outcome);
  };
  for (size_t i = 0; i < tried.size(); ++i)
    if (!nearest || miss(i) < miss(*nearest)) nearest = i;
  return nearest;
}

}  // namespace

TrialScene tuning_scene(ProceduralScene scene, const std::string& environment, const Image& map,
                        int views) {
  TrialScene result;
  const std::vector<Vector3f> eyes = eyes_around(scene.camera, 2 * views);
  for (size_t i = 0; i < eyes.size(); ++i)
    (i % 2 == 0 ? result.eyes : result.check_eyes).push_back(eyes[i]);
  result.scene = std::move(scene);
  result.environment = environment;
  result.map = map;
  return result;
}

double promised_error(const TrialOutcome& outcome) {
  return outcome.error.without_noise + 2 * outcome.error.standard_error;
}

TuneResult tune(const std::vector<GridPoint>& grid, const TuneTarget& wanted,
                const TuneCalls& calls) {
  const Target target(wanted);
  TuneResult result;
  std::vector<bool> was_run(grid.size());
  while (!result.chosen) {
    // Again after each check that failed: what it ruled out may be needed now.
    run_points(grid, target, calls, was_run, result);
    const std::optional<size_t> best = best_unchecked(result.tried, target);
    if (!best) break;
    TriedPoint& tried = result.tried[*best];
    tried.check = calls.check(tried.point.settings);
    if (target.met(*tried.check)) result.chosen = best;
  }
  result.nearest = nearest_of(result.tried, target);
  return result;
}

}  // namespace burnish::tools
