#include "harness/studio_environment.h"

#include <cmath>

#include <gtest/gtest.h>

namespace burnish {
namespace {

Rgb total_power(const Image& image) {
  Rgb sum = Rgb::Zero();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += float(latlong_pixel_solid_angle(image, y)) * image.at(x, y);
  return sum;
}

TEST(StudioEnvironment, IsFinitePositiveAndHighDynamicRange) {
  const Image image = studio_environment();
  ASSERT_EQ(image.width, 512);
  ASSERT_EQ(image.height, 256);
  float darkest = 1e9f, brightest = 0;
  for (const Rgb& pixel : image.pixels) {
    ASSERT_TRUE(pixel.allFinite());
    darkest = std::min(darkest, pixel.minCoeff());
    brightest = std::max(brightest, pixel.maxCoeff());
  }
  EXPECT_GT(darkest, 0.01f);
  EXPECT_LT(brightest, 11.0f);
  EXPECT_GT(brightest, 9.0f);
}

TEST(StudioEnvironment, LightsComeFromAboveKeyWarmFillCool) {
  const Image image = studio_environment();
  const auto at = [&](double longitude_deg, double latitude_deg) {
    return eval_environment(
        image, direction_from_latlong(0.5 - longitude_deg / 360, 0.5 - latitude_deg / 180));
  };
  EXPECT_GT(at(50, 38).x(), 1.5f * at(50, 38).z());
  EXPECT_LT(at(-70, 22).x(), 0.6f * at(-70, 22).z());
  EXPECT_GT(luminance(at(180, 34)), 7.0f);
  // The strip follows a great circle, which is lower 30 degrees to the side.
  EXPECT_GT(luminance(at(150, 30.3)), 7.0f) << "the strip light is long";
  for (const double longitude : {-170.0, -60.0, 10.0, 90.0})
    EXPECT_LT(luminance(at(longitude, -40)), 0.1f) << "no light from below";
}

TEST(StudioEnvironment, PowerDoesNotDependOnTheResolution) {
  const Rgb coarse = total_power(studio_environment(256)), fine = total_power(studio_environment());
  // 9 samples a pixel on edges of 3 or more degrees.
  EXPECT_LT((coarse / fine - 1).abs().maxCoeff(), 0.01f);
}

TEST(WorldFromEnvironment, TurnsYToUpAndIsARotation) {
  for (const Vector3f& up : {Vector3f(0, 1, 0), Vector3f(0, 0, 1), Vector3f(0, -1, 0)})
    for (const double degrees : {0.0, 30.0, 250.0}) {
      const Eigen::Matrix3f m = world_from_environment(up, degrees);
      EXPECT_LT((m * Vector3f::UnitY() - up).norm(), 1e-6f);
      EXPECT_LT((m * m.transpose() - Eigen::Matrix3f::Identity()).norm(), 1e-6f);
      EXPECT_NEAR(m.determinant(), 1, 1e-6);
    }
  // Counter-clockwise seen from above takes +z to +x.
  EXPECT_LT((world_from_environment(Vector3f::UnitY(), 90) * Vector3f::UnitZ() - Vector3f::UnitX())
                .norm(),
            1e-6f);
}

}  // namespace
}  // namespace burnish
