#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "tradeoff/grid.h"
#include "tradeoff/trial.h"

/// The cheapest settings that are accurate enough, or the most accurate ones that are fast enough.
namespace burnish::tools {

/// A scene to tune on: `views` eyes around its camera, and as many between them for the check.
TrialScene tuning_scene(ProceduralScene scene, const std::string& environment, const Image& map,
                        int views);

/// One of both is above 0.
struct TuneTarget {
  double error = 0;  ///< relative L2, at most
  double ms = 0;     ///< a frame, at most
};

/// What is left to chance: a promise is made of what is met by so much. Of errors, because vertices
/// and views are drawn, and the error of a brushed scene differs by view; of times, because
/// machines are noisy.
inline constexpr double kErrorMargin = 0.2, kTimeMargin = 0.1;

/// Eyes of a run, and of a check. With half as many, four of 21 promises were broken
/// (docs/tuning.md).
inline constexpr int kTuningViews = 4;

struct TriedPoint {
  GridPoint point;
  TrialOutcome outcome;
  std::optional<TrialOutcome> check = {};
};

struct TuneResult {
  std::vector<TriedPoint> tried;
  std::optional<size_t> chosen;   ///< of those; none: the target is out of reach
  std::optional<size_t> nearest;  ///< of those tried, the most accurate, or the fastest
};

/// How points are tried; `step` hears of each point of the grid that is done with.
struct TuneCalls {
  std::function<TrialOutcome(const Settings&)> run;    ///< Trial::run
  std::function<TrialOutcome(const Settings&)> check;  ///< Trial::check
  std::function<void(size_t done, size_t of)> step = {};
};

/// Points are tried from the cheap ones on, but those of which another that is no dearer in any
/// dial meets the target (or, for a time, is too slow already). The best of them by run() is
/// checked; where it fails, those that it had ruled out are tried, and the next is checked, until
/// one holds.
TuneResult tune(const std::vector<GridPoint>& grid, const TuneTarget& target,
                const TuneCalls& calls);

/// What of a trial's error is promised: the error itself, and twice what the truth's noise may
/// hide.
double promised_error(const TrialOutcome& outcome);

}  // namespace burnish::tools
