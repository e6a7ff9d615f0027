#include "burnish/sphere/circular_gaussian.h"

#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class Circular : public testing::Test {
 public:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
  static constexpr T kMax = std::numeric_limits<T>::max();
};
template <class T>
class Longitudinal : public Circular<T> {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Circular, Scalars);
TYPED_TEST_SUITE(Longitudinal, Scalars);

// By 16 Gauss-Legendre nodes on each of 64 panels: to rounding for sharpness up to 1e4.
template <class F>
double integrate(double from, double to, const F& f) {
  static const auto rule = test::gauss_legendre(16, 0, 1);
  constexpr int kPanels = 64;
  const double step = (to - from) / kPanels;
  double sum = 0;
  for (int panel = 0; panel < kPanels; ++panel)
    for (const auto& [x, weight] : rule) sum += weight * step * f(from + step * (panel + x));
  return sum;
}

double by_definition(double sharpness, double center, double phi) {
  return std::exp(sharpness * (std::cos(phi - center) - 1));
}

TYPED_TEST(Circular, ValueMatchesTheDefinitionAndIsPeriodic) {
  using T = TypeParam;
  for (const double sharpness : {0.0, 0.5, 20.0, 1e3})
    for (const double phi : {-3.0, -0.1, 0.0, 0.4, 2.0}) {
      const CircularGaussian<T> lobe{T(0.25), T(sharpness), T(3)};
      const double truth = 3 * by_definition(sharpness, 0.25, T(phi));
      // The exponent, and its derivative by the angle, are rounded.
      EXPECT_NEAR(eval(lobe, T(phi)), truth, truth * (8 + 8 * sharpness) * this->kEpsilon);
      EXPECT_NEAR(eval(lobe, T(phi) + 2 * kPi<T>), truth,
                  truth * (8 + 20 * sharpness) * this->kEpsilon);
    }
  const CircularGaussian<T> narrow{T(0), T(1e12), T(1)};
  // cos(x) - 1 = -x^2 / 2 but for x^2 / 12 of it.
  EXPECT_NEAR(eval(narrow, T(1e-6)), std::exp(-0.5), 4 * this->kEpsilon + 1e-13);
}

TYPED_TEST(Circular, IntegralMatchesQuadrature) {
  using T = TypeParam;
  for (const double sharpness : {0.0, 1e-3, 1.0, 30.0, 1e4}) {
    const CircularGaussian<T> lobe{T(1), T(sharpness), T(2)};
    const double reach = std::min(kPi<double>, 12 / std::sqrt(sharpness));
    const double truth = 2 * integrate(-reach, reach, [&](double x) {
                           return by_definition(double(lobe.sharpness), 0, x);
                         });
    // The stated error, and the rounding of a thousand terms and of the exponent in the sum.
    EXPECT_NEAR(integral(lobe) / truth, 1, 4 * this->kEpsilon + 1e-13) << sharpness;
  }
  const CircularGaussian<T> narrow{T(0), this->kMax, T(1)};
  EXPECT_NEAR(integral(narrow) * std::sqrt(this->kMax / (2 * kPi<T>)), 1, 1e-5);
}

TYPED_TEST(Circular, ProductIsExact) {
  using T = TypeParam;
  const unsigned seed = 31;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(-kPi<double>, kPi<double>), exponent(-2, 2);
  for (int i = 0; i < 500; ++i) {
    const CircularGaussian<T> a{T(angle(random)), T(std::pow(10, exponent(random))), T(2)};
    const CircularGaussian<T> b{T(angle(random)), T(std::pow(10, exponent(random))), T(0.5)};
    const T phi = T(angle(random));
    const double truth = double(eval(a, phi)) * double(eval(b, phi));
    // Exponents reach 400; so much is lost of their rounding.
    EXPECT_NEAR(eval(product(a, b), phi), truth, 1000 * this->kEpsilon * truth + 1e-30)
        << "seed " << seed;
    const double integral_of_product = integrate(-kPi<double>, kPi<double>, [&](double x) {
      return by_definition(a.sharpness, a.center, x) * by_definition(b.sharpness, b.center, x);
    });
    EXPECT_NEAR(inner_product(a, b), integral_of_product,
                1000 * this->kEpsilon * integral_of_product + 1e-30)
        << "seed " << seed;
  }
}

TYPED_TEST(Circular, ProductOfOppositeLobesIsAConstant) {
  using T = TypeParam;
  const CircularGaussian<T> a{T(0), T(5), T(1)}, b{kPi<T>, T(5), T(1)};
  const CircularGaussian<T> c = product(a, b);
  EXPECT_LT(c.sharpness, 10 * this->kEpsilon);
  EXPECT_NEAR(c.amplitude / std::exp(-10.0), 1, 20 * this->kEpsilon);
}

TYPED_TEST(Circular, NothingOverflowsAtTheLargestSharpness) {
  using T = TypeParam;
  const CircularGaussian<T> a{T(0), this->kMax, T(1)}, b{T(1), this->kMax, T(1)};
  EXPECT_EQ(product(a, a).sharpness, this->kMax);
  EXPECT_EQ(product(a, a).amplitude, 1);
  EXPECT_EQ(inner_product(a, b), 0);
  EXPECT_NEAR(product(a, b).center, 0.5, 8 * this->kEpsilon);
  EXPECT_NEAR(integral_over_arc(a, T(-1), T(1)) / integral(a), 1, 1e-5);
  EXPECT_NEAR(integral_over_arc_fast(a, T(-1), T(1)) / integral(a), 1, 1e-5);
  const CircularGaussian<T> constant{T(0), T(0), T(2)};
  EXPECT_NEAR(integral_over_arc(constant, T(1), T(2)), 2, 8 * this->kEpsilon);
}

/// Where the truth's quadrature needs to go from the point that is nearest to the center.
double reach_from(double nearest, double sharpness) {
  return std::sqrt(nearest * nearest + 2 * 60 / sharpness);
}

struct Truth {
  double value;
  double allowed;  ///< relative error, but for that of the rule, in epsilons
};

/// Integral of f between two distances from the lobe's center, of which f is a function, f(x) being
/// exp(-exponent(x)) but for a smooth factor.
template <class Exponent, class F>
Truth from_center(double sharpness, double low, double high, const Exponent& exponent, const F& f) {
  const double nearest = std::max({low, -high, 0.0});
  const double reach = kPi<double> / 2 * reach_from(nearest, sharpness);
  const double value = integrate(std::max(low, -reach), std::min(high, reach), f);
  // The exponent rounds by four epsilons of itself, and the ends' distances by one of theirs.
  const double ends = std::abs(low) * f(low) + std::abs(high) * f(high);
  return {value, 4 + 4 * exponent(nearest) + (value > 0 ? ends / value : 0.0)};
}

/// The truth of integral_over_arc, of the arguments as they are stored: distances from the center
/// in extended precision.
Truth over_arc(double sharpness, double center, double from, double to) {
  const auto exponent = [&](double x) { return 2 * sharpness * std::pow(std::sin(x / 2), 2); };
  const auto f = [&](double x) { return std::exp(-exponent(x)); };
  constexpr long double turn = 2 * kPi<long double>;
  const long double a = static_cast<long double>(from) - center,
                    b = static_cast<long double>(to) - center;
  const long double middle = std::round((a + b) / 2 / turn);
  Truth sum = {0, 0};
  for (const long double turns : {middle - 1, middle, middle + 1}) {
    const double low = double(std::max(a - turns * turn, -turn / 2));
    const double high = double(std::min(b - turns * turn, turn / 2));
    if (low >= high) continue;
    const Truth part = from_center(sharpness, low, high, exponent, f);
    sum.value += part.value;
    sum.allowed += part.value * part.allowed;
  }
  if (sum.value > 0) sum.allowed /= sum.value;
  return sum;
}

TYPED_TEST(Circular, IntegralOverAnArcKeepsItsStatedError) {
  using T = TypeParam;
  const unsigned seed = 32;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(-9, 9), length(0, 2 * kPi<double>), exponent(-3, 14);
  const double stated = sizeof(T) == 4 ? 1e-6 : 3e-12;
  for (int i = 0; i < 2000; ++i) {
    // A quarter is about as wide as a circle: the most difficult for the rule.
    const double power = i % 4 ? exponent(random) : 0.7 + exponent(random) / 10;
    const CircularGaussian<T> lobe{T(angle(random)), T(std::pow(10, power)), T(1)};
    // Half of the arcs near the lobe, half anywhere, tails included; in any period.
    const double spread = i % 2 ? 1 : std::min(1.0, 3 / std::sqrt(double(lobe.sharpness)));
    const double period = 2 * kPi<double> * (i % 3 - 1);
    const T from = T(lobe.center + spread * angle(random) / 9 + period),
            to = T(from + spread * length(random));
    if (to - from >= 2 * kPi<double>) continue;
    const double k = lobe.sharpness;
    const Truth truth = over_arc(k, lobe.center, from, to);
    if (truth.value > 1e-30) {
      // The truth knows the center to an extended precision's epsilon, 1e-18.
      EXPECT_NEAR(integral_over_arc(lobe, from, to) / truth.value, 1,
                  stated + truth.allowed * this->kEpsilon + 1e-18 * std::sqrt(k))
          << k << " " << lobe.center << " " << from << " " << to << " seed " << seed;
    }
    if (k < 5) continue;
    // The stated error falls with the cube of the sharpness; 9.3e-4 at 5. A float's erf and
    // exponents round; erf's arguments are at most 4 where they count.
    EXPECT_NEAR(
        integral_over_arc_fast(lobe, from, to), truth.value,
        (9.3e-4 * 125 / (k * k * k) + 20 * this->kEpsilon + 1e-18 * std::sqrt(k)) * integral(lobe))
        << k << " " << lobe.center << " " << from << " " << to << " seed " << seed;
  }
}

TYPED_TEST(Circular, IntegralOverMostOfTheCircleKeepsItsStatedError) {
  using T = TypeParam;
  // Where the whole circle counts, and is widest against the lobe.
  const double stated = sizeof(T) == 4 ? 1e-6 : 3e-12;
  for (double k = 8; k < 40; k *= 1.03)
    for (const double from : {-3.1, -2.0, -0.4, 0.3, 1.0}) {
      const Truth truth = over_arc(T(k), 0, T(from), T(3.14));
      EXPECT_NEAR(
          integral_over_arc(CircularGaussian<T>{T(0), T(k), T(1)}, T(from), T(3.14)) / truth.value,
          1, stated + truth.allowed * this->kEpsilon)
          << k << " " << from;
    }
}

TYPED_TEST(Circular, ArcsAddUpToTheCircle) {
  using T = TypeParam;
  const double stated = sizeof(T) == 4 ? 1e-6 : 3e-12;
  for (const double sharpness : {0.0, 1e-3, 1.0, 30.0, 1e6, 1e12})
    for (const double cut : {-2.0, 0.0, 0.5, 3.0}) {
      const CircularGaussian<T> lobe{T(0.3), T(sharpness), T(1)};
      const T from = T(cut);
      const T sum = integral_over_arc(lobe, from, from + T(1)) +
                    integral_over_arc(lobe, from + T(1), from + 2 * kPi<T>);
      // The circle's two ends do not quite meet, at a value of at most 1 / 2 pi at sharpness 0.
      EXPECT_NEAR(sum / integral(lobe), 1, stated + 8 * this->kEpsilon) << sharpness << " " << cut;
    }
}

TYPED_TEST(Longitudinal, ProductIsExact) {
  using T = TypeParam;
  const LongitudinalGaussian<T> a{T(0.3), T(40), T(2)}, b{T(-0.2), T(7), T(3)};
  const LongitudinalGaussian<T> c = product(a, b);
  for (const double theta : {-1.0, 0.0, 0.25, 0.8})
    EXPECT_NEAR(eval(c, T(theta)) / (eval(a, T(theta)) * eval(b, T(theta))), 1,
                200 * this->kEpsilon);
  const LongitudinalGaussian<T> narrow{T(0.3), this->kMax, T(1)};
  EXPECT_EQ(product(narrow, narrow).sharpness, this->kMax);
  EXPECT_EQ(product(narrow, narrow).amplitude, 1);
}

TYPED_TEST(Longitudinal, IntegralMatchesQuadratureAlsoInTheTails) {
  using T = TypeParam;
  for (const double sharpness : {1e-30, 1e-6, 0.5, 25.0, 1e3})
    for (const auto& [from, to] :
         {std::pair{-1.5, 1.5}, {0.5, 0.6}, {1.2, 1.5}, {-1.0, -0.7}, {-1.5, -1.2}}) {
      const LongitudinalGaussian<T> g{T(0.1), T(sharpness), T(2)};
      const double k = g.sharpness, center = g.center;
      const double truth = 2 * integrate(T(from), T(to), [&](double x) {
                             return std::exp(-k * (x - center) * (x - center) / 2);
                           });
      if (truth < 1e-30) continue;
      // The exponent's rounding.
      EXPECT_NEAR(integral(g, T(from), T(to)) / truth, 1, 20 * (1 + k) * this->kEpsilon)
          << sharpness << " " << from;
    }
}

TYPED_TEST(Longitudinal, IntegralWithTheCosineKeepsItsStatedError) {
  using T = TypeParam;
  const double stated = sizeof(T) == 4 ? 1e-6 : 3e-12;
  int compared = 0;
  for (const double sharpness : {0.0, 1e-6, 0.5, 25.0, 36.6, 1e3, 1e8, 1e14, 1e30})
    for (const double center : {-1.4, 0.0, 0.3, 0.6, 1.57})
      // Fixed ranges, and to six deviations on either side.
      for (const auto& [from, to, deviations] : {std::tuple{-1.57, 1.57, 0.0},
                                                 {0.5, 0.6, 0.0},
                                                 {-1.0, -0.7, 0.0},
                                                 {-6.0, 6.0, 1.0},
                                                 {-2.0, -1.0, 1.0},
                                                 {0.5, 6.0, 1.0},
                                                 {3.0, 4.0, 1.0}}) {
        const LongitudinalGaussian<T> g{T(center), T(sharpness), T(2)};
        const double deviation = sharpness > 1 ? 1 / std::sqrt(sharpness) : 1.0;
        const auto bound = [&, relative = deviations > 0](double x) {
          return T(std::clamp(relative ? center + x * deviation : x, -1.57, 1.57));
        };
        const double k = g.sharpness, c = g.center, low = double(bound(from)) - c,
                     high = double(bound(to)) - c;
        if (low >= high) continue;
        const Truth truth = from_center(
            k, low, high, [&](double x) { return k * x * x / 2; },
            [&](double x) { return 2 * std::cos(c + x) * std::exp(-k * x * x / 2); });
        if (truth.value < 1e-30) continue;
        ++compared;
        EXPECT_NEAR(integral_times_cosine(g, bound(from), bound(to)) / truth.value, 1,
                    stated + truth.allowed * this->kEpsilon)
            << sharpness << " " << center << " " << from << " " << to;
      }
  EXPECT_GT(compared, 100);
}

TYPED_TEST(Longitudinal, WhatIsBeyondThePoleByRoundingCountsAsNothing) {
  using T = TypeParam;
  const T pole = std::nextafter(kPi<T> / 2, T(2)), beyond = std::nextafter(pole, T(2));
  const LongitudinalGaussian<T> g{kPi<T> / 2, T(4), T(1)};
  EXPECT_EQ(integral_times_cosine(g, pole, beyond), 0);
  const SphericalGaussian<T> lobe{Vector3<T>::UnitX(), T(1e8), T(1)};
  EXPECT_EQ(azimuthal_factor(lobe, Frame<T>{}, beyond).sharpness, 0);
}

TYPED_TEST(Circular, FactorsOfASphericalGaussianMultiplyToIt) {
  using T = TypeParam;
  const unsigned seed = 33;
  std::mt19937 random(seed);
  for (int i = 0; i < 300; ++i) {
    const Frame<T> frame = test::random_frame(test::random_direction(random), random).cast<T>();
    const SphericalGaussian<T> lobe{test::random_direction(random).cast<T>(),
                                    T(std::pow(10, -2 + 4 * (i / 300.0))), T(2)};
    const double theta = std::uniform_real_distribution<double>(-1.57, 1.57)(random);
    const double phi = std::uniform_real_distribution<double>(-3.14, 3.14)(random);
    const Vector3<T> v = frame.to_world({T(std::cos(theta) * std::cos(phi)),
                                         T(std::cos(theta) * std::sin(phi)), T(std::sin(theta))});
    const T product_of_factors = eval(longitudinal_factor(lobe, frame), T(theta)) *
                                 eval(azimuthal_factor(lobe, frame, T(theta)), T(phi));
    // Exponents up to 200, with angles and directions rounded.
    EXPECT_NEAR(product_of_factors, eval(lobe, v),
                20 * (1 + lobe.sharpness) * this->kEpsilon * eval(lobe, v) + 1e-30)
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace burnish
