#include "tradeoff/preset_choice.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace burnish::tools {
namespace {

PresetCandidate measured(std::vector<double> ms, std::vector<double> errors) {
  PresetCandidate candidate;
  candidate.frame_ms = std::move(ms);
  candidate.relative_l2 = std::move(errors);
  return candidate;
}

TEST(PresetChoice, ScenesWeighTheSame) {
  // The second scene is a hundred times as slow and a tenth as wrong; twice the time is twice.
  const std::vector<PresetMean> means =
      preset_means({measured({1, 100}, {0.4, 0.04}), measured({2, 100}, {0.1, 0.04}),
                    measured({1, 200}, {0.4, 0.01})});
  ASSERT_EQ(means.size(), 3u);
  EXPECT_NEAR(means[0].cost, 1, 1e-12);
  EXPECT_NEAR(means[1].cost, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(means[2].cost, means[1].cost, 1e-12);
  EXPECT_NEAR(means[0].error, std::sqrt(0.4 * 0.04), 1e-12);
  EXPECT_NEAR(means[2].error, means[1].error, 1e-12);
}

TEST(PresetChoice, CostIsToldByTheCheapestOfEachScene) {
  const std::vector<PresetMean> means =
      preset_means({measured({1, 30}, {0.1, 0.1}), measured({2, 10}, {0.1, 0.1})});
  EXPECT_NEAR(means[0].cost, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(means[1].cost, std::sqrt(2.0), 1e-12);
}

TEST(PresetChoice, TheMostAccurateOfABudget) {
  const std::vector<PresetMean> means = {{1, 0.2}, {1.4, 0.1}, {1.6, 0.05}, {4, 0.02}, {3, 0.0205}};
  EXPECT_EQ(most_accurate_within(means, 1, 0), 0u);
  EXPECT_EQ(most_accurate_within(means, 1.5, 0), 1u);
  EXPECT_EQ(most_accurate_within(means, 5, 0), 3u);
  // 2.5 % more error for three quarters of the time.
  EXPECT_EQ(most_accurate_within(means, 5, 0.03), 4u);
}

TEST(PresetChoice, NoneFitsABudgetBelowTheCheapest) {
  EXPECT_EQ(most_accurate_within({{1, 0.2}}, 0.5, 0), 1u);
  EXPECT_TRUE(preset_means({}).empty());
}

/// The qualities are chosen from the candidates, so that the station can find them.
TEST(PresetChoice, EachQualityIsACandidate) {
  const std::vector<PresetCandidate> candidates = preset_candidates();
  std::set<std::string> names;
  for (const PresetCandidate& candidate : candidates) names.insert(candidate.name);
  EXPECT_EQ(names.size(), candidates.size());
  for (const Quality quality : {Quality::fast, Quality::balanced, Quality::accurate}) {
    const ShadingOptions wanted = shading_options(quality);
    int found = 0;
    for (const PresetCandidate& candidate : candidates) {
      const ShadingOptions& own = candidate.shading;
      found += own.specular.taps == wanted.specular.taps &&
               own.specular.lobes == wanted.specular.lobes &&
               own.environment_taps == wanted.environment_taps &&
               own.ladder_reach == wanted.ladder_reach;
    }
    EXPECT_EQ(found, 1) << static_cast<int>(quality);
  }
}

}  // namespace
}  // namespace burnish::tools
