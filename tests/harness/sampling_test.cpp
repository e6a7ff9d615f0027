#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "harness/environment_sampler.h"
#include "harness/sample_sequence.h"
#include "support/chi_square.h"

namespace burnish {
namespace {

/// Seeds are fixed: the chance of 1e-4 to fail by accident is taken once, when a test is written.
void expect_distribution(const std::vector<double>& counts, const std::vector<double>& expected,
                         const std::string& what) {
  for (size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] == 0) {
      EXPECT_EQ(counts[i], 0) << what << ", bin " << i;
    }
  }
  const test::ChiSquare result = test::chi_square(counts, expected);
  EXPECT_GT(result.p_value, 1e-4) << what << ": statistic " << result.statistic << " of "
                                  << result.degrees << " degrees\n"
                                  << result.table;
}

TEST(SampleSequence, EveryElementaryIntervalHasOnePoint) {
  // The (0, m, 2)-net property of Sobol's first two dimensions, which Owen's scramble keeps.
  for (const std::uint64_t seed : {1u, 2u, 77u})
    for (const std::uint32_t pair : {0u, 5u})
      for (int log_count = 0; log_count <= 8; ++log_count) {
        const std::uint32_t count = 1u << log_count;
        const SampleSequence sequence(seed);
        for (int log_columns = 0; log_columns <= log_count; ++log_columns) {
          const double columns = double(1u << log_columns), rows = double(count) / columns;
          std::set<std::pair<int, int>> cells;
          // Any aligned run of indices is a net; take the second one.
          for (std::uint32_t i = count; i < 2 * count; ++i) {
            const Uniform2 p = sequence(i, pair);
            ASSERT_TRUE(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1);
            cells.insert({int(p.u * columns), int(p.v * rows)});
          }
          EXPECT_EQ(cells.size(), count) << "seed " << seed << " pair " << pair;
        }
      }
}

TEST(SampleSequence, APointIsUniformOverSeeds) {
  // What makes an estimate unbiased: a single index, seen over many seeds, fills the square evenly,
  // and so do the u of two points and the u of two pairs.
  constexpr int kSeeds = 1 << 16, kBins = 16;
  std::vector<double> point(kBins * kBins), indices(kBins * kBins), pairs(kBins * kBins);
  for (int seed = 0; seed < kSeeds; ++seed) {
    const SampleSequence sequence(mix_seed(99, static_cast<std::uint64_t>(seed)));
    const Uniform2 a = sequence(3, 1), b = sequence(4, 1), c = sequence(3, 2);
    const auto bin = [](double x, double y) {
      return static_cast<size_t>(int(x * kBins) * kBins + int(y * kBins));
    };
    ++point[bin(a.u, a.v)];
    ++pairs[bin(a.u, c.u)];
    ++indices[bin(b.v, c.u)];
  }
  const std::vector<double> expected(kBins * kBins, double(kSeeds) / (kBins * kBins));
  expect_distribution(point, expected, "point");
  expect_distribution(pairs, expected, "pairs");
  expect_distribution(indices, expected, "indices");
}

/// A map with black pixels, a black row and a range of 1e4.
Image speckled_map(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> exponent(-4, 4);
  Image map(12, 6);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Rgb color(std::exp(exponent(random)), std::exp(exponent(random)),
                      std::exp(exponent(random)));
      map.at(x, y) = y == 2 || (x + y) % 5 == 0 ? Rgb(Rgb::Zero()) : color;
    }
  return map;
}

TEST(EnvironmentSampler, DrawsByLuminanceTimesSolidAngle) {
  const unsigned seed = 31;
  const Image map = speckled_map(seed);
  const EnvironmentSampler sampler(map);
  ASSERT_FALSE(sampler.empty());
  // Bins half a pixel wide and high, so that the distribution within a pixel is tested as well.
  const Image half(2 * map.width, 2 * map.height);
  std::vector<double> expected(half.pixels.size()), counts(half.pixels.size());
  double total = 0;
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      const double weight =
          double(luminance(map.at(x / 2, y / 2))) * latlong_pixel_solid_angle(half, y);
      expected[static_cast<size_t>(y * half.width + x)] = weight;
      total += weight;
    }
  constexpr int kSamples = 1 << 19;
  for (double& e : expected) e *= kSamples / total;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < kSamples; ++i) {
    const double u = uniform(random);
    const EnvironmentSampler::Sample s = sampler.sample({u, uniform(random)});
    const Vector2<double> uv = latlong_from_direction(s.direction);
    ++counts[static_cast<size_t>(int(uv.y() * half.height) * half.width +
                                 int(uv.x() * half.width))];
    if (i % 64) continue;
    ASSERT_NEAR(s.direction.norm(), 1, 1e-12);
    ASSERT_GT(s.pdf, 0);
    ASSERT_DOUBLE_EQ(s.pdf, sampler.pdf(s.direction)) << "seed " << seed;
    ASSERT_TRUE((s.radiance == eval_environment(map, s.direction)).all());
  }
  expect_distribution(counts, expected, "seed " + std::to_string(seed));
}

TEST(EnvironmentSampler, DensityIntegratesToOne) {
  const Image map = speckled_map(8);
  const EnvironmentSampler sampler(map);
  double sum = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      sum += latlong_pixel_solid_angle(map, y) *
             sampler.pdf(direction_from_latlong((x + 0.5) / map.width, (y + 0.5) / map.height));
  EXPECT_NEAR(sum, 1, 1e-6);  // luminance is float
}

TEST(EnvironmentSampler, ExtremesOfTheUniformNumbersStayOnLitPixels) {
  const Image map = speckled_map(4);
  const EnvironmentSampler sampler(map);
  for (const double u : {0.0, 0.5, 1 - 0x1p-53})
    for (const double v : {0.0, 1 - 0x1p-53}) {
      const EnvironmentSampler::Sample s = sampler.sample({u, v});
      EXPECT_TRUE(s.direction.allFinite());
      EXPECT_GT(s.pdf, 0);
    }
}

TEST(EnvironmentSampler, ABlackMapIsEmpty) {
  const Image black(8, 4);
  EXPECT_TRUE(EnvironmentSampler(black).empty());
  EXPECT_EQ(EnvironmentSampler(black).pdf(Vector3d::UnitX()), 0);
}

}  // namespace
}  // namespace burnish
