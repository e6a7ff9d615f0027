#include "burnish/light/lobe_split.h"

#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/asg_integral.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 5;

EnvironmentLobe random_light(float bandwidth_x, float bandwidth_y, std::mt19937& random) {
  EnvironmentLobe light;
  light.lobe.frame = frame_from_axis(test::random_direction(random).cast<float>().eval());
  light.lobe.bandwidth_x = bandwidth_x;
  light.lobe.bandwidth_y = bandwidth_y;
  light.color = {1, 2, 3};
  return light;
}

double integral_of(const EnvironmentLobe& light) {
  return double(light.lobe.amplitude) *
         asg_integral_exact<double>(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
}

double eval_all(const std::vector<EnvironmentLobe>& lobes, const Vector3d& direction) {
  double sum = 0;
  for (const EnvironmentLobe& light : lobes)
    sum += double(eval(light.lobe, Vector3f(direction.cast<float>())));
  return sum;
}

class LobeSplit : public testing::TestWithParam<std::pair<float, float>> {};

TEST_P(LobeSplit, PartsAreNarrowAndSumToTheLobe) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  const auto [bandwidth_x, bandwidth_y] = GetParam();
  const EnvironmentLobe light = random_light(bandwidth_x, bandwidth_y, random);
  constexpr float kLeast = 8;
  const std::vector<EnvironmentLobe> parts = split_wide_lobes({light}, kLeast);
  ASSERT_GT(parts.size(), 1u);
  double sum = 0;
  for (const EnvironmentLobe& part : parts) {
    sum += integral_of(part);
    EXPECT_TRUE((part.color == light.color).all());
    EXPECT_NEAR(part.lobe.frame.x.cross(part.lobe.frame.y).dot(part.lobe.frame.z), 1, 1e-5);
    // About the axis; toward the edge of its hemisphere a lobe is foreshortened.
    if (part.lobe.frame.z.dot(light.lobe.frame.z) > 0.95f) {
      EXPECT_GE(std::min(part.lobe.bandwidth_x, part.lobe.bandwidth_y), 0.75f * kLeast);
    }
  }
  EXPECT_NEAR(sum / integral_of(light), 1, 1e-5);  // float amplitudes
  const Vector3d normal = test::random_direction(random);
  const Vector3d axis = light.lobe.frame.z.cast<double>();
  const auto difference = [&](const Vector3d& d) {
    return eval_all(parts, d) - eval_all({light}, d);
  };
  const double squared = test::integrate_sphere(
      [&](const Vector3d& d) { return std::pow(eval_all({light}, d), 2); }, axis);
  const double error =
      test::integrate_sphere([&](const Vector3d& d) { return std::pow(difference(d), 2); }, axis);
  const double flux_error = test::integrate_sphere(
      [&](const Vector3d& d) { return difference(d) * std::max(normal.dot(d), 0.0); }, axis);
  EXPECT_LT(std::sqrt(error / squared), 0.15);                 // what the header states
  EXPECT_LT(std::abs(flux_error), 0.02 * integral_of(light));  // the cosine sees hardly anything
}

INSTANTIATE_TEST_SUITE_P(Shapes, LobeSplit,
                         testing::Values(std::pair{1.0f, 1.0f}, std::pair{0.5f, 40.0f},
                                         std::pair{4.0f, 2.0f}, std::pair{100.0f, 3.0f}));

TEST(LobeSplit, NarrowLobesStayAsTheyAre) {
  std::mt19937 random(kSeed);
  const std::vector<EnvironmentLobe> lobes = {random_light(8, 9, random),
                                              random_light(1e4f, 30, random)};
  const std::vector<EnvironmentLobe> parts = split_wide_lobes(lobes, 8);
  ASSERT_EQ(parts.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(parts[i].lobe.bandwidth_x, lobes[i].lobe.bandwidth_x);
    EXPECT_EQ(parts[i].lobe.frame.z, lobes[i].lobe.frame.z);
  }
  EXPECT_TRUE(split_wide_lobes({}, 8).empty());
}

}  // namespace
}  // namespace burnish
