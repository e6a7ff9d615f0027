#include "harness/error_metrics.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "harness/flip.h"
#include "harness/tone_map.h"

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

TEST(AboveNoise, IsFromTwiceTheNoiseOn) {
  EXPECT_FALSE(above_noise(0.0199, 0.01));
  EXPECT_TRUE(above_noise(0.02, 0.01));
  EXPECT_TRUE(above_noise(0.0, 0.0)) << "an exact truth tells everything";
  const std::vector<Rgb> one(1, Rgb::Ones()), other(1, Rgb::Constant(1.05f));
  const std::vector<Rgb> small(1, Rgb::Constant(1e-4f)), large(1, Rgb::Constant(1e-3f));
  EXPECT_TRUE(above_noise(relative_l2(other, one, small)));   // 5 % against 1 %
  EXPECT_FALSE(above_noise(relative_l2(other, one, large)));  // 5 % against 3.2 %
}

TEST(AbsoluteErrors, MatchTheirDefinitions) {
  // Errors of 1 / 1000, 2 / 1000, ..., 1 in an order that is not theirs, of a mean radiance of 2.
  constexpr size_t kValues = 1000;
  std::vector<Rgb> a(kValues), b(kValues);
  for (size_t i = 0; i < kValues; ++i) {
    const float error = float((i * 337) % kValues + 1) / kValues;
    b[i] = Rgb(i % 2 ? 3.0f : 1.0f, 2, i % 2 ? 1.0f : 3.0f);
    a[i] = b[i] + Rgb(3 * error, 0, 0) * (i % 3 ? 1.0f : -1.0f);
  }
  const AbsoluteErrors errors = absolute_errors(a, b);
  EXPECT_EQ(errors.count, kValues);
  EXPECT_DOUBLE_EQ(errors.mean_radiance, 2);
  EXPECT_NEAR(errors.mean, 0.5005 / 2, 1e-6);  // roundings of the floats
  EXPECT_NEAR(errors.percentile_95, 0.950 / 2, 1e-6);
  EXPECT_NEAR(errors.percentile_999, 0.999 / 2, 1e-6);
  EXPECT_EQ(errors.truth_noise, 0);
  const std::vector<Rgb> one(1, Rgb::Ones()), two(1, Rgb::Constant(2));
  EXPECT_DOUBLE_EQ(absolute_errors(two, one).percentile_95, 1) << "of one value";
}

TEST(AbsoluteErrors, OfABlackReferenceAreInfiniteOrZero) {
  const std::vector<Rgb> black(3, Rgb::Zero()), grey(3, Rgb::Ones());
  EXPECT_EQ(absolute_errors(grey, black).mean, std::numeric_limits<double>::infinity());
  EXPECT_EQ(absolute_errors(black, black).percentile_999, 0);
  EXPECT_EQ(absolute_errors(std::vector<Rgb>(), std::vector<Rgb>()).count, 0u);
}

TEST(AbsoluteErrors, TellWhatTheNoiseOfTheReferenceAdds) {
  const unsigned seed = 5;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  constexpr size_t kValues = 20000;
  const std::vector<Rgb> truth(kValues, Rgb(1, 2, 3));
  std::vector<Rgb> noisy = truth, variance(kValues, Rgb(0.01f, 0.04f, 0.09f));
  for (size_t i = 0; i < kValues; ++i)
    for (int c = 0; c < 3; ++c) noisy[i][c] += float(normal(random)) * std::sqrt(variance[i][c]);
  const AbsoluteErrors errors = absolute_errors(truth, noisy, variance);
  // The mean of |normal| varies by 0.6, so 20,000 values of three channels know it to 0.4 %.
  EXPECT_NEAR(errors.truth_noise / errors.mean, 1, 0.012) << "seed " << seed;
}

TEST(ToneMap, BringsTheMeshToMiddleGrey) {
  Picture picture{Image(3, 1, Rgb(0.5f, 0.5f, 0.5f)), {1, 1, 0}, {}};
  picture.radiance.at(1, 0) = Rgb::Constant(1.5f);
  picture.radiance.at(2, 0) = Rgb::Constant(100);  // background
  const float exposure = exposure_of(picture);
  EXPECT_FLOAT_EQ(exposure, 0.18f);
  const Image shown = tone_map(picture.radiance, exposure);
  // IEC 61966-2-1 at 0.09 and 0.27, by hand.
  EXPECT_NEAR(shown.at(0, 0).x(), 1.055 * std::pow(0.09, 1 / 2.4) - 0.055, 1e-6);
  EXPECT_NEAR(shown.at(1, 0).y(), 1.055 * std::pow(0.27, 1 / 2.4) - 0.055, 1e-6);
  EXPECT_EQ(shown.at(2, 0).z(), 1);
  picture.hit.assign(3, 0);
  EXPECT_EQ(exposure_of(picture), 1) << "nothing to expose for";
}

TEST(Psnr, MatchesItsDefinition) {
  // Both pixels have the mean luminance, so the reference shows 0.18 everywhere.
  Picture reference{Image(3, 1, Rgb::Constant(2)), {1, 1, 1}, {}};
  Picture other = reference;
  EXPECT_EQ(psnr_db(other, reference), std::numeric_limits<double>::infinity());
  other.radiance.at(1, 0) = Rgb(0, 2, 2);
  other.radiance.at(2, 0) = Rgb::Constant(1000);
  other.hit[2] = 0;  // must not count
  const double shown = 1.055 * std::pow(0.18, 1 / 2.4) - 0.055;
  EXPECT_NEAR(display_mse(other, reference), shown * shown / 6, 1e-6);
  EXPECT_NEAR(psnr_db(other, reference), -10 * std::log10(shown * shown / 6), 1e-4);
  EXPECT_EQ(display_mse({}, {}), 0);
}

TEST(FlipError, IsTheMeanOverTheMeshOfTheMapOfShownPictures) {
  Picture reference{Image(40, 30, Rgb::Constant(3)), std::vector<std::uint8_t>(1200, 1), {}};
  Picture other = reference;
  for (size_t i = 0; i < 600; ++i) other.radiance.pixels[i] = Rgb(1, 3, 6);
  for (size_t i = 0; i < 200; ++i) reference.hit[i] = 0;
  const FlipError error = flip_error(other, reference);
  const Image map = flip_map(tone_map(other.radiance, 0.06f), tone_map(reference.radiance, 0.06f));
  double sum = 0;
  for (size_t i = 200; i < 1200; ++i) sum += double(map.pixels[i].x());
  // The exposure is .18 / 3 but for a rounding.
  EXPECT_NEAR(error.mean, sum / 1000, 1e-5);
  EXPECT_GT(error.mean, 0.05);
  EXPECT_EQ(error.map.pixels.size(), 1200u);
  EXPECT_EQ(flip_error(reference, reference).mean, 0);
  EXPECT_EQ(flip_error({}, {}).mean, 0);
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
