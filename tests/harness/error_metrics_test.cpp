#include "harness/error_metrics.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace burnish {
namespace {

TEST(RelativeL2, MatchesItsDefinition) {
  const std::vector<Rgb> a = {Rgb(1, 2, 3), Rgb(0, 0, 4)}, b = {Rgb(1, 0, 3), Rgb(2, 0, 3)};
  const RelativeL2 error = relative_l2(a, b);
  // (4 + 4 + 1) / (1 + 9 + 4 + 9)
  EXPECT_DOUBLE_EQ(error.value, std::sqrt(9.0 / 23.0));
  EXPECT_EQ(error.truth_noise, 0);
  EXPECT_DOUBLE_EQ(error.without_noise, error.value);
  EXPECT_EQ(error.standard_error, 0);
  EXPECT_EQ(error.count, 2u);
  EXPECT_EQ(relative_l2(b, b).value, 0);
}

TEST(RelativeL2, OfABlackReferenceIsInfiniteOrZero) {
  const std::vector<Rgb> black(3, Rgb::Zero()), grey(3, Rgb::Ones());
  EXPECT_EQ(relative_l2(grey, black).value, std::numeric_limits<double>::infinity());
  EXPECT_EQ(relative_l2(black, black).value, 0);
  EXPECT_EQ(relative_l2(std::vector<Rgb>(), std::vector<Rgb>()).value, 0);
}

TEST(RelativeL2, ComparesOnlyPixelsThatTheMeshFillsInBoth) {
  Picture a{Image(4, 1, Rgb::Ones()), {1, 1, 0, 1}, {}};
  Picture b{Image(4, 1, Rgb::Constant(2)), {1, 0, 1, 1}, {}};
  a.radiance.at(3, 0) = Rgb::Constant(2);
  a.radiance.at(1, 0) = b.radiance.at(2, 0) = Rgb::Constant(1e6f);  // must not count
  const RelativeL2 error = relative_l2(a, b);
  EXPECT_EQ(error.count, 2u);
  EXPECT_DOUBLE_EQ(error.value, std::sqrt(3.0 / 24.0));
}

TEST(RelativeL2, NoiseOfTheReferenceIsReportedAndRemoved) {
  // An approximation that is 10 % too bright, against references with normal noise of known
  // variance; the noise is equal in all channels, as the bound assumes.
  const unsigned seed = 3;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  constexpr size_t kValues = 2000;
  constexpr int kRuns = 200;
  std::vector<Rgb> truth(kValues), approximation(kValues), variance(kValues);
  for (size_t i = 0; i < kValues; ++i) {
    truth[i] = Rgb(1.0f + 0.5f * float(std::sin(double(i))), 0.5f, 2.0f);
    approximation[i] = 1.1f * truth[i];
    variance[i] = Rgb::Constant(0.04f * truth[i].x());
  }
  double sum = 0, sum2 = 0, reported = 0, noise = 0, cleaned = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<Rgb> noisy(kValues);
    for (size_t i = 0; i < kValues; ++i)
      noisy[i] = truth[i] + float(normal(random)) * variance[i].sqrt();
    const RelativeL2 error = relative_l2(approximation, noisy, variance);
    sum += error.value;
    sum2 += error.value * error.value;
    reported += error.standard_error / kRuns;
    noise += error.truth_noise / kRuns;
    cleaned += error.without_noise / kRuns;
  }
  const double mean = sum / kRuns;
  const double actual = std::sqrt((sum2 - sum * mean) / (kRuns - 1));
  double truth2 = 0, noise2 = 0;
  for (size_t i = 0; i < kValues; ++i) {
    truth2 += double(truth[i].square().sum());
    noise2 += double(variance[i].sum());
  }
  // The noisy reference's own norm is larger by half of noise^2 (0.7 %), and so is the noise
  // fraction smaller; each mean has a statistical error of about actual / sqrt(200).
  EXPECT_NEAR(noise, std::sqrt(noise2 / truth2), 0.02 * noise) << "seed " << seed;
  EXPECT_GT(mean, 0.13) << "the noise shows";
  EXPECT_NEAR(cleaned, 0.1, 0.005) << "seed " << seed;
  // An upper bound, and not a wild one. 200 runs know `actual` to 5 %.
  EXPECT_GT(reported, 0.8 * actual) << "seed " << seed;
  EXPECT_LT(reported, 2.5 * actual) << "seed " << seed;
}

TEST(SideBySide, PlacesPicturesWithGaps) {
  Image a(2, 1, Rgb::Constant(3)), b(1, 2, Rgb::Constant(5));
  const std::array pictures = {a, b};
  const Image row = side_by_side(pictures, 2, Rgb::Constant(9));
  ASSERT_EQ(row.width, 5);
  ASSERT_EQ(row.height, 2);
  const float expected[2][5] = {{3, 3, 9, 9, 5}, {9, 9, 9, 9, 5}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 5; ++x) EXPECT_EQ(row.at(x, y).x(), expected[y][x]) << x << "," << y;
  EXPECT_EQ(side_by_side({}, 2).pixels.size(), 0u);
}

TEST(DifferencePicture, IsTheGainedLuminanceDifference) {
  const Image a(1, 1, Rgb(1, 1, 1)), b(1, 1, Rgb(0, 1, 1));
  // Luminance of red, a float product.
  EXPECT_NEAR(difference_picture(a, b, 10).at(0, 0).z(), 2.126f, 1e-5f);
  EXPECT_NEAR(difference_picture(b, a, 10).at(0, 0).x(), 2.126f, 1e-5f);
}

}  // namespace
}  // namespace burnish
