#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/frame.h"
#include "burnish/sphere/octahedral_map.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class Directions : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Directions, Scalars);

constexpr unsigned kSeed = 7;

TYPED_TEST(Directions, AngleBetweenKeepsDigitsForNearlyEqualAndOpposite) {
  using T = TypeParam;
  for (const double angle : {1e-7, 1e-4, 0.1, 1.5, 3.0}) {
    const Vector3<T> a = Vector3<T>::UnitX();
    const Vector3<T> b(T(std::cos(angle)), T(std::sin(angle)), 0);
    // One rounding of the sine, one of the arc tangent.
    EXPECT_NEAR(angle_between(a, b), angle, 4 * std::numeric_limits<T>::epsilon() * angle);
    EXPECT_NEAR(kPi<T> - angle_between(a, Vector3<T>(-b)), angle,
                8 * std::numeric_limits<T>::epsilon());
  }
}

TYPED_TEST(Directions, FrameFromAxisIsOrthonormalAndRightHanded) {
  using T = TypeParam;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    Vector3<T> axis = test::random_direction(random).cast<T>();
    if (i == 0) axis = {0, 0, 1};
    if (i == 1) axis = {0, 0, -1};
    if (i == 2) axis = {1, 0, -T(0)};
    const Frame<T> f = frame_from_axis(axis);
    const T tolerance = 8 * std::numeric_limits<T>::epsilon();
    EXPECT_NEAR(f.x.dot(f.y), 0, tolerance) << "seed " << kSeed;
    EXPECT_NEAR(f.x.norm(), 1, tolerance);
    EXPECT_NEAR((f.x.cross(f.y) - axis).norm(), 0, tolerance);
  }
}

TYPED_TEST(Directions, FrameFromBadTangentFallsBack) {
  using T = TypeParam;
  const Vector3<T> normal = Vector3<T>(1, 2, 3).normalized();
  for (const Vector3<T>& tangent : {Vector3<T>(0, 0, 0), Vector3<T>(normal * 5),
                                    Vector3<T>(std::numeric_limits<T>::quiet_NaN(), 0, 0)}) {
    const Frame<T> f = frame_from_normal_tangent(normal, tangent);
    EXPECT_NEAR(f.x.norm(), 1, 1e-5);
    EXPECT_NEAR(f.x.dot(normal), 0, 1e-5);
  }
}

template <class T>
void expect_minimal_rotation(const Vector3<T>& from, const Vector3<T>& to) {
  // Two reflections, each of a few roundings.
  const double tolerance = 16 * std::numeric_limits<T>::epsilon();
  const Eigen::Matrix<T, 3, 3> r = minimal_rotation(from, to);
  EXPECT_LT((r * from - to).norm(), tolerance) << from.transpose() << " to " << to.transpose();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix<T, 3, 3>::Identity()).norm(), tolerance);
  EXPECT_NEAR(r.determinant(), 1, tolerance);
  // By the angle between the two, not more: the trace of a rotation is 1 + 2 cos(angle).
  EXPECT_NEAR(r.trace(), 1 + 2 * from.dot(to), tolerance);
}

TYPED_TEST(Directions, MinimalRotationIsOneForAnyTwoDirections) {
  using T = TypeParam;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(kSeed);
    const Vector3d from = test::random_direction(random), to = test::random_direction(random);
    expect_minimal_rotation<T>(from.cast<T>(), to.cast<T>());
  }
  for (const double angle : {0.0, 1e-30, 1e-15, 1e-8, 1e-7, 1e-6, 1e-4, 1e-2})
    for (int i = 0; i < 50; ++i) {
      const Vector3d from = test::random_direction(random);
      const Vector3d aside = test::random_frame(from, random).x;
      const Vector3d near = std::cos(angle) * from + std::sin(angle) * aside;
      expect_minimal_rotation<T>(from.cast<T>(), near.cast<T>());
      expect_minimal_rotation<T>(from.cast<T>(), Vector3<T>(-near.cast<T>()));
    }
}

TYPED_TEST(Directions, MinimalRotationOfOppositeDirectionsIsAHalfTurnAboutTheFramesY) {
  using T = TypeParam;
  const Vector3<T> from(T(0.6), 0, T(0.8));
  const Vector3<T> y = frame_from_axis(from).y;
  EXPECT_LT((minimal_rotation(from, Vector3<T>(-from)) * y - y).norm(),
            8 * std::numeric_limits<T>::epsilon());
  EXPECT_EQ((minimal_rotation<T>(Vector3<T>::UnitZ(), Vector3<T>::UnitZ())),
            (Eigen::Matrix<T, 3, 3>::Identity()));
}

TYPED_TEST(Directions, OctahedralMapRoundTrips) {
  using T = TypeParam;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<T> unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const T u = unit(random), v = unit(random);
    const Vector3<T> d = octahedral_to_direction(u, v);
    ASSERT_NEAR(d.norm(), 1, 4 * std::numeric_limits<T>::epsilon());
    const Vector2<T> back = direction_to_octahedral(d);
    ASSERT_NEAR(back.x(), u, 4 * std::numeric_limits<T>::epsilon()) << "seed " << kSeed;
    ASSERT_NEAR(back.y(), v, 4 * std::numeric_limits<T>::epsilon()) << "seed " << kSeed;
  }
}

TEST(OctahedralMap, IsEqualArea) {
  // Solid angle of a texel's two spherical triangles (Van Oosterom & Strackee). A texel's curved
  // edges leave 2 % near a pole; the pole's own texels are quarter discs, of which the triangle
  // holds 2 sqrt(2) / pi.
  const auto triangle = [](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
  };
  const int n = 256;
  double total = 0;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      Vector3d corner[4];
      for (int k = 0; k < 4; ++k)
        corner[k] = octahedral_to_direction((x + (k & 1)) / double(n), (y + (k >> 1)) / double(n));
      const double area = std::abs(triangle(corner[0], corner[1], corner[3]) +
                                   triangle(corner[0], corner[3], corner[2]));
      total += area;
      const bool at_corner = (x == 0 || x == n - 1) && (y == 0 || y == n - 1);
      const bool at_centre = (x == n / 2 || x == n / 2 - 1) && (y == n / 2 || y == n / 2 - 1);
      const double expected = at_corner || at_centre ? 2 * std::sqrt(2) / kPi<double> : 1;
      EXPECT_NEAR(area * n * n / (4 * kPi<double>), expected, 0.02) << x << " " << y;
    }
  }
  EXPECT_NEAR(total, 4 * kPi<double>, 1e-4);
}

TEST(OctahedralMap, TangentsMatchFiniteDifferences) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(0.001, 0.999);
  const double h = 1e-6;
  for (int i = 0; i < 5000; ++i) {
    const double u = unit(random), v = unit(random);
    const double s = std::abs(2 * u - 1), t = std::abs(2 * v - 1);
    // A difference across a fold, or next to a pole, is not a derivative.
    if (s < 1e-3 || t < 1e-3 || std::abs(s + t - 1) < 1e-3 || s + t < 0.01 || s + t > 1.99)
      continue;
    const auto d = octahedral_tangents(u, v);
    const Vector3d du =
        (octahedral_to_direction(u + h, v) - octahedral_to_direction(u - h, v)) / (2 * h);
    const Vector3d dv =
        (octahedral_to_direction(u, v + h) - octahedral_to_direction(u, v - h)) / (2 * h);
    // Third derivatives grow like 1/r^2 toward the poles (r > .01 here): h^2 / r^2 = 1e-8 times a
    // constant.
    ASSERT_LT((d.du - du).norm() + (d.dv - dv).norm(), 1e-6) << u << " " << v << " seed " << kSeed;
    ASSERT_NEAR(d.du.cross(d.dv).norm(), 4 * kPi<double>, 1e-9);
  }
}

TEST(OctahedralMap, WrapMeetsItsNeighbour) {
  const int n = 32;
  // Texels on both sides of any edge, the map's own included, are a texel's angle apart.
  const double texel = std::sqrt(4 * kPi<double>) / n;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const Vector3d here = octahedral_texel_direction<double>(x, y, n);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int index = octahedral_wrap(x + dx, y + dy, n);
        ASSERT_GE(index, 0);
        ASSERT_LT(index, n * n);
        const Vector3d there = octahedral_texel_direction<double>(index % n, index / n, n);
        EXPECT_LT(angle_between(here, there), 1.6 * texel) << x << " " << y;
      }
    }
  }
}

TEST(OctahedralMap, WrapMirrorsAtEveryEdge) {
  // The two texels that meet across an edge are mirror images about its middle; by hand for 4 x 4.
  struct Case {
    int x, y, wrapped_x, wrapped_y;
  };
  for (const Case& c : {Case{-1, 0, 0, 3},
                        {-1, 1, 0, 2},
                        {4, 0, 3, 3},
                        {4, 2, 3, 1},
                        {0, -1, 3, 0},
                        {1, -1, 2, 0},
                        {0, 4, 3, 3},
                        {2, 4, 1, 3},
                        {-2, 1, 1, 2},
                        {1, 5, 2, 2},
                        // Past a corner: the opposite one, which is the same direction.
                        {-1, -1, 3, 3},
                        {4, 4, 0, 0}})
    EXPECT_EQ(octahedral_wrap(c.x, c.y, 4), c.wrapped_y * 4 + c.wrapped_x) << c.x << " " << c.y;
}

TEST(OctahedralMap, FootprintInterpolatesASmoothFunctionAndItsGradient) {
  // f(d) = a.d has the tangent gradient a - (a.d) d.
  const int n = 256;
  const Vector3d a(0.3, -0.7, 0.5);
  std::vector<double> map(n * n);
  for (int i = 0; i < n * n; ++i)
    map[i] = a.dot(octahedral_texel_direction<double>(i % n, i / n, n));
  std::mt19937 random(kSeed);
  int near_fold = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d d = test::random_direction(random);
    const Vector2<double> uv = direction_to_octahedral(d);
    const auto footprint = octahedral_footprint(uv, n);
    double value = 0, by_u = 0, by_v = 0;
    for (int k = 0; k < 4; ++k) {
      value += footprint.weight[k] * map[footprint.texel[k]];
      by_u += footprint.weight_u[k] * map[footprint.texel[k]];
      by_v += footprint.weight_v[k] * map[footprint.texel[k]];
    }
    EXPECT_NEAR(value, a.dot(d), 0.01);  // one texel is 0.014 rad
    const Vector3d gradient = octahedral_gradient(d, uv, by_u, by_v);
    const double error = (gradient - (a - a.dot(d) * d)).norm();
    // Texels that a fold or a pole crosses have a kinked map; they are a few in a hundred.
    if (error > 0.05) ++near_fold;
  }
  EXPECT_LT(near_fold, 2000 * 0.04) << "seed " << kSeed;
}

}  // namespace
}  // namespace burnish
