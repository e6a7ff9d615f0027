#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "distance_transform_support.h"

// What the transform says of the true boundary, with boundaries known in closed form.
namespace burnish {
namespace {

using test::mask_of;
using test::pitch;
using test::transform;

constexpr unsigned kSeed = 4711;

TEST(SphericalDistanceTransform, PitchIsTwiceTheLargestWayToAnEdge) {
  for (const int n : {64, 128, 256}) {
    double largest = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        for (const auto& [dx, dy] : {std::pair{-0.5, 0.0}, {0.5, 0.0}, {0.0, -0.5}, {0.0, 0.5}})
          largest =
              std::max(largest, angle_between<double>(octahedral_texel_direction<double>(x, y, n),
                                                      octahedral_to_direction<double>(
                                                          (x + 0.5 + dx) / n, (y + 0.5 + dy) / n)));
    EXPECT_NEAR(pitch(n), 2 * largest, 1e-7);
    // A texel has 4 pi / n^2 sr, so no pitch can be below its root, and Clarberg's map stretches
    // it by less than half as much again.
    EXPECT_GT(pitch(n), 3.54 / n);
    EXPECT_LT(pitch(n), 1.5 * 3.55 / n);
  }
}

// The bound stated in the header: |distance| is at most h/2 too small and at most h too large. With
// boundaries known in closed form.
void expect_closed_form(int n, int resolution, const std::function<double(const Vector3d&)>& ssdf) {
  const std::vector<float> found =
      transform(mask_of(n, [&](const Vector3d& d) { return ssdf(d) > 0; }), resolution);
  const double h = pitch(n);
  double too_large = 0, too_small = 0;
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x) {
      const double truth = ssdf(octahedral_texel_direction<double>(x, y, resolution));
      const double value = found[static_cast<std::size_t>(y * resolution + x)];
      too_large = std::max(too_large, std::abs(value) - std::abs(truth));
      // A texel within h/2 of the boundary may have the wrong sign.
      if (std::abs(truth) > h / 2) {
        ASSERT_GT(value * truth, 0) << x << ", " << y << ": " << value << " for " << truth;
        too_small = std::max(too_small, std::abs(truth) - std::abs(value));
      }
    }
  EXPECT_LE(too_large, h);
  EXPECT_LE(too_small, h / 2 + 1e-3 * h);  // float rounding, 1e-6 / sin d, where d > h / 2
}

TEST(SphericalDistanceTransform, HalfSpaceIsTheArcSine) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 8; ++i)
    normals.push_back(Vector3d(normal(random), normal(random), normal(random)).normalized());
  for (const Vector3d& n : normals) {
    SCOPED_TRACE(testing::Message() << "normal " << n.transpose());
    for (const int resolution : {32, 128})
      expect_closed_form(128, resolution, [&](const Vector3d& d) {
        return std::asin(std::clamp(n.dot(d), -1.0, 1.0));
      });
  }
}

TEST(SphericalDistanceTransform, CapIsTheAngleToItsRim) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (const double radius : {0.15, 0.5, 1.2, 2.0, 2.9})
    for (int i = 0; i < 3; ++i) {
      const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
      SCOPED_TRACE(testing::Message() << "radius " << radius << " axis " << axis.transpose());
      expect_closed_form(
          128, 32, [&](const Vector3d& d) { return angle_between<double>(d, axis) - radius; });
    }
}

TEST(SphericalDistanceTransform, NearestOfTwoOccludersCounts) {
  const Vector3d a = Vector3d(1, 0.3, 0.2).normalized(), b = Vector3d(-0.2, -1, 0.5).normalized();
  expect_closed_form(128, 32, [&](const Vector3d& d) {
    return std::min(angle_between<double>(d, a) - 0.4, angle_between<double>(d, b) - 0.25);
  });
}

TEST(SphericalDistanceTransform, DistanceIsContinuous) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const int n = 64;
  const double h = pitch(n);
  for (const double density : {0.01, 0.5, 0.95}) {
    std::bernoulli_distribution visible(density);
    const VisibilityMask mask = mask_of(n, [&](const Vector3d&) { return visible(random); });
    for (const int resolution : {16, 32, 64}) {
      const std::vector<float> ssdf = transform(mask, resolution);
      const auto at = [&](int i) { return ssdf[static_cast<std::size_t>(i)]; };
      for (int y = 0; y < resolution; ++y)
        for (int x = 0; x < resolution; ++x)
          for (const int other :
               {octahedral_wrap(x + 1, y, resolution), octahedral_wrap(x, y + 1, resolution)}) {
            const int here = y * resolution + x;
            const double apart =
                angle_between<double>(octahedral_texel_direction<double>(x, y, resolution),
                                      octahedral_texel_direction<double>(
                                          other % resolution, other / resolution, resolution));
            // Of one sign, a distance changes by no more than the way (and the rounding of both);
            // where the sign changes there is a boundary point within the corner's four texels of
            // the path, at each end at most a texel's diagonal aside.
            const bool crosses = at(here) * at(other) <= 0;
            ASSERT_LE(std::abs(at(here) - at(other)),
                      apart + (crosses ? 2 * std::sqrt(2.0) * h : 2e-6 / std::sin(h / 4)));
          }
    }
  }
}

}  // namespace
}  // namespace burnish
