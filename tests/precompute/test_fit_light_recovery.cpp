// What a fit finds again: known mixtures, turned, round, signed.
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "burnish/precompute/fit_light.h"
#include "precompute/fit_light_support.h"

namespace burnish::test {
namespace {

class KnownMixture : public testing::TestWithParam<int> {};

TEST_P(KnownMixture, IsRecovered) {
  std::mt19937 random(kSeed);
  for (int trial = 0; trial < 2; ++trial) {
    const LightRig truth = random_rig(GetParam(), random);
    LightFitOptions options;
    options.lobes = GetParam();
    const LightFit fit = fit_light(render(truth, 256, 128), options);
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " trial " << trial);
    // The map has it as steps of pixels, 1.4 degrees: of the narrowest lobe (sigma 4 degrees) a
    // pixel's mean differs from its values by a few per cent of the peak.
    EXPECT_LT(fit.error.relative_l2, 0.06);
    EXPECT_LT(fit.error.irradiance_relative_l2, 2e-3);
    for (const EnvironmentLobe& light : truth.lobes) {
      const auto found = std::min_element(
          fit.rig.lobes.begin(), fit.rig.lobes.end(), [&](const auto& a, const auto& b) {
            return angle_between(a.lobe.frame.z, light.lobe.frame.z) <
                   angle_between(b.lobe.frame.z, light.lobe.frame.z);
          });
      ASSERT_NE(found, fit.rig.lobes.end());
      // A lobe is matched through cells of about 4 degrees whose mean is that of a widened lobe, to
      // second order: what is left is below a per cent, a few for the wider of two bandwidths.
      EXPECT_LT(angle_between(found->lobe.frame.z, light.lobe.frame.z), 0.01f);
      const Eigen::Matrix3f expected = algebraic_form(light.lobe);
      EXPECT_LT((algebraic_form(found->lobe) - expected).norm(), 0.05f * expected.norm());
      EXPECT_LT((found->color - light.color).abs().maxCoeff(), 0.03f * light.color.maxCoeff());
    }
  }
}

TEST_P(KnownMixture, IsRecoveredFromNoise) {
  std::mt19937 random(kSeed + 1);
  const LightRig truth = random_rig(GetParam(), random);
  Image noisy = render(truth, 256, 128);
  std::uniform_real_distribution<float> factor(0.5f, 1.5f);
  for (Rgb& pixel : noisy.pixels) pixel *= factor(random);
  LightFitOptions options;
  options.lobes = GetParam();
  const LightFit fit = fit_light(noisy, options);
  // The noise's own norm is 0.5 / sqrt(3) of the map's and a lobe has at least 1e2 pixels: its
  // parameters, and the irradiance, are off by a hundredth.
  EXPECT_NEAR(fit.error.relative_l2, 0.277, 0.02) << "seed " << kSeed + 1;
  const LightFitError to_truth = measure_light_fit(render(truth, 256, 128), fit.rig);
  EXPECT_LT(to_truth.relative_l2, 0.08) << "seed " << kSeed + 1;
  EXPECT_LT(to_truth.irradiance_relative_l2, 0.02) << "seed " << kSeed + 1;
}

INSTANTIATE_TEST_SUITE_P(Lobes, KnownMixture, testing::Values(1, 2, 4));

TEST(FitLight, OfATurnedMapIsTheTurnedFit) {
  std::mt19937 random(kSeed + 2);
  const LightRig truth = random_rig(3, random);
  LightRig turned = truth;
  const Eigen::Matrix3f rotation = random_rotation(random).toRotationMatrix();
  rotate(turned, rotation);
  LightFitOptions options;
  options.lobes = 3;
  LightFit fit = fit_light(render(truth, 256, 128), options);
  const LightFit of_turned = fit_light(render(turned, 256, 128), options);
  rotate(fit.rig, rotation);
  // The cells do not turn with the map: both differ from the truth by up to about a per cent.
  const LightFitError difference = measure_light_fit(render(fit.rig, 256, 128), of_turned.rig);
  EXPECT_LT(difference.relative_l2, 0.06) << "seed " << kSeed + 2;
  EXPECT_LT(difference.irradiance_relative_l2, 3e-3) << "seed " << kSeed + 2;
}

// The map turned about its poles by whole pixels: what was column 0 is column `columns`.
Image turned_by_columns(const Image& image, int columns) {
  Image turned = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      turned.at((x + columns) % image.width, y) = image.at(x, y);
  return turned;
}

TEST(FitLight, OfAMapTurnedByWholePixelsIsTheTurnedFit) {
  constexpr int kWidth = 256, kColumns = 37;
  std::mt19937 random(kSeed + 6);
  const Image image = render(random_rig(3, random), kWidth, kWidth / 2);
  const Image turned = turned_by_columns(image, kColumns);
  LightFitOptions options;
  options.lobes = 3;
  LightFit fit = fit_light(image, options);
  const LightFit of_turned = fit_light(turned, options);
  // Longitude falls from left to right.
  rotate(
      fit.rig,
      Eigen::AngleAxisf(-2 * kPi<float> * kColumns / kWidth, Vector3f::UnitY()).toRotationMatrix());
  // The same pixels in other cells: each fit is off the truth by up to 4 % in its own way, most of
  // it for the narrowest lobe, which is one cell wide.
  const LightFitError difference = measure_light_fit(render(fit.rig, 256, 128), of_turned.rig);
  EXPECT_LT(difference.relative_l2, 0.06) << "seed " << kSeed + 6;
  EXPECT_LT(difference.irradiance_relative_l2, 2e-3) << "seed " << kSeed + 6;
}

TEST(FitLight, OfAResampledTurnedMapIsTheTurnedFit) {
  std::mt19937 random(kSeed + 7);
  const Image image = render(random_rig(3, random), 256, 128);
  const Eigen::Quaternionf rotation = random_rotation(random);
  Image turned(256, 128);
  constexpr int kSub = 4;
  for (int y = 0; y < turned.height; ++y)
    for (int x = 0; x < turned.width; ++x) {
      Rgb sum = Rgb::Zero();
      for (int j = 0; j < kSub; ++j)
        for (int i = 0; i < kSub; ++i) {
          const Vector3d v = direction_from_latlong((x + (i + 0.5) / kSub) / turned.width,
                                                    (y + (j + 0.5) / kSub) / turned.height);
          sum += eval_environment(image, rotation.conjugate().cast<double>() * v);
        }
      turned.at(x, y) = sum / (kSub * kSub);
    }
  LightFitOptions options;
  options.lobes = 3;
  LightFit fit = fit_light(image, options);
  const LightFit of_turned = fit_light(turned, options);
  rotate(fit.rig, rotation.toRotationMatrix());
  // As above; resampling blurs by a pixel (variance 2e-4 / 12 each way), of the narrowest lobe
  // (variance 5e-3) less than a per cent.
  const LightFitError difference = measure_light_fit(render(fit.rig, 256, 128), of_turned.rig);
  EXPECT_LT(difference.relative_l2, 0.06) << "seed " << kSeed + 7;
  EXPECT_LT(difference.irradiance_relative_l2, 3e-3) << "seed " << kSeed + 7;
}

TEST(FitLight, KeepsTheErrorOfAMapTurnedAboutItsPoles) {
  const Image image = room(256, 128), turned = turned_by_columns(image, 37);
  const LightFit a = fit_light(image, quick(6)), b = fit_light(turned, quick(6));
  // Different cells may lead to different local minima of similar worth.
  EXPECT_NEAR(a.error.relative_l2, b.error.relative_l2, 0.1 * a.error.relative_l2);
  EXPECT_LT(std::max(a.error.irradiance_relative_l2, b.error.irradiance_relative_l2), 0.015);
}

TEST(FitLight, IsotropicLobesAreRoundAndRecovered) {
  std::mt19937 random(kSeed + 8);
  LightRig truth = random_rig(3, random);
  for (EnvironmentLobe& light : truth.lobes) light.lobe.bandwidth_y = light.lobe.bandwidth_x;
  LightFitOptions options;
  options.lobes = 3;
  options.isotropic = true;
  const LightFit fit = fit_light(render(truth, 256, 128), options);
  ASSERT_EQ(fit.rig.lobes.size(), 3u);
  // As for KnownMixture.
  EXPECT_LT(fit.error.relative_l2, 0.06) << "seed " << kSeed + 8;
  EXPECT_LT(fit.error.irradiance_relative_l2, 2e-3) << "seed " << kSeed + 8;
  // A compact source, too.
  Image image = room(128, 64);
  image.at(30, 20) = Rgb(1e6f, 1e6f, 1e6f);
  options = quick(6);
  options.isotropic = true;
  const LightFit round = fit_light(image, options);
  for (const EnvironmentLobe& light : round.rig.lobes)
    EXPECT_EQ(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
  EXPECT_LT((energy(round.rig) / energy(image) - 1).abs().maxCoeff(), 0.01);
}

TEST(FitLight, AnisotropicLobesFitBetterThanRoundOnes) {
  const Image image = room(128, 64);
  for (const int lobes : {5, 10}) {
    LightFitOptions options = quick(lobes);
    const double anisotropic = fit_light(image, options).error.relative_l2;
    options.isotropic = true;
    EXPECT_LT(anisotropic, fit_light(image, options).error.relative_l2) << lobes;
  }
}

TEST(FitLight, SignedColorsRecoverAHole) {
  // A wide lobe with a dark hole, which no sum of two positive lobes makes.
  LightRig truth;
  EnvironmentLobe wide, hole;
  wide.lobe = {frame_from_axis(Vector3f(0.6f, 0.64f, 0.48f)), 2, 2, 1};
  wide.color = Rgb(2, 3, 4);
  hole.lobe = {frame_from_axis(Vector3f(0.48f, 0.8f, 0.36f)), 20, 60, 1};
  hole.color = Rgb(-1, -1.5f, -2);
  truth.lobes = {wide, hole};
  Image image = render(truth, 256, 128);
  for (Rgb& pixel : image.pixels) pixel = pixel.max(0);  // where the hole is wider than the lobe
  LightFitOptions options = quick(2);
  const LightFit positive = fit_light(image, options);
  options.signed_colors = true;
  const LightFit fit = fit_light(image, options);
  for (const EnvironmentLobe& light : positive.rig.lobes) EXPECT_GE(light.color.minCoeff(), 0);
  EXPECT_GT(positive.error.relative_l2, 3 * fit.error.relative_l2);
  ASSERT_EQ(fit.rig.lobes.size(), 2u);
  EXPECT_LT(fit.rig.lobes[1].color.maxCoeff(), 0);  // by falling size of its power
  // Pixels of 1.4 degrees and cells of six: a per cent or two.
  EXPECT_LT(fit.error.relative_l2, 0.03);
  EXPECT_LT(fit.error.irradiance_relative_l2, 3e-3);
}

}  // namespace
}  // namespace burnish::test
