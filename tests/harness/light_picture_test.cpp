#include "harness/light_picture.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace burnish {
namespace {

constexpr unsigned kSeed = 20130719;
constexpr int kPanelStep = kPanelWidth + kPanelGap;

EnvironmentLobe make_light(const Vector3d& axis, float bandwidth_x, float bandwidth_y) {
  EnvironmentLobe light;
  light.lobe = {frame_from_axis(axis.normalized().eval()).cast<float>(), bandwidth_x, bandwidth_y,
                1.0f};
  light.color = Rgb(0.5f, 0.5f, 0.5f);
  return light;
}

// Half its peak, which the lines are not, is the brightest that a lobe of make_light() is.
bool is_line(const Rgb& color) { return color.x() == 1 && color.z() == 0; }

TEST(LightPicture, ContourIsWhereTheLobeFallsByHalfAnExponent) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<float> log_bandwidth(-3, 12);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (int trial = 0; trial < 50; ++trial) {
    const float bandwidth_x = trial == 0 ? 0 : std::exp(log_bandwidth(random));
    const EnvironmentLobe light = make_light({normal(random), normal(random), normal(random)},
                                             bandwidth_x, std::exp(log_bandwidth(random)));
    const AnisotropicGaussian<double> lobe = {light.lobe.frame.cast<double>(),
                                              light.lobe.bandwidth_x, light.lobe.bandwidth_y, 1};
    for (double angle = 0; angle < 6.28; angle += 0.1)
      // The frame is float: an exponent of 1/2 that is off by some 1e-6.
      EXPECT_NEAR(eval(lobe, lobe_contour(light.lobe, angle)), std::exp(-0.5), 3e-6)
          << trial << ", " << angle;
  }
}

// In the middle, long across a pole, over a pole, around the other, across the seam.
const EnvironmentLobe kLights[] = {
    make_light({0.2, 0.3, 1}, 5, 200), make_light({0.1, 1, 0.05}, 3, 300),
    make_light({0.02, -1, -0.01}, 40, 60), make_light({0.01, -0.2, -1}, 20, 60),
    make_light({1, 0, 0}, 1e5f, 1e5f)};

TEST(LightPicture, LinesAreTheContours) {
  for (const EnvironmentLobe& light : kLights) {
    LightRig rig;
    rig.lobes.push_back(light);
    const Image picture = draw_light_fit(Image(4, 2), rig, 0);
    ASSERT_EQ(picture.width, 3 * kPanelWidth + 2 * kPanelGap);
    ASSERT_EQ(picture.height, kPanelHeight);
    const auto place = [](const Vector3d& direction) -> Vector2<double> {
      const Vector2<double> uv = latlong_from_direction(direction);
      return {uv.x() * kPanelWidth, uv.y() * kPanelHeight};
    };
    const Vector2<double> axis = place(light.lobe.frame.z.cast<double>());
    SCOPED_TRACE(testing::Message() << "axis " << light.lobe.frame.z.transpose());
    // The whole contour is drawn ...
    for (double angle = 0; angle < 6.28; angle += 0.01) {
      const Vector2<double> at = place(lobe_contour(light.lobe, angle));
      bool found = false;
      for (int y = int(at.y()) - 1; y <= int(at.y()) + 1; ++y)
        for (int x = int(at.x()) - 1; x <= int(at.x()) + 1; ++x)
          found = found || (y >= 0 && y < kPanelHeight &&
                            is_line(picture.at(kPanelStep + (x + kPanelWidth) % kPanelWidth, y)));
      EXPECT_TRUE(found) << angle;
    }
    // ... and nothing else: the lobe passes exp(-1/2) within a pixel of each that is.
    int lines = 0;
    for (int y = 0; y < kPanelHeight; ++y)
      for (int x = 0; x < kPanelWidth; ++x) {
        if (!is_line(picture.at(kPanelStep + x, y))) continue;
        ++lines;
        const double across = std::abs(x + 0.5 - axis.x());
        if (std::max(std::min(across, kPanelWidth - across), std::abs(y + 0.5 - axis.y())) < 4)
          continue;  // the cross at the axis
        float lowest = 1, highest = 0;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) {
            const double v = std::clamp((y + 0.5 + j) / kPanelHeight, 0.0, 1.0);
            const Vector3d direction = direction_from_latlong((x + 0.5 + i) / kPanelWidth, v);
            const float value = eval(light.lobe, Vector3f(direction.cast<float>()));
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
          }
        EXPECT_LE(lowest, std::exp(-0.5f) + 1e-3f) << x << ", " << y;
        EXPECT_GE(highest, std::exp(-0.5f) - 1e-3f) << x << ", " << y;
      }
    EXPECT_GT(lines, 5);
    EXPECT_LT(lines, 4 * kPanelWidth);
  }
}

TEST(LightPicture, DifferenceIsBlackWhereTheFitIsRight) {
  LightRig rig;
  rig.lobes = {kLights[0], kLights[3]};
  Image exact(kPanelWidth, kPanelHeight);
  for (int y = 0; y < exact.height; ++y)
    for (int x = 0; x < exact.width; ++x)
      exact.at(x, y) = eval_lobes(
          rig,
          direction_from_latlong((x + 0.5) / exact.width, (y + 0.5) / exact.height).cast<float>());
  const Image picture = draw_light_fit(exact, rig, 2);
  for (int y = 0; y < kPanelHeight; ++y)
    for (int x = 0; x < kPanelWidth; ++x) {
      // Values up to 4, rounded twice.
      ASSERT_LT(picture.at(2 * kPanelStep + x, y).abs().maxCoeff(), 1e-6f);
      ASSERT_NEAR(picture.at(x, y)[1], 4 * exact.at(x, y)[1], 1e-6f);
    }
  // Of a constant map without lights it is the map.
  const Image plain = draw_light_fit(Image(8, 4, Rgb(0.25f, 0.5f, 1)), {}, -1);
  for (int y = 0; y < kPanelHeight; ++y)
    for (int x = 0; x < kPanelWidth; ++x) {
      ASSERT_TRUE((plain.at(x, y) == Rgb(0.125f, 0.25f, 0.5f)).all());
      ASSERT_TRUE((plain.at(kPanelStep + x, y) == 0).all());
      ASSERT_TRUE((plain.at(2 * kPanelStep + x, y) == plain.at(x, y)).all());
    }
}

TEST(LightPicture, AveragesLargeMapsAndStretchesSmallOnes) {
  // One column in three of a pixel of the panel.
  Image large(3 * kPanelWidth, 3 * kPanelHeight);
  for (int y = 0; y < large.height; ++y) large.at(3 * 100 + 1, y) = Rgb(3, 3, 3);
  const Image picture = draw_light_fit(large, {}, 0);
  // Seen by one or two of four points.
  EXPECT_GE(picture.at(100, 7)[0], 0.75f);
  EXPECT_LE(picture.at(100, 7)[0], 1.5f);
  EXPECT_EQ(picture.at(99, 7)[0], 0);
  EXPECT_EQ(picture.at(101, 7)[0], 0);
  const Image one = draw_light_fit(Image(1, 1, Rgb(1, 1, 1)), {}, 0);
  EXPECT_EQ(one.at(kPanelWidth - 1, kPanelHeight - 1)[0], 1);
}

TEST(LightPicture, ExposesTheTypicalRadianceToMiddleGrey) {
  EXPECT_NEAR(picture_exposure_stops(Image(8, 4, Rgb(3, 3, 3))), std::log2(0.18 / 3), 1e-5);
  Image sun(64, 32, Rgb(3, 3, 3));
  sun.at(20, 10) = Rgb(1e6f, 1e6f, 1e6f);
  // The sun's pixel is 1e-3 of the sphere: log2(1e6 / 3) = 18 of it.
  EXPECT_NEAR(picture_exposure_stops(sun), std::log2(0.18 / 3), 0.02);
  EXPECT_EQ(picture_exposure_stops(Image(8, 4)), 0);
  Image half(8, 4, Rgb(3, 3, 3));
  for (int x = 0; x < 8; ++x) half.at(x, 3) = Rgb(0, 0, 0);
  EXPECT_NEAR(picture_exposure_stops(half), std::log2(0.18 / 3), 1e-5);
}

}  // namespace
}  // namespace burnish
