#include "burnish/sphere/solid_angle.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/octahedral_map.h"
#include "support/quadrature.h"
#include "support/stored.h"

namespace burnish {
namespace {

template <class T>
class SolidAngle : public testing::Test {
 public:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SolidAngle, Scalars);

TYPED_TEST(SolidAngle, OfAnOctantAndOfLunesIsExact) {
  using T = TypeParam;
  const Vector3<T> x = Vector3<T>::UnitX(), y = Vector3<T>::UnitY(), z = Vector3<T>::UnitZ();
  EXPECT_NEAR(triangle_solid_angle(x, y, z), kPi<double> / 2, 2 * this->kEpsilon);
  EXPECT_NEAR(triangle_solid_angle(z, y, x), kPi<double> / 2, 2 * this->kEpsilon);
  // From the pole to two points of the equator: the angle between them, up to nearly pi.
  for (const double angle : {1e-6, 1e-3, 0.5, 2.0, 3.1, 3.1415}) {
    const Vector3<T> turned(T(std::cos(angle)), T(std::sin(angle)), 0);
    const double stored = std::atan2(double(turned.y()), double(turned.x()));
    EXPECT_NEAR(triangle_solid_angle(x, turned, z) / stored, 1, 4 * this->kEpsilon) << angle;
  }
}

// The sum of the angles less pi, each angle between the planes of two sides, in extended precision.
long double by_angles(const Vector3d& a_in, const Vector3d& b_in, const Vector3d& c_in) {
  using Vector = Vector3<long double>;
  const Vector a = a_in.cast<long double>(), b = b_in.cast<long double>(),
               c = c_in.cast<long double>();
  const auto angle = [](const Vector& at, const Vector& to, const Vector& other) {
    return angle_between<long double>(at.cross(to).normalized(), at.cross(other).normalized());
  };
  return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - kPi<long double>;
}

TYPED_TEST(SolidAngle, OfRandomTrianglesIsTheirAngleExcess) {
  using T = TypeParam;
  const unsigned seed = 41;
  std::mt19937 random(seed);
  for (int i = 0; i < 2000; ++i) {
    const Vector3<T> a = test::stored<T>(test::random_direction(random)),
                     b = test::stored<T>(test::random_direction(random)),
                     c = test::stored<T>(test::random_direction(random));
    const double truth = double(
        by_angles(a.template cast<double>(), b.template cast<double>(), c.template cast<double>()));
    // atan2 magnifies its arguments' rounding, and that of the corners' lengths, by the inverse of
    // their size: small where corners are nearly opposite.
    const double size = std::hypot(double(a.cross(b).dot(c)),
                                   1 + double(a.dot(b)) + double(b.dot(c)) + double(c.dot(a)));
    EXPECT_NEAR(triangle_solid_angle(a, b, c), truth, 16 * this->kEpsilon / std::min(size, 1.0))
        << "seed " << seed;
  }
}

TYPED_TEST(SolidAngle, OfTinyTrianglesAndSliversIsTheirPlaneArea) {
  using T = TypeParam;
  const unsigned seed = 42;
  std::mt19937 random(seed);
  for (const double width : {1e-3, 1e-4, 1e-5})
    for (const double height : {1e-3, 1e-4, 1e-5}) {
      const Frame<double> f = test::random_frame(test::random_direction(random), random);
      const Vector3<T> a = test::stored<T>(f.z),
                       b = test::stored<T>((f.z + width * f.x).normalized()),
                       c = test::stored<T>((f.z + height * f.y).normalized());
      // Of the corners as they are stored; the sphere bulges by the square of the size.
      const Vector3d ab = b.template cast<double>() - a.template cast<double>(),
                     ac = c.template cast<double>() - a.template cast<double>();
      const double truth = std::abs(ab.cross(ac).dot(a.template cast<double>())) / 2;
      const double size = width * width + height * height;
      EXPECT_NEAR(triangle_solid_angle(a, b, c) / truth, 1,
                  size + 16 * this->kEpsilon * std::max(width / height, height / width))
          << width << " " << height << " seed " << seed;
    }
  // Around +z with exact zeros, down to where the sides are denormal.
  for (const double width : {1e-5, 1e-15})
    for (const double height : {1e-6, 1e-20}) {
      const Vector3<T> a(0, 0, 1), b(T(width), 0, 1), c(0, T(height), 1);
      const double truth = double(b.x()) * double(c.y()) / 2;
      EXPECT_NEAR(triangle_solid_angle(a, b, c) / truth, 1, 1e-6) << width << " " << height;
    }
  const Vector3<T> z = Vector3<T>::UnitZ(), x = Vector3<T>::UnitX();
  EXPECT_EQ(triangle_solid_angle(z, z, x), 0);
  EXPECT_EQ(triangle_solid_angle(z, z, z), 0);
}

TYPED_TEST(SolidAngle, DoesNotDependOnTheOrderOfTheCorners) {
  using T = TypeParam;
  // Two nearly opposite corners and a third between; a small triangle with one long edge. Each edge
  // is the widest in turn.
  const Vector3d z = Vector3d::UnitZ();
  const Vector3d shapes[][3] = {
      {z, Vector3d(1e-4, 0, -1).normalized(), Vector3d(0.6, 0.8, 0)},
      {z, Vector3d(1e-4, 0, 1).normalized(), Vector3d(5e-5, 1e-6, 1).normalized()}};
  for (const auto& shape : shapes) {
    const Vector3<T> corner[3] = {test::stored<T>(shape[0]), test::stored<T>(shape[1]),
                                  test::stored<T>(shape[2])};
    const double truth =
        double(by_angles(corner[0].template cast<double>(), corner[1].template cast<double>(),
                         corner[2].template cast<double>()));
    int order[3] = {0, 1, 2};
    do {
      // A few roundings; and the truth is a sum of angles of about 1, to 1e-19, of 5e-11.
      EXPECT_NEAR(
          triangle_solid_angle(corner[order[0]], corner[order[1]], corner[order[2]]) / truth, 1,
          8 * this->kEpsilon + 1e-18 / truth)
          << order[0] << order[1] << order[2];
    } while (std::next_permutation(order, order + 3));
  }
}

TYPED_TEST(SolidAngle, OfTrianglesWithNearlyOppositeCornersIsTheirAngleExcess) {
  using T = TypeParam;
  const Vector3<T> z = Vector3<T>::UnitZ(), x = Vector3<T>::UnitX();
  EXPECT_EQ(triangle_solid_angle(z, Vector3<T>(-z), x), 0);
  const unsigned seed = 43;
  std::mt19937 random(seed);
  for (const double tilt : {1e-2, 1e-3, 1e-4})
    for (const double azimuth : {0.0, 0.7, 1.4, -0.7}) {
      const Frame<double> f = test::random_frame(test::random_direction(random), random);
      const Vector3<T> a = test::stored<T>(f.z),
                       b = test::stored<T>(std::sin(tilt) * f.y - std::cos(tilt) * f.z),
                       c = test::stored<T>(std::cos(azimuth) * f.x + std::sin(azimuth) * f.y);
      const double truth = double(by_angles(a.template cast<double>(), b.template cast<double>(),
                                            c.template cast<double>()));
      // c is orthogonal to a to rounding only, and so are their lengths 1: second-order errors,
      // which are measured against the tilt.
      EXPECT_NEAR(triangle_solid_angle(a, b, c) / truth, 1,
                  16 * this->kEpsilon + std::pow(this->kEpsilon / tilt, 2))
          << tilt << " " << azimuth << " seed " << seed;
    }
}

TYPED_TEST(SolidAngle, OfFacesOfASubdividedSphereAddUpToIt) {
  using T = TypeParam;
  constexpr int kSteps = 16;
  double sum = 0;
  for (const double sx : {-1.0, 1.0})
    for (const double sy : {-1.0, 1.0})
      for (const double sz : {-1.0, 1.0}) {
        const auto corner = [&](int i, int j) {
          return Vector3<T>(Vector3d(sx * i, sy * j, sz * (kSteps - i - j)).normalized().cast<T>());
        };
        for (int i = 0; i < kSteps; ++i)
          for (int j = 0; i + j < kSteps; ++j) {
            sum += triangle_solid_angle(corner(i, j), corner(i + 1, j), corner(i, j + 1));
            if (i + j + 2 <= kSteps)
              sum += triangle_solid_angle(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
          }
      }
  // 2048 faces, each with its corners rounded.
  EXPECT_NEAR(sum / (4 * kPi<double>), 1, 16 * this->kEpsilon);
}

TYPED_TEST(SolidAngle, OfTexelsAddsUpToTheSphere) {
  using T = TypeParam;
  for (const int height : {1, 2, 7, 512}) {
    double sum = 0;
    for (int row = 0; row < height; ++row) {
      const T pixel = latlong_pixel_solid_angle<T>(row, 2 * height, height);
      sum += double(pixel) * 2 * height;
      EXPECT_NEAR(pixel / latlong_pixel_solid_angle<T>(height - 1 - row, 2 * height, height), 1,
                  this->kEpsilon);
    }
    EXPECT_NEAR(sum / (4 * kPi<double>), 1, 8 * this->kEpsilon) << height;
  }
  // The pole's cap of radius t = pi / 512, 2 pi (1 - cos t), in 1024 parts.
  const double t = kPi<double> / 512, s = std::sin(t / 2);
  EXPECT_NEAR(latlong_pixel_solid_angle<T>(0, 1024, 512) / (4 * kPi<double> * s * s / 1024), 1,
              8 * this->kEpsilon);
  EXPECT_NEAR(octahedral_texel_solid_angle<T>(64) * 4096 / (4 * kPi<double>), 1, this->kEpsilon);
}

TEST(SolidAngle, OfAnOctahedralTexelIsThatOfItsCorners) {
  // A texel's edges are not great circles; two triangles differ from it by the square of its size.
  constexpr int kResolution = 256;
  for (const auto& [x, y] : {std::pair{130, 150}, {10, 40}, {200, 131}, {255, 3}}) {
    const auto corner = [x = x, y = y](int i, int j) {
      return octahedral_to_direction(double(x + i) / kResolution, double(y + j) / kResolution);
    };
    const double area = triangle_solid_angle(corner(0, 0), corner(1, 0), corner(1, 1)) +
                        triangle_solid_angle(corner(0, 0), corner(1, 1), corner(0, 1));
    EXPECT_NEAR(area / octahedral_texel_solid_angle<double>(kResolution), 1, 0.02) << x << " " << y;
  }
}

}  // namespace
}  // namespace burnish
