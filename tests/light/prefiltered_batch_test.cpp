// eval_prefiltered on vectors: on every instruction set, in float and in double lanes.

// Before any header of Highway.
// clang-format off
#include "sphere/simd.h"
// clang-format on

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/light/prefiltered_environment.h"
#include "harness/studio_environment.h"
#include "light/prefiltered-inl.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr unsigned kSeed = 31;

/// A map so small that lobes from bandwidth 45 on see its pixels.
const PrefilteredEnvironment& studio() {
  static const PrefilteredEnvironment environment = [] {
    PrefilteredEnvironment filtered = prefilter_environment(studio_environment(64));
    filtered.environment_from_world =
        Eigen::AngleAxisf(1, Vector3f(1, 2, 3).normalized()).toRotationMatrix();
    return filtered;
  }();
  return environment;
}

/// Of every width and shape: round, long along x and along y, from hemispheres to a fifth of a
/// pixel.
std::vector<AnisotropicGaussian<float>> random_lobes(size_t count) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> log_bandwidth(-2, 3);
  std::vector<AnisotropicGaussian<float>> lobes(count);
  for (auto& lobe : lobes) {
    lobe.frame = test::random_frame(test::random_direction(random), random).cast<float>();
    lobe.bandwidth_x = std::pow(10.0f, log_bandwidth(random));
    lobe.bandwidth_y =
        random() % 4 == 0 ? lobe.bandwidth_x : std::pow(10.0f, log_bandwidth(random));
  }
  return lobes;
}

template <class T>
struct Blocks {
  BlockLobes<T> lobes;
  BlockArray<T> active;
  BlockRgb<T> result;
};

template <class T>
Blocks<T> block_of(const std::vector<AnisotropicGaussian<float>>& lobes, size_t first) {
  Blocks<T> block;
  for (size_t i = 0; i < kBlock; ++i) {
    const auto& lobe = lobes[first + i];
    block.lobes.x.x[i] = lobe.frame.x.x();
    block.lobes.x.y[i] = lobe.frame.x.y();
    block.lobes.x.z[i] = lobe.frame.x.z();
    block.lobes.z.x[i] = lobe.frame.z.x();
    block.lobes.z.y[i] = lobe.frame.z.y();
    block.lobes.z.z[i] = lobe.frame.z.z();
    block.lobes.bandwidth_x[i] = lobe.bandwidth_x;
    block.lobes.bandwidth_y[i] = lobe.bandwidth_y;
    block.active[i] = 1;
    for (auto& channel : block.result) channel[i] = -1;
  }
  return block;
}

struct Results {
  std::vector<float> red, green, blue;
  Rgb at(size_t i) const { return {red[i], green[i], blue[i]}; }
};

Results by_batch(const std::vector<AnisotropicGaussian<float>>& lobes, int max_taps) {
  std::vector<float> numbers[8];
  for (const auto& lobe : lobes)
    for (size_t k = 0; k < 8; ++k)
      numbers[k].push_back(k < 3    ? lobe.frame.x[int(k)]
                           : k < 6  ? lobe.frame.z[int(k) - 3]
                           : k == 6 ? lobe.bandwidth_x
                                    : lobe.bandwidth_y);
  Results results;
  for (auto* channel : {&results.red, &results.green, &results.blue}) channel->resize(lobes.size());
  batch::eval_prefiltered(studio(),
                          {{numbers[0], numbers[1], numbers[2]},
                           {numbers[3], numbers[4], numbers[5]},
                           numbers[6],
                           numbers[7],
                           {}},
                          max_taps, {results.red, results.green, results.blue});
  return results;
}

/// Directions in float err by up to 2e-7, in a map of pixels 0.1 across, between which the studio's
/// lamps rise from 0 to `brightest`: 2e-6 of that. Twice as much for what else is rounded.
float tolerance() {
  float brightest = 0;
  for (const Rgb& pixel : studio().map.pixels) brightest = std::max(brightest, pixel.maxCoeff());
  return 4e-6f * brightest;
}

/// A test that runs on each instruction set that this processor has, and restores the best one
/// whatever happens.
class PrefilteredBatch : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(batch::use_instruction_set(GetParam())); }
  void TearDown() override { batch::use_instruction_set(""); }
};

std::vector<std::string> sets() {
  const auto views = batch::instruction_sets();
  return {views.begin(), views.end()};
}
INSTANTIATE_TEST_SUITE_P(On, PrefilteredBatch, testing::ValuesIn(sets()),
                         [](const auto& info) { return info.param; });

TEST_P(PrefilteredBatch, EqualsOneByOneInDouble) {
  // No multiple of a block, so that one is incomplete; a multiple for the blocks in double.
  const auto lobes = random_lobes(20 * kBlock);
  const auto odd = std::vector(lobes.begin(), lobes.end() - 11);
  float worst = 0;
  for (const int taps : {1, 2, 5, 32}) {
    const Results results = by_batch(odd, taps);
    for (size_t first = 0; first < lobes.size(); first += kBlock) {
      auto block = block_of<double>(lobes, first);
      HWY_NAMESPACE::eval_prefiltered(hn::ScalableTag<double>(), studio(), kBlock, block.lobes,
                                      block.active, taps, block.result);
      for (size_t i = 0; i < kBlock && first + i < odd.size(); ++i)
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst,
                           std::abs(results.at(first + i)[c] - float(block.result[size_t(c)][i])));
    }
  }
  EXPECT_LT(worst, tolerance()) << "seed " << kSeed;
}

TEST_P(PrefilteredBatch, OneLobeIsOneOfABatch) {
  const auto lobes = random_lobes(100);
  for (const int taps : {1, 3, 32}) {
    const Results results = by_batch(lobes, taps);
    for (size_t i = 0; i < lobes.size(); ++i)
      EXPECT_LT((eval_prefiltered(studio(), lobes[i], taps) - results.at(i)).abs().maxCoeff(),
                tolerance())
          << i << " in " << taps << ", seed " << kSeed;
  }
}

TEST_P(PrefilteredBatch, KeepsAConstantToTheBit) {
  const Rgb color(0.1f, 1.7f, 4.3e4f);
  const PrefilteredEnvironment environment = prefilter_environment(Image(33, 7, color));
  for (const auto& lobe : random_lobes(200))
    for (const int taps : {1, 2, 7, 64})
      ASSERT_EQ(eval_prefiltered(environment, lobe, taps).matrix(), color.matrix())
          << lobe.bandwidth_x << " " << lobe.bandwidth_y << " in " << taps << ", seed " << kSeed;
}

/// Bright below y = 0, by pixels of a quarter of a degree, and dim above.
PrefilteredEnvironment bright_below() {
  Image map(1440, 720, Rgb::Constant(1));
  for (int y = map.height / 2; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) map.at(x, y) = Rgb::Constant(100);
  return prefilter_environment(map);
}

/// Lobes that are long across the horizon of y, a deviation and a half above it, as are Gaussians
/// that were cut there.
BlockLobes<float> lobes_at_horizon() {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> azimuth(0, 2 * kPi<float>), width(0.03f, 0.12f);
  std::vector<AnisotropicGaussian<float>> lobes(kBlock);
  for (auto& lobe : lobes) {
    const float around = azimuth(random), deviation = width(random), height = 1.5f * deviation;
    const Vector3f level(std::cos(around), 0, std::sin(around));
    lobe.frame.z = std::cos(height) * level + std::sin(height) * Vector3f::UnitY();
    lobe.frame.x = std::cos(height) * Vector3f::UnitY() - std::sin(height) * level;
    lobe.frame.y = lobe.frame.z.cross(lobe.frame.x);
    lobe.bandwidth_x = 0.5f / (deviation * deviation);
    lobe.bandwidth_y = 100 * lobe.bandwidth_x;
  }
  return block_of<float>(lobes, 0).lobes;
}

TEST(PrefilteredBlock, SeesNothingBelowAHorizon) {
  const PrefilteredEnvironment environment = bright_below();
  const BlockLobes<float> lobes = lobes_at_horizon();
  Blocks<float> gaussians{lobes, {}, {}}, parts = gaussians;
  BlockCuts<float> cuts;
  for (size_t i = 0; i < kBlock; ++i) {
    gaussians.active[i] = parts.active[i] = 1;
    cuts.third[i] = cuts.normal.x[i] = cuts.normal.z[i] = 0;
    cuts.normal.y[i] = 1;
  }
  const hn::ScalableTag<float> d;
  for (const int taps : {7, 15}) {
    HWY_NAMESPACE::eval_prefiltered(d, environment, kBlock, lobes, gaussians.active, taps,
                                    gaussians.result);
    HWY_NAMESPACE::eval_prefiltered(d, environment, kBlock, lobes, parts.active, taps, parts.result,
                                    &cuts);
    for (size_t i = 0; i < kBlock; ++i) {
      // Of a Gaussian, erfc(1.5 / sqrt(2)) / 2 = .067 is below. A tap is a tenth as wide as the
      // lobe and wider where they are few: half of it is below where it lies at the horizon.
      EXPECT_NEAR(gaussians.result[0][i], 1 + 99 * .067, 2) << i << ", seed " << kSeed;
      EXPECT_LT(parts.result[0][i], 1 + 99 * .02) << i << ", seed " << kSeed;
      EXPECT_GE(parts.result[0][i], 0.99f);
    }
  }
}

TEST(PrefilteredBlock, LeansByTheThirdMoment) {
  // Radiance that is odd about the lobe's axis shows the moment: sin(3 a) has slope 3 at 0, which a
  // Gaussian of mean 0 does not see, and -27/6 times the third moment. Seen on the horizon, where
  // the azimuth is the angle.
  Image map(2048, 1024);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / map.width, (y + 0.5) / map.height);
      map.at(x, y) = Rgb::Constant(static_cast<float>(2 + std::sin(3 * std::atan2(v.x(), v.z()))));
    }
  const PrefilteredEnvironment environment = prefilter_environment(map);
  constexpr float kDeviation = 0.12f;
  std::vector<AnisotropicGaussian<float>> all(kBlock);
  for (auto& lobe : all) {
    lobe.frame = {Vector3f::UnitX(), Vector3f::UnitY(), Vector3f::UnitZ()};
    lobe.bandwidth_x = 0.5f / (kDeviation * kDeviation);
    lobe.bandwidth_y = 100 * lobe.bandwidth_x;
  }
  auto block = block_of<float>(all, 0);
  BlockCuts<float> cuts;
  for (size_t i = 0; i < kBlock; ++i) {
    // Up to a skewness of 1 to both sides.
    cuts.third[i] =
        (2.0f * float(i) / float(kBlock - 1) - 1) * kDeviation * kDeviation * kDeviation;
    cuts.normal.x[i] = cuts.normal.y[i] = 0;
    cuts.normal.z[i] = 1;  // far from the horizon
  }
  HWY_NAMESPACE::eval_prefiltered(hn::ScalableTag<float>(), environment, kBlock, block.lobes,
                                  block.active, 15, block.result, &cuts);
  for (size_t i = 0; i < kBlock; ++i) {
    // A Gaussian x bent to x + q (x^2 - 1), in deviations, where q is a sixth of the skewness.
    const double q = double(cuts.third[i]) / std::pow(kDeviation, 3) / 6;
    double expected = 0, mass = 0;
    for (double x = -5; x <= 5; x += 0.01) {
      const double weight = std::exp(-x * x / 2);
      expected += weight * std::sin(3 * kDeviation * (x + q * (x * x - 1)));
      mass += weight;
    }
    // The taps end where the last fifth of a third moment lies.
    EXPECT_NEAR(block.result[0][i] - 2, expected / mass, 0.25 * std::abs(expected / mass) + 1e-4)
        << q << ", seed " << kSeed;
  }
}

TEST(PrefilteredBlock, SkipsPointsOfNoWeight) {
  const auto lobes = random_lobes(kBlock);
  auto all = block_of<float>(lobes, 0), some = all;
  for (size_t i = 0; i < kBlock; ++i) some.active[i] = i < 20 && i % 3 == 0 ? 0.5f : 0.0f;
  const hn::ScalableTag<float> d;
  HWY_NAMESPACE::eval_prefiltered(d, studio(), kBlock, all.lobes, all.active, 32, all.result);
  HWY_NAMESPACE::eval_prefiltered(d, studio(), kBlock, some.lobes, some.active, 32, some.result);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < kBlock; ++i) {
      EXPECT_EQ(some.result[c][i], some.active[i] == 0 ? 0 : all.result[c][i]) << i;
      EXPECT_GT(all.result[c][i], 0);
    }
}

}  // namespace
}  // namespace burnish
