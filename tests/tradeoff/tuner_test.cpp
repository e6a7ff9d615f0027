// What tune chooses of made-up trials, and that it keeps its promise on a real scene.

#include "tradeoff/tuner.h"

#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "harness/studio_environment.h"

namespace burnish::tools {
namespace {

struct MadeUp {
  std::array<int, 4> level;
  double error, ms;
  double check_error = -1;  ///< as `error` where it is below 0
};

/// A tuner's grid and its trials. Points are told apart by their lobes.
class MadeUpTrials {
 public:
  explicit MadeUpTrials(std::vector<MadeUp> points) : points_(std::move(points)) {}

  TuneResult tune(const TuneTarget& target) {
    std::vector<GridPoint> grid;
    for (size_t i = 0; i < points_.size(); ++i) {
      Settings settings;
      settings.lobes = static_cast<int>(i);
      grid.push_back({"point", settings, points_[i].level});
    }
    const auto run = [&](const Settings& settings) {
      runs.push_back(settings.lobes);
      return outcome(point_of(settings).error, point_of(settings).ms);
    };
    const auto check = [&](const Settings& settings) {
      checks.push_back(settings.lobes);
      const MadeUp& point = point_of(settings);
      return outcome(point.check_error < 0 ? point.error : point.check_error, point.ms);
    };
    return tools::tune(grid, target, {run, check, [&](size_t done, size_t of) {
                                        EXPECT_LE(done, of);
                                        EXPECT_EQ(of, points_.size());
                                        last_step = done;
                                      }});
  }

  std::vector<int> runs, checks;
  size_t last_step = 0;

 private:
  const MadeUp& point_of(const Settings& settings) const {
    return points_[static_cast<size_t>(settings.lobes)];
  }
  static TrialOutcome outcome(double error, double ms) {
    TrialOutcome outcome;
    outcome.error.without_noise = error;
    outcome.frame_ms = ms;
    return outcome;
  }

  std::vector<MadeUp> points_;
};

int chosen(const TuneResult& result) {
  return result.chosen ? result.tried[*result.chosen].point.settings.lobes : -1;
}
int nearest(const TuneResult& result) {
  return result.nearest ? result.tried[*result.nearest].point.settings.lobes : -1;
}

TEST(Tuner, TakesTheFastestThatIsAccurateEnough) {
  // No point is no dearer than another, so that all are run.
  MadeUpTrials trials({{{0, 3, 0, 0}, 0.05, 4},
                       {{1, 2, 0, 0}, 0.08, 2},
                       {{2, 1, 0, 0}, 0.2, 1},
                       {{3, 0, 0, 0}, 0.01, 8}});
  const TuneResult result = trials.tune({0.1, 0});
  EXPECT_EQ(chosen(result), 1);
  EXPECT_EQ(trials.runs, (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(trials.checks, std::vector{1});
  ASSERT_TRUE(result.tried[1].check);
  EXPECT_FALSE(result.tried[0].check);
  EXPECT_EQ(trials.last_step, 4u);
}

TEST(Tuner, LeavesTheMarginAndTwiceTheNoiseFree) {
  MadeUpTrials just(std::vector<MadeUp>{{{}, (1 - kErrorMargin) * 0.1 * 1.001, 1}});
  EXPECT_EQ(chosen(just.tune({0.1, 0})), -1);
  MadeUpTrials below(std::vector<MadeUp>{{{}, (1 - kErrorMargin) * 0.1 * 0.999, 1}});
  EXPECT_EQ(chosen(below.tune({0.1, 0})), 0);
  MadeUpTrials slow(std::vector<MadeUp>{{{}, 0.1, (1 - kTimeMargin) * 3 * 1.001}});
  EXPECT_EQ(chosen(slow.tune({0, 3})), -1);
  MadeUpTrials fast(std::vector<MadeUp>{{{}, 0.1, (1 - kTimeMargin) * 3 * 0.999}});
  EXPECT_EQ(chosen(fast.tune({0, 3})), 0);
  TrialOutcome noisy;
  noisy.error.without_noise = 0.05;
  noisy.error.standard_error = 0.01;
  EXPECT_DOUBLE_EQ(promised_error(noisy), 0.07);
}

TEST(Tuner, DearerThanOneThatIsAccurateEnoughIsNotRun) {
  MadeUpTrials trials({{{0, 0, 0, 0}, 0.5, 1},
                       {{1, 0, 0, 0}, 0.05, 2},
                       {{1, 1, 0, 0}, 0.01, 3},    // dearer than 1
                       {{0, 1, 0, 0}, 0.06, 2.5},  // not than 1
                       {{2, 1, 1, 1}, 0.01, 9}});  // than both
  EXPECT_EQ(chosen(trials.tune({0.1, 0})), 1);
  EXPECT_EQ(trials.runs, (std::vector{0, 1, 3}));
}

TEST(Tuner, FailedCheckMovesOnToTheNext) {
  MadeUpTrials trials({{{0, 1, 0, 0}, 0.05, 2, 0.15}, {{1, 0, 0, 0}, 0.04, 3}});
  EXPECT_EQ(chosen(trials.tune({0.1, 0})), 1);
  EXPECT_EQ(trials.checks, (std::vector{0, 1}));
}

TEST(Tuner, WhatAFailedCheckRuledOutIsTriedAfterAll) {
  MadeUpTrials trials({{{0, 0, 0, 0}, 0.05, 2, 0.15}, {{1, 0, 0, 0}, 0.02, 3, 0.03}});
  const TuneResult result = trials.tune({0.1, 0});
  EXPECT_EQ(chosen(result), 1);
  EXPECT_EQ(trials.runs, (std::vector{0, 1}));
  EXPECT_EQ(trials.checks, (std::vector{0, 1}));
}

TEST(Tuner, WithoutAnyThatMeetsTheTargetTheNearestIsNamed) {
  const std::vector<MadeUp> points = {
      {{0, 0, 0, 0}, 0.5, 1}, {{1, 0, 0, 0}, 0.3, 3}, {{0, 1, 0, 0}, 0.4, 2}};
  MadeUpTrials by_error(points);
  const TuneResult inaccurate = by_error.tune({0.1, 0});
  EXPECT_EQ(chosen(inaccurate), -1);
  EXPECT_EQ(nearest(inaccurate), 1);
  EXPECT_TRUE(by_error.checks.empty());
  MadeUpTrials by_time(points);
  const TuneResult slow = by_time.tune({0, 0.5});
  EXPECT_EQ(chosen(slow), -1);
  EXPECT_EQ(nearest(slow), 0);
  EXPECT_EQ(by_time.runs, std::vector{0});  // the others are dearer

  // A check tells more than a run.
  MadeUpTrials lucky({{{0, 1, 0, 0}, 0.05, 1, 0.4}, {{1, 0, 0, 0}, 0.2, 2}});
  EXPECT_EQ(nearest(lucky.tune({0.1, 0})), 1);
}

TEST(Tuner, ForATimeTakesTheMostAccurate) {
  MadeUpTrials trials({{{0, 0, 0, 0}, 0.5, 1},
                       {{1, 0, 0, 0}, 0.3, 2},
                       {{0, 1, 0, 0}, 0.2, 2.5},
                       {{2, 0, 0, 0}, 0.1, 9},
                       {{2, 1, 0, 0}, 0.05, 12}});  // dearer than one that is too slow
  EXPECT_EQ(chosen(trials.tune({0, 3})), 2);
  EXPECT_EQ(trials.runs, (std::vector{0, 1, 2, 3}));
}

TEST(Tuner, OfNoPointsNothingIsChosen) {
  const TuneResult result = MadeUpTrials(std::vector<MadeUp>()).tune({0.1, 0});
  EXPECT_FALSE(result.chosen);
  EXPECT_FALSE(result.nearest);
}

TEST(Tuner, PointsOfItsGridGetDearerWithTheirLevels) {
  Material glossy;
  glossy.model = SpecularModel::ward;
  const std::vector<GridPoint> grid = tuning_grid({glossy}, {});
  std::map<std::array<int, 4>, const GridPoint*> by_level;
  for (const GridPoint& point : grid) by_level[point.level] = &point;
  EXPECT_EQ(by_level.size(), grid.size());
  for (const GridPoint& point : grid)
    for (size_t dial = 0; dial < 4; ++dial) {
      std::array<int, 4> level = point.level;
      ++level[dial];
      const auto dearer = by_level.find(level);
      if (dearer == by_level.end()) continue;
      const Settings &a = point.settings, &b = dearer->second->settings;
      EXPECT_LE(a.bake.terms, b.bake.terms);
      EXPECT_LE(a.lobes, b.lobes);
      EXPECT_GE(a.shading.ladder_reach, b.shading.ladder_reach);
      EXPECT_LE(a.shading.specular.taps, b.shading.specular.taps);
      EXPECT_LE(a.shading.environment_taps, b.shading.environment_taps);
      EXPECT_NE(settings_json(a).dump(), settings_json(b).dump());
    }
}

Settings small_settings() {
  Settings settings;
  settings.bake.directions = 64;
  settings.bake.resolution = 16;
  settings.bake.ladder_terms = 12;
  settings.bake.bases = 2;
  settings.bake.training_vertices = 256;
  return settings;
}

/// Tuned on a few vertices; the promise is of all of them, of a bake with no more terms than were
/// chosen, and of views that tune has not seen.
TEST(Tuner, KeepsItsPromiseOnAWholeScene) {
  const ProceduralScene knot = make_knot(1500);
  const std::vector<Vector3f> eyes = eyes_around(knot.camera, 8);
  TrialOptions options;
  options.vertices = 150;
  options.truth = {.noise = 0, .first_samples = 128, .most_samples = 128};
  options.cache.folder.clear();
  options.frames = 1;
  Trial trial({knot, "studio", studio_environment(), {eyes[0], eyes[4]}, {eyes[2], eyes[6]}},
              options);
  std::vector<GridPoint> grid;
  for (const GridPoint& point : tuning_grid(knot.materials, {small_settings()}))
    if (point.level[2] < 2 && point.level[1] % 3 == 0 && point.level[3] == 0) grid.push_back(point);
  const auto run = [&](const Settings& settings) { return trial.run(settings); };
  const auto check = [&](const Settings& settings) { return trial.check(settings); };

  // The most accurate of the grid says what can be met.
  const TuneResult best = tune(grid, {0, std::numeric_limits<double>::max()}, {run, check});
  ASSERT_TRUE(best.chosen);
  const double reachable = promised_error(best.tried[*best.chosen].outcome);
  for (const double factor : {1.3, 2.0}) {  // above 1 / (1 - kErrorMargin)
    const double target = factor * reachable;
    const TuneResult result = tune(grid, {target, 0}, {run, check});
    ASSERT_TRUE(result.chosen) << target;
    const Settings settings = result.tried[*result.chosen].point.settings;
    options.vertices = 0;
    options.most_terms = settings.bake.terms;
    Trial whole({knot, "studio", studio_environment(), {eyes[1], eyes[3], eyes[5], eyes[7]}},
                options);
    const RelativeL2 error = whole.run(settings).error;
    EXPECT_LE(error.without_noise, target) << result.tried[*result.chosen].point.name;
    EXPECT_GT(error.without_noise, 0.02);  // there is something to promise
  }
}

}  // namespace
}  // namespace burnish::tools
