#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>
#include <tuple>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "burnish/precompute/fit_light.h"
#include "precompute/fit_light_support.h"

namespace burnish::test {
namespace {

TEST(FitLight, TakesNoMoreLobesThanATargetAsksFor) {
  std::mt19937 random(kSeed + 9);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed + 9);
  const Image image = render(random_rig(4, random), 128, 64);
  LightFitOptions options;
  options.lobes = 12;
  options.target_error = 0.1;
  const LightFit exact = fit_light(image, options);
  EXPECT_TRUE(exact.met_target);
  EXPECT_LE(exact.error.relative_l2, 0.1);
  // Each lobe is more than a hundredth of the squared norm; one more than there are may be taken
  // for a corner that the others leave.
  EXPECT_GE(exact.rig.lobes.size(), 4u);
  EXPECT_LE(exact.rig.lobes.size(), 5u);
  options.target_error = 0.7;
  const LightFit rough = fit_light(image, options);
  EXPECT_TRUE(rough.met_target);
  EXPECT_LE(rough.error.relative_l2, 0.7);
  EXPECT_LT(rough.rig.lobes.size(), exact.rig.lobes.size());
  options.lobes = 3;
  options.target_error = 0.1;
  const LightFit short_of_it = fit_light(image, options);
  EXPECT_FALSE(short_of_it.met_target);
  EXPECT_EQ(short_of_it.rig.lobes.size(), 3u);
  options.target_error = 0;
  EXPECT_TRUE(fit_light(image, options).met_target);  // there was none
}

TEST(FitLight, KeepsTheIrradianceOfARoom) {
  const Image image = room(256, 128);
  const LightFit fit = fit_light(image, quick(10));
  EXPECT_LT(fit.error.irradiance_relative_l2, 0.015);
  // More lobes, less error; without the irradiance in the error it is several times larger.
  LightFitOptions options = quick(3);
  EXPECT_GT(fit_light(image, options).error.relative_l2, fit.error.relative_l2);
  options = quick(10);
  options.irradiance_weight = 0;
  const LightFit plain = fit_light(image, options);
  EXPECT_GT(plain.error.irradiance_relative_l2, 2 * fit.error.irradiance_relative_l2);
  EXPECT_LT(plain.error.relative_l2, fit.error.relative_l2);
  const Eigen::Array3d truth = energy(image);
  EXPECT_LT((energy(fit.rig) / truth - 1).abs().maxCoeff(), 0.01);
}

// The target set for the fit: an irradiance error of at most 2 % with 14 lobes. Ten do it here.
TEST(FitLight, KeepsTheIrradianceOfARealMap) {
  const char* shared = std::getenv("BURNISH_SHARED_DATA");
  const std::filesystem::path folder =
      std::filesystem::path(shared ? shared : BURNISH_SOURCE_DIR "/../shared/data") / "env";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder " << folder;
  const LightFit fit = fit_light(read_environment((folder / "grace_probe_latlong.hdr").string()));
  EXPECT_LT(fit.error.irradiance_relative_l2, 0.02);
}

TEST(FitLight, OfAConstantMapKeepsRadianceAndIrradiance) {
  const Rgb constant(0.5f, 2, 3);
  const LightFit fit = fit_light(Image(64, 32, constant), quick(10));
  // Ten cosine lobes cannot be flat: a few per cent of ripple in the radiance, which the cosine
  // averages out.
  EXPECT_LT(fit.error.relative_l2, 0.06);
  EXPECT_LT(fit.error.irradiance_relative_l2, 3e-3);
  EXPECT_LT((energy(fit.rig) / (4 * kPi<double> * constant.cast<double>()) - 1).abs().maxCoeff(),
            3e-3);
}

class SunIn : public testing::TestWithParam<Vector3d> {};

TEST_P(SunIn, AnyPlaceIsSplitFromTheSky) {
  constexpr int kWidth = 512, kHeight = 256;
  Image sky(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / kWidth, (y + 0.5) / kHeight);
      sky.at(x, y) =
          v.y() > 0 ? Rgb(0.5f, 0.8f, 1.5f) * float(1.2 - v.y()) : Rgb(0.2f, 0.15f, 0.1f);
    }
  Image image = sky;
  const Vector3d sun_axis = GetParam().normalized();
  Eigen::Array3d sun_energy = Eigen::Array3d::Zero();
  Vector3d centroid = Vector3d::Zero();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / kWidth, (y + 0.5) / kHeight);
      if (angle_between(v, sun_axis) > 0.015) continue;
      image.at(x, y) = Rgb(1e8f, 9e7f, 7e7f);
      sun_energy += latlong_pixel_solid_angle(image, y) * image.at(x, y).cast<double>();
      centroid += latlong_pixel_solid_angle(image, y) * v;
    }
  const LightFit fit = fit_light(image, quick(7));
  ASSERT_EQ(fit.rig.lobes.size(), 7u);
  LightRig sun, rest;
  sun.lobes.assign(fit.rig.lobes.begin(), fit.rig.lobes.begin() + 1);
  rest.lobes.assign(fit.rig.lobes.begin() + 1, fit.rig.lobes.end());
  // Colours and bandwidths are floats; the sky behind the sun counts 1e-8.
  EXPECT_LT((energy(sun) / sun_energy - 1).abs().maxCoeff(), 1e-5);
  EXPECT_LT((sun.lobes[0].lobe.frame.z.cast<double>() - centroid.normalized()).norm(), 1e-6);
  // The sky is not sacrificed to the sun's outline: the other lobes fit it about as well as six
  // lobes do when there is no sun (not the same: its place was filled, the cells differ).
  const LightFitError alone = fit_light(sky, quick(6)).error, of_sky = measure_light_fit(sky, rest);
  EXPECT_LT(of_sky.relative_l2, 1.2 * alone.relative_l2);
  // Six lobes leave 0.4 % of the sky alone, and 0.5 to 0.8 % here; at the zenith 1.24 %, another
  // local minimum, whose last digits rounding moves: a fifth more than that.
  const bool at_zenith = sun_axis == Vector3d::UnitY();
  EXPECT_LT(of_sky.irradiance_relative_l2, at_zenith ? 0.015 : 0.01);
}

// Somewhere, at the poles, beside one, across the seam.
INSTANTIATE_TEST_SUITE_P(Places, SunIn,
                         testing::Values(Vector3d(0.3, 0.8, 0.5), Vector3d(0, 1, 0),
                                         Vector3d(0.008, 1, 0.004), Vector3d(0, -1, 0),
                                         Vector3d(0, 0.3, -1)));

TEST(FitLight, OfABlackMapHasNoLobes) {
  const LightFit fit = fit_light(Image(16, 8));
  EXPECT_TRUE(fit.rig.lobes.empty());
  EXPECT_EQ(fit.error.relative_l2, 0);
  EXPECT_EQ(fit.error.irradiance_relative_l2, 0);
}

TEST(FitLight, OfASingleBrightPixelHasItsEnergy) {
  Image image(512, 256);
  image.at(500, 100) = Rgb(7, 0, 3);
  const LightFit fit = fit_light(image);
  ASSERT_FALSE(fit.rig.lobes.empty());
  const Eigen::Array3d found = energy(fit.rig), truth = energy(image);
  EXPECT_NEAR(found[0], truth[0], 1e-5 * truth[0]);
  EXPECT_EQ(found[1], 0);
  EXPECT_NEAR(found[2], truth[2], 1e-5 * truth[2]);
}

// A lobe of the sun's energy E whose standard deviations are half the pixel's sides or more cannot
// be far off: |lobe|^2 <= 0.32 E^2 / area, and the mean of a lobe that points into the pixel is at
// least 0.23 E / area over it (that of one at a corner), so that the squared error is at most
// 1 - 2 * 0.23 + 0.32 = 0.86. Next to a pole the pixel is a needle, of which a lobe as wide as a
// square of its area sees less: measured 0.91. A lobe that hid inside it would err by 1.9.
TEST(FitLight, OfAOnePixelSunIsBetterThanNoLight) {
  const std::tuple<int, int, int, int> suns[] = {{64, 32, 20, 10},    {64, 32, 63, 31},
                                                 {80, 40, 51, 27},    {80, 40, 7, 1},
                                                 {256, 128, 227, 37}, {512, 256, 392, 138}};
  for (const auto& [width, height, x, y] : suns) {
    Image image(width, height, Rgb(1, 1, 1));
    image.at(x, y) *= 4294967296.0f;
    for (const int lobes : {1, 3}) {
      if (lobes > 1 && height > 32) continue;  // finer, it becomes a compact source
      SCOPED_TRACE(testing::Message() << width << " x " << height << ", sun at " << x << ", " << y
                                      << ", " << lobes << " lobes");
      LightFitOptions options;  // with cells enough to split down to the pixel
      options.lobes = lobes;
      const LightFit fit = fit_light(image, options);
      EXPECT_LT(fit.error.relative_l2, 0.95);
      // A tenth of a radian wide, the lobe's flux is shorter than the pixel's by a per cent or so.
      EXPECT_LT(fit.error.irradiance_relative_l2, 0.02);
    }
  }
}

TEST(FitLight, AcceptsMapsOfAnyShape) {
  std::mt19937 random(kSeed + 3);
  std::uniform_real_distribution<float> value(0.5f, 1.5f);
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 16}, {16, 1}, {3, 5}, {400, 1}}) {
    Image image(width, height);
    for (Rgb& pixel : image.pixels) pixel = Rgb(value(random), value(random), value(random));
    const LightFit fit = fit_light(image, quick(6));
    SCOPED_TRACE(testing::Message() << width << " x " << height << ", seed " << kSeed + 3);
    EXPECT_LE(fit.rig.lobes.size(), 6u);
    // Coarse pixels have hard edges, which the lobes smooth; radiances differ by up to 3.
    EXPECT_LT(fit.error.relative_l2, 0.3);
    EXPECT_LT(fit.error.irradiance_relative_l2, 0.01);
    EXPECT_LT((energy(fit.rig) / energy(image) - 1).abs().maxCoeff(), 0.01);
  }
}

TEST(FitLight, LobesAreSoundAndNoNarrowerThanAsked) {
  LightFitOptions options = quick(8);
  options.max_bandwidth = 50;
  const LightFit fit = fit_light(room(256, 128), options);
  float last = std::numeric_limits<float>::infinity();
  for (const EnvironmentLobe& light : fit.rig.lobes) {
    EXPECT_LE(std::max(light.lobe.bandwidth_x, light.lobe.bandwidth_y), 50 * 1.0001f);
    EXPECT_GE(std::min(light.lobe.bandwidth_x, light.lobe.bandwidth_y), 0.05f * 0.9999f);
    EXPECT_EQ(light.lobe.amplitude, 1);
    EXPECT_TRUE(light.color.isFinite().all() && (light.color >= 0).all());
    EXPECT_TRUE((light.color > 0).any());
    const Eigen::Vector3f cross = light.lobe.frame.x.cross(light.lobe.frame.y);
    EXPECT_LT((cross - light.lobe.frame.z).norm(), 1e-6f);
    const float power = luminance(light.color) * integral(light.lobe);
    EXPECT_LE(power, last);
    last = power;
  }
}

TEST(FitLight, ScalesWithTheMap) {
  Image image = room(128, 64);
  const LightFit fit = fit_light(image, quick());
  for (const float factor : {std::ldexp(1.0f, 100), std::ldexp(1.0f, -100)}) {
    Image scaled = image;
    for (Rgb& pixel : scaled.pixels) pixel *= factor;
    LightFit other = fit_light(scaled, quick());
    for (EnvironmentLobe& light : other.rig.lobes) light.color /= factor;
    // A power of two changes no digit.
    EXPECT_TRUE(same_bytes(fit.rig, other.rig)) << factor;
    EXPECT_NEAR(other.error.relative_l2, fit.error.relative_l2, 1e-12) << factor;
  }
}

TEST(FitLight, IsTheSameAtAnyNumberOfThreads) {
  const Image image = room(128, 64);
  for (const bool variant : {false, true}) {
    LightFitOptions options = quick();
    options.isotropic = options.signed_colors = variant;
    options.target_error = variant ? 0.4 : 0;
    const auto fit_with = [&](size_t threads) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      return fit_light(image, options);
    };
    const LightFit one = fit_with(1), four = fit_with(4);
    EXPECT_TRUE(same_bytes(one.rig, four.rig));
    EXPECT_EQ(one.error.relative_l2, four.error.relative_l2);
    EXPECT_EQ(one.error.irradiance_relative_l2, four.error.irradiance_relative_l2);
    EXPECT_EQ(one.iterations, four.iterations);
  }
}

TEST(FitLight, RefusesBadPixels) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -1.0f, std::numeric_limits<float>::infinity()}) {
    Image image = room(64, 32);
    image.at(7, 3)[1] = bad;
    try {
      fit_light(image);
      ADD_FAILURE() << "accepted " << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_NE(std::string(error.what()).find("(7, 3)"), std::string::npos) << error.what();
    }
  }
}

TEST(FitLight, RefusesOptionsOutOfRange) {
  const Image image(4, 2, Rgb(1, 1, 1));
  EXPECT_THROW(fit_light(Image()), Error);
  const auto refused = [&](auto change) {
    LightFitOptions options;
    change(options);
    EXPECT_THROW(fit_light(image, options), Error);
  };
  refused([](LightFitOptions& o) { o.lobes = 0; });
  refused([](LightFitOptions& o) { o.lobes = 129; });
  refused([](LightFitOptions& o) { o.cells = 255; });
  refused([](LightFitOptions& o) { o.target_error = -0.1; });
  refused([](LightFitOptions& o) { o.target_error = std::nan(""); });
  refused([](LightFitOptions& o) { o.target_error = 1.5; });
  refused([](LightFitOptions& o) { o.irradiance_weight = -1; });
  refused([](LightFitOptions& o) { o.irradiance_weight = std::nan(""); });
  refused([](LightFitOptions& o) { o.min_bandwidth = 0; });
  refused([](LightFitOptions& o) { o.max_bandwidth = 0.01; });
}

TEST(FitLight, ReportsProgressAndCanBeStopped) {
  const Image image = room(64, 32);
  std::uint64_t last = 0;
  fit_light(image, quick(), [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(stage, "fit lights");
    EXPECT_EQ(total, 5u);
    EXPECT_GE(done, last);
    last = done;
    return true;
  });
  EXPECT_EQ(last, 5u);
  for (const std::uint64_t stop_at : {0, 2, 5})
    EXPECT_THROW(fit_light(image, quick(),
                           [&](std::string_view, std::uint64_t done, std::uint64_t) {
                             return done < stop_at;
                           }),
                 Cancelled)
        << stop_at;
}

TEST(MeasureLightFit, MatchesBruteForce) {
  std::mt19937 random(kSeed + 4);
  LightRig rig = random_rig(3, random);
  rig.lobes[0].lobe.bandwidth_x = 0;  // a cosine in one direction
  rig.lobes[1].lobe.amplitude = 2;
  const Image image = room(64, 32);
  const auto of_map = [&](const Vector3d& v) -> Eigen::Array3d {
    return eval_environment(image, v).cast<double>();
  };
  const auto of_rig = [&](const Vector3d& v) -> Eigen::Array3d {
    return eval_lobes(rig, v.cast<float>()).cast<double>();
  };
  // Irradiance along the two axes of a product rule over normals; the radiance by its own sum.
  double error = 0, truth = 0, irradiance_error = 0, irradiance_truth = 0;
  constexpr int kFine = 256;
  for (int y = 0; y < kFine; ++y)
    for (int x = 0; x < 2 * kFine; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / (2 * kFine), (y + 0.5) / kFine);
      const double weight = std::sin(kPi<double> * (y + 0.5) / kFine);
      error += weight * (of_map(v) - of_rig(v)).square().sum();
      truth += weight * of_map(v).square().sum();
    }
  constexpr int kNormals = 12;
  for (int y = 0; y < kNormals; ++y)
    for (int x = 0; x < 2 * kNormals; ++x) {
      const Vector3d n = direction_from_latlong((x + 0.5) / (2 * kNormals), (y + 0.5) / kNormals);
      const double weight = std::sin(kPi<double> * (y + 0.5) / kNormals);
      const Eigen::Array3d map = brute_force_irradiance(of_map, n, 256, 128);
      irradiance_error +=
          weight * (map - brute_force_irradiance(of_rig, n, 256, 128)).square().sum();
      irradiance_truth += weight * map.square().sum();
    }
  const LightFitError measured = measure_light_fit(image, rig);
  // Different points over steps of radiance; 12 x 24 against 1024 normals.
  EXPECT_NEAR(measured.relative_l2, std::sqrt(error / truth), 2e-3 * measured.relative_l2);
  EXPECT_NEAR(measured.irradiance_relative_l2, std::sqrt(irradiance_error / irradiance_truth),
              5e-3 * measured.irradiance_relative_l2);
}

TEST(MeasureLightFit, OfABlackMapIsZeroOrInfinite) {
  std::mt19937 random(kSeed + 5);
  EXPECT_EQ(measure_light_fit(Image(4, 2), {}).relative_l2, 0);
  EXPECT_TRUE(std::isinf(measure_light_fit(Image(4, 2), random_rig(1, random)).relative_l2));
  EXPECT_NEAR(measure_light_fit(Image(4, 2, Rgb(1, 2, 3)), {}).relative_l2, 1, 1e-12);
  EXPECT_NEAR(measure_light_fit(Image(4, 2, Rgb(1, 2, 3)), {}).irradiance_relative_l2, 1, 1e-12);
}

}  // namespace
}  // namespace burnish::test
