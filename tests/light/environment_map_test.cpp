#include "burnish/light/environment_map.h"

#include <random>

#include <gtest/gtest.h>

#include "burnish/light/light_rig.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

TEST(EnvironmentMap, HasOpenExrsOrientation) {
  // ImfEnvmap.h: the centre looks along +z, longitude falls to the right, latitude falls to the
  // bottom.
  const auto at = [](const Vector3d& d) { return latlong_from_direction(d); };
  EXPECT_NEAR((at({0, 0, 1}) - Vector2<double>(0.5, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((at({1, 0, 0}) - Vector2<double>(0.25, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((at({-1, 0, 0}) - Vector2<double>(0.75, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR(at({0, 1, 0}).y(), 0, 1e-12);
  EXPECT_NEAR(at({0, -1, 0}).y(), 1, 1e-12);
}

TEST(EnvironmentMap, DirectionsRoundTrip) {
  const unsigned seed = 2;
  std::mt19937 random(seed);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d d = test::random_direction(random);
    const Vector2<double> uv = latlong_from_direction(d);
    EXPECT_LT((direction_from_latlong(uv.x(), uv.y()) - d).norm(), 1e-12) << "seed " << seed;
    EXPECT_TRUE(uv.x() >= 0 && uv.x() < 1 && uv.y() >= 0 && uv.y() < 1);
  }
}

TEST(EnvironmentMap, PixelSolidAnglesFillTheSphere) {
  for (const auto& [w, h] : {std::pair{1, 1}, {64, 32}, {7, 5}}) {
    const Image map(w, h);
    double sum = 0;
    for (int y = 0; y < h; ++y) sum += w * latlong_pixel_solid_angle(map, y);
    EXPECT_NEAR(sum, 4 * kPi<double>, 1e-12);
  }
}

TEST(EnvironmentMap, LooksUpThePixelThatCoversADirection) {
  Image map(8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) map.at(x, y) = Rgb::Constant(float(10 * y + x));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Vector3d d = direction_from_latlong((x + 0.3) / 8, (y + 0.7) / 4);
      EXPECT_EQ(eval_environment(map, d).x(), float(10 * y + x));
    }
  }
}

TEST(LightRig, RotatesItsLobes) {
  LightRig rig;
  rig.lobes.resize(1);
  rig.lobes[0].lobe.bandwidth_x = 30;
  rig.lobes[0].color = Rgb(1, 2, 3);
  const Eigen::Matrix3f rotation =
      Eigen::AngleAxisf(0.7f, Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  LightRig turned = rig;
  rotate(turned, rotation);
  const Vector3f d = Vector3f(0.1f, 0.2f, 0.9f).normalized();
  EXPECT_NEAR((eval_lobes(turned, rotation * d) - eval_lobes(rig, d)).abs().maxCoeff(), 0, 1e-5);
  EXPECT_GT(eval_lobes(rig, d).x(), 0.1);
}

}  // namespace
}  // namespace burnish
