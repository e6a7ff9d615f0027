#include "burnish/sphere/special_functions.h"

#include <limits>

#include <gtest/gtest.h>

namespace burnish {
namespace {

template <class T>
class SpecialFunctions : public testing::Test {
 public:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
  static constexpr T kTiny = std::numeric_limits<T>::denorm_min();
  static constexpr T kMax = std::numeric_limits<T>::max();
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SpecialFunctions, Scalars);

TYPED_TEST(SpecialFunctions, OneMinusExpOverKeepsItsDigitsNearZero) {
  using T = TypeParam;
  for (double exponent = -30; exponent < 30; exponent += 0.01) {
    const T x = T(std::pow(10, exponent));
    const long double truth = -std::expm1(-static_cast<long double>(x)) / x;
    // expm1 and the division round.
    EXPECT_NEAR(double(one_minus_exp_over(x) / truth), 1, 2 * this->kEpsilon) << x;
  }
  EXPECT_EQ(one_minus_exp_over(T(0)), 1);
  EXPECT_EQ(one_minus_exp_over(this->kTiny), 1);
  EXPECT_GT(one_minus_exp_over(this->kMax), 0);
}

// exp(-x) In(x) = 1/pi integral over [0, pi] of exp(x (cos t - 1)) cos(n t): the trapezoid rule
// converges faster than any power of its step.
double bessel_by_trapezoid(int order, long double x) {
  constexpr int kSteps = 1000;  // twenty for each 1/sqrt(x) at the largest x below
  long double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const long double t = kPi<long double> * i / kSteps, s = std::sin(t / 2);
    const long double weight = i == 0 || i == kSteps ? 0.5L : 1.0L;
    sum += weight * std::exp(-2 * x * s * s) * std::cos(order * t);
  }
  return double(sum / kSteps);
}

TYPED_TEST(SpecialFunctions, ScaledBesselFunctionsMatchTheirIntegrals) {
  using T = TypeParam;
  for (double exponent = -2; exponent < 3; exponent += 0.03) {
    const T x = T(std::pow(10, exponent));
    // The stated errors, in epsilons.
    EXPECT_NEAR(scaled_bessel_i0(x) / bessel_by_trapezoid(0, x), 1, 5 * this->kEpsilon) << x;
    const double i1 = bessel_by_trapezoid(1, x);
    EXPECT_NEAR(scaled_bessel_i1(x), i1, 10 * this->kEpsilon * i1) << x;
    EXPECT_EQ(scaled_bessel_i0(-x), scaled_bessel_i0(x));
    EXPECT_EQ(scaled_bessel_i1(-x), -scaled_bessel_i1(x));
  }
}

TYPED_TEST(SpecialFunctions, ScaledBesselFunctionsReachTheirLimits) {
  using T = TypeParam;
  EXPECT_EQ(scaled_bessel_i0(T(0)), 1);
  EXPECT_EQ(scaled_bessel_i1(T(0)), 0);
  for (const T x : {T(1e-30), T(1e-20)})
    EXPECT_NEAR(scaled_bessel_i1(x) / (x / 2), 1, 10 * this->kEpsilon) << x;
  // 1 / sqrt(2 pi x), whose next term, 1 / (8 x), is below rounding.
  for (const T x : {T(1e17), T(1e30), this->kMax}) {
    const double limit = 1 / (std::sqrt(2 * kPi<double>) * std::sqrt(double(x)));
    EXPECT_NEAR(scaled_bessel_i0(x) / limit, 1, 10 * this->kEpsilon) << x;
    EXPECT_NEAR(scaled_bessel_i1(x) / limit, 1, 10 * this->kEpsilon) << x;
  }
}

TYPED_TEST(SpecialFunctions, InverseErfInvertsErf) {
  using T = TypeParam;
  const auto check = [this](T y) {
    const long double x = inverse_erf(y);
    // One Newton step in extended precision tells how far x is from the root.
    const long double miss =
        std::abs(y) < T(0.5) ? std::erf(x) - y
                             : (1 - std::abs(static_cast<long double>(y))) - std::erfc(std::abs(x));
    const long double slope = 2 / std::sqrt(kPi<long double>) * std::exp(-x * x);
    EXPECT_LT(double(std::abs(miss / slope / x)), 2 * this->kEpsilon) << y;
    EXPECT_EQ(inverse_erf(-y), T(-x));
  };
  const double least = std::log10(double(std::numeric_limits<T>::min()));
  for (double exponent = least + 0.1; exponent < 0; exponent += 0.1)
    check(T(std::pow(10, exponent)));
  for (T y = T(0.001); y < 1; y += T(0.001)) check(y);
  for (T rest = T(0.4); rest > this->kEpsilon; rest *= T(0.9)) check(1 - rest);
  check(1 - T(this->kEpsilon) / 2);
}

TYPED_TEST(SpecialFunctions, InverseErfIsFiniteAtTheEndsAndRises) {
  using T = TypeParam;
  EXPECT_EQ(inverse_erf(T(0)), 0);
  EXPECT_EQ(inverse_erf(T(1)), inverse_erf(1 - T(this->kEpsilon) / 2));
  EXPECT_EQ(inverse_erf(T(-1)), -inverse_erf(T(1)));
  EXPECT_NEAR(inverse_erf(T(1)), sizeof(T) == 4 ? 3.8325 : 5.8636, 1e-4);
  EXPECT_NEAR(inverse_erf(this->kTiny), this->kTiny, this->kTiny);
  // Across the joint of the polynomial and the asymptote.
  const T joint = std::sqrt(1 - std::exp(T(-5)));
  T below = joint;
  for (int i = 0; i < 200; ++i) below = std::nextafter(below, T(0));
  for (int i = 0; i < 400; ++i) {
    const T above = std::nextafter(below, T(1));
    // Neighbours may differ by the rounding of either.
    EXPECT_GE(inverse_erf(above), inverse_erf(below) * (1 - 4 * T(this->kEpsilon)));
    below = above;
  }
}

}  // namespace
}  // namespace burnish
