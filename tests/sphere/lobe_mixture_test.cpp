#include "burnish/sphere/lobe_mixture.h"

#include <vector>

#include <gtest/gtest.h>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/normalised_asg.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
std::vector<SphericalGaussian<T>> some_sgs() {
  return {{Vector3<T>::UnitZ(), T(3), T(1)},
          {Vector3<T>(T(0.6), 0, T(0.8)), T(20), T(2)},
          {Vector3<T>(0, -1, 0), T(0.5), T(-0.25)}};
}

template <class T>
class Mixtures : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Mixtures, Scalars);

TYPED_TEST(Mixtures, ValueAndIntegralAreTheSumOfTheLobes) {
  using T = TypeParam;
  const auto lobes = some_sgs<T>();
  const std::span<const SphericalGaussian<T>> span(lobes);
  const Vector3<T> v(T(0.36), T(0.48), T(0.8));
  // Three terms: two additions round.
  const double rounding = 8 * std::numeric_limits<T>::epsilon();
  EXPECT_NEAR(eval_mixture(span, v), eval(lobes[0], v) + eval(lobes[1], v) + eval(lobes[2], v),
              rounding);
  EXPECT_NEAR(integral_mixture(span), integral(lobes[0]) + integral(lobes[1]) + integral(lobes[2]),
              8 * rounding);
  EXPECT_EQ(eval_mixture(span.first(0), v), 0);
  EXPECT_EQ(integral_mixture(span.first(0)), 0);
}

TYPED_TEST(Mixtures, RotateAsOne) {
  using T = TypeParam;
  const auto lobes = some_sgs<T>();
  auto turned = lobes;
  const Eigen::Matrix<T, 3, 3> turn =
      Eigen::AngleAxis<T>(T(1.1), Vector3<T>(2, -1, 1).normalized()).toRotationMatrix();
  rotate_mixture(std::span<SphericalGaussian<T>>(turned), turn);
  const Vector3<T> v(T(0.36), T(0.48), T(0.8));
  // Exponents up to 40 are rounded.
  EXPECT_NEAR(eval_mixture(std::span<const SphericalGaussian<T>>(turned), Vector3<T>(turn * v)),
              eval_mixture(std::span<const SphericalGaussian<T>>(lobes), v),
              100 * std::numeric_limits<T>::epsilon());
}

TEST(Mixtures, InnerProductMatchesQuadrature) {
  const auto a = some_sgs<double>();
  const std::vector<SphericalGaussian<double>> b = {{Vector3d(0.8, 0.6, 0), 7, 1},
                                                    {Vector3d(0, 0.6, 0.8), 2, 3}};
  const std::span<const SphericalGaussian<double>> span_a(a), span_b(b);
  const double truth = test::integrate_sphere(
      [&](const Vector3d& v) { return eval_mixture(span_a, v) * eval_mixture(span_b, v); });
  // Smooth on the sphere: the quadrature converges to rounding.
  EXPECT_NEAR(inner_product_mixture(span_a, span_b) / truth, 1, 1e-11);
}

template <class Lobe>
void expect_mixture_of_one_to_be_the_lobe(const Lobe& lobe) {
  const std::span<const Lobe> one(&lobe, 1);
  const Vector3d v(0.36, 0.48, 0.8);
  EXPECT_EQ(eval_mixture(one, v), eval(lobe, v));
  EXPECT_EQ(integral_mixture(one), integral(lobe));
  Lobe turned = lobe;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector3d(2, -1, 1).normalized()).toRotationMatrix();
  rotate_mixture(std::span<Lobe>(&turned, 1), turn);
  EXPECT_EQ(eval(turned, v), eval(rotate(lobe, turn), v));
}

TEST(Mixtures, HoldAnyLobe) {
  expect_mixture_of_one_to_be_the_lobe(AnisotropicGaussian<double>{{}, 4, 2, 3});
  expect_mixture_of_one_to_be_the_lobe(NormalisedAsg<double>{{}, 4, 2, 3});
}

}  // namespace
}  // namespace burnish
