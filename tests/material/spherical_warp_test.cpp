#include "burnish/material/spherical_warp.h"

#include <random>

#include <gtest/gtest.h>

#include "support/csv.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class SphericalWarp : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SphericalWarp, Scalars);

TYPED_TEST(SphericalWarp, MatchesGoldenValues) {
  using T = TypeParam;
  int compared = 0;
  for (const auto& row : test::read_golden("warp_hessian.csv")) {
    const auto vector = [&](const std::string& name) {
      return Vector3<T>(T(row.at(name + "x")), T(row.at(name + "y")), T(row.at(name + "z")));
    };
    AnisotropicGaussian<T> half;
    half.frame = {vector("xh"), vector("yh"), vector("zh")};
    half.bandwidth_x = T(row.at("lambda_h"));
    half.bandwidth_y = T(row.at("mu_h"));
    const Vector3<T> o = vector("o");
    const double cos_view = o.dot(half.frame.z);
    if (cos_view < kMinWarpCosine) continue;
    const AnisotropicGaussian<T> warped = warp_to_incoming(half, o);
    // Frames are rounded to T; the bandwidths hold squares of 1/cos_view.
    const double tolerance = (std::is_same_v<T, float> ? 1e-5 : 1e-11) / (cos_view * cos_view);
    EXPECT_NEAR(warped.bandwidth_x / row.at("lambda_i"), 1, tolerance);
    EXPECT_NEAR(warped.bandwidth_y / row.at("mu_i"), 1, 10 * tolerance);
    EXPECT_NEAR(warped.frame.z.dot(vector("zi")), 1, tolerance);
    // Equal bandwidths have no preferred axes.
    if (row.at("lambda_i") > 1.01 * row.at("mu_i") && row.at("lambda_h") != row.at("mu_h")) {
      const double separation = row.at("lambda_i") / (row.at("lambda_i") - row.at("mu_i"));
      EXPECT_NEAR(std::abs(warped.frame.x.dot(vector("xi"))), 1,
                  tolerance * separation * separation);
    }
    EXPECT_NEAR(warped.frame.x.cross(warped.frame.y).dot(warped.frame.z), 1, 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

TYPED_TEST(SphericalWarp, FollowsTheHalfVectorLobeNearItsAxis) {
  using T = TypeParam;
  const unsigned seed = 23;
  std::mt19937 random(seed);
  for (int k = 0; k < 200; ++k) {
    AnisotropicGaussian<T> half;
    half.frame = test::random_frame(test::random_direction(random), random).cast<T>();
    half.bandwidth_x = 400;
    half.bandwidth_y = 40;
    Vector3<T> o = test::random_direction(random).cast<T>();
    if (o.dot(half.frame.z) < 0) o = -o;
    if (o.dot(half.frame.z) < T(0.2)) continue;
    const AnisotropicGaussian<T> warped = warp_to_incoming(half, o);
    // A tenth of a deviation off the axis, along both of the warped lobe's axes: the Taylor
    // remainder is third order, .1 of an exponent of .005.
    for (const auto& [dx, dy] : {std::pair{0.1, 0.0}, {0.0, 0.1}, {0.07, -0.07}}) {
      const T x = T(dx) / std::sqrt(2 * warped.bandwidth_x),
              y = T(dy) / std::sqrt(2 * warped.bandwidth_y);
      const Vector3<T> i = warped.frame.to_world({x, y, std::sqrt(1 - x * x - y * y)});
      const Vector3<T> h = (i + o).normalized();
      const T truth = eval(half, h);
      EXPECT_NEAR(eval(warped, i) / truth, 1, 5e-3) << "seed " << seed;
    }
  }
}

TYPED_TEST(SphericalWarp, StaysFiniteAtTheAxisAtGrazingAndBehind) {
  using T = TypeParam;
  AnisotropicGaussian<T> half;
  half.bandwidth_x = T(1e4);
  half.bandwidth_y = T(1e4);
  for (const double angle : {0.0, 1e-7, 1e-3, 1.57, kPi<double> / 2, 1.6, 3.0, kPi<double>}) {
    const Vector3<T> o(T(std::sin(angle)), 0, T(std::cos(angle)));
    const AnisotropicGaussian<T> warped = warp_to_incoming(half, o);
    EXPECT_TRUE(warped.frame.x.allFinite() && warped.frame.y.allFinite() &&
                warped.frame.z.allFinite());
    EXPECT_TRUE(std::isfinite(warped.bandwidth_x) && warped.bandwidth_y >= 0);
    EXPECT_NEAR(warped.frame.x.norm(), 1, 1e-4);
    if (angle > 1.6) {
      EXPECT_EQ(warped.amplitude, 0) << angle;
    }
  }
}

}  // namespace
}  // namespace burnish
