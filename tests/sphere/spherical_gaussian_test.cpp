#include "burnish/sphere/spherical_gaussian.h"

#include <random>

#include <gtest/gtest.h>

#include "support/csv.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class Sg : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Sg, Scalars);

TYPED_TEST(Sg, IntegralMatchesClosedFormAndItsLimits) {
  using T = TypeParam;
  const T tolerance = 8 * std::numeric_limits<T>::epsilon();
  for (const double sharpness : {0.0, 1e-8, 1e-3, 1.0, 30.0, 1e6}) {
    const long double l = sharpness;
    const double truth =
        sharpness == 0 ? 4 * kPi<double> : double(2 * kPi<long double> * -std::expm1(-2 * l) / l);
    SphericalGaussian<T> lobe;
    lobe.sharpness = T(sharpness);
    EXPECT_NEAR(integral(lobe) / truth, 1, tolerance) << sharpness;
  }
}

TYPED_TEST(Sg, InnerProductMatchesGoldenValues) {
  using T = TypeParam;
  // The two axes are rounded to T: near the axis, exp() magnifies that by sharpness * angle.
  // Measured over exactly representable inputs: float 3.6e-6, double 2.7e-12 (docs/maths.md); rows
  // that leave T's range are skipped.
  const double epsilon = std::numeric_limits<T>::epsilon();
  int compared = 0;
  for (const auto& row : test::read_golden("sg_inner_product.csv")) {
    if (row.at("value") < 1e-30) continue;
    SphericalGaussian<T> a, b;
    a.sharpness = T(row.at("lambda1"));
    b.sharpness = T(row.at("lambda2"));
    const double angle = row.at("angle");
    b.axis = {T(std::sin(angle)), 0, T(std::cos(angle))};
    const double smaller = std::min(row.at("lambda1"), row.at("lambda2"));
    const double tolerance = 32 * epsilon * (1 + smaller * std::max(angle, epsilon));
    if (tolerance > 0.1) continue;
    EXPECT_NEAR(inner_product(a, b) / row.at("value"), 1, tolerance)
        << row.at("lambda1") << " " << row.at("lambda2") << " " << angle;
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

TYPED_TEST(Sg, ProductIsExact) {
  using T = TypeParam;
  const unsigned seed = 11;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-2, 2);
  for (int i = 0; i < 200; ++i) {
    SphericalGaussian<T> a, b;
    a.axis = test::random_direction(random).cast<T>();
    b.axis = test::random_direction(random).cast<T>();
    a.sharpness = T(std::pow(10, exponent(random)));
    b.sharpness = T(std::pow(10, exponent(random)));
    const SphericalGaussian<T> c = product(a, b);
    const Vector3<T> v = test::random_direction(random).cast<T>();
    const T expected = eval(a, v) * eval(b, v);
    // Exponents reach 800: their rounding is that many epsilons of the value.
    EXPECT_NEAR(eval(c, v), expected, 2000 * std::numeric_limits<T>::epsilon() * expected + 1e-30)
        << "seed " << seed;
  }
}

TEST(Sg, OppositeAxesOfEqualSharpnessGiveAConstant) {
  SphericalGaussian<double> a, b;
  b.axis = -a.axis;
  a.sharpness = b.sharpness = 3;
  const auto c = product(a, b);
  EXPECT_EQ(c.sharpness, 0);
  EXPECT_NEAR(c.amplitude, std::exp(-6.0), 1e-15);
}

}  // namespace
}  // namespace burnish
