#include "harness/environment_truth.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

TEST(EnvironmentTruth, ConstantMapStaysThatConstant) {
  const unsigned seed = 3;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Image map(20, 10, Rgb(0.5f, 1, 7));
  for (const auto& [bx, by] : {std::pair{0.0, 0.0}, {1.0, 30.0}, {1e4, 1e4}, {1e5, 1e3}}) {
    const Frame<double> frame = test::random_frame(test::random_direction(random), random);
    const Eigen::Array3d mean = integrate_environment(map, {frame, bx, by, 1});
    // Only the rounding of the sums is left.
    EXPECT_LT((mean / Eigen::Array3d(0.5, 1, 7) - 1).abs().maxCoeff(), 1e-12);
  }
}

TEST(EnvironmentTruth, RoundLobeAtThePoleSeesItsShareOfACap) {
  // Of a lobe about +y, exp(-b sin^2) of the mass lies beyond an angle, but for what the horizon
  // cuts off.
  Image map(16, 32);
  for (const int bright_rows : {2, 7}) {
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        map.at(x, y) = Rgb::Constant(y < bright_rows ? 1.0f : 0.0f);
    const double edge = std::sin(kPi<double> * bright_rows / map.height);
    for (const double bandwidth : {0.5, 5.0, 100.0}) {
      const Frame<double> frame = frame_from_axis(Vector3d(0, 1, 0));
      const double share = std::expm1(-bandwidth * edge * edge) / std::expm1(-bandwidth);
      // The rule's own error, as stated.
      EXPECT_NEAR(integrate_environment(map, {frame, bandwidth, bandwidth, 1}).x(), share, 1e-5);
    }
  }
}

TEST(EnvironmentTruth, AnisotropicLobeMatchesAnotherRule) {
  // A narrow lobe inside a map of two halves, against the error function across the edge.
  Image map(64, 32);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) map.at(x, y) = Rgb::Constant(x < 32 ? 1.0f : 0.0f);
  // About +z, the middle column; x < 32 is on the side of +x.
  for (const double angle : {-0.02, 0.0, 0.01}) {
    const Vector3d axis(std::sin(angle), 0, std::cos(angle));
    const Frame<double> frame{Vector3d(std::cos(angle), 0, -std::sin(angle)), Vector3d(0, 1, 0),
                              axis};
    const AnisotropicGaussian<double> lobe{{frame.y, -frame.x, frame.z}, 40, 2000, 1};
    // At a height y the edge, the plane x = 0, is sin(angle) sqrt(1 - y^2) from the lobe's plane.
    double share = 0, whole = 0;
    for (const auto& [y, weight] : test::gauss_legendre(64, -1, 1)) {
      const double edge = std::sin(angle) * std::sqrt(1 - y * y);
      share += weight * std::exp(-40 * y * y) * 0.5 * std::erfc(-std::sqrt(2000.0) * edge);
      whole += weight * std::exp(-40 * y * y);
    }
    // The rule's own error, as stated.
    EXPECT_NEAR(integrate_environment(map, lobe).x(), share / whole, 1e-5) << angle;
  }
}

}  // namespace
}  // namespace burnish
