#include "burnish/sphere/spherical_gaussian.h"

#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/sg_clamped_cosine.h"
#include "support/csv.h"
#include "support/quadrature.h"
#include "support/sphere_sampling.h"

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
  EXPECT_EQ(c.axis, a.axis);
}

TYPED_TEST(Sg, AmplitudesNeitherOverflowNorUnderflowOnTheWay) {
  using T = TypeParam;
  constexpr T kMax = std::numeric_limits<T>::max(), kMin = std::numeric_limits<T>::min();
  const double tolerance = 200 * std::numeric_limits<T>::epsilon();  // exponents to 60, rounded
  SphericalGaussian<T> a, b;
  a.sharpness = b.sharpness = 30;
  b.axis = -b.axis;
  for (const bool swapped : {false, true}) {
    a.amplitude = swapped ? kMax : 4 * kMin;
    b.amplitude = swapped ? 4 * kMin : kMax;
    // 4 kMin kMax is 16; with exp(-60) next to kMin it would have left the range.
    EXPECT_NEAR(product(a, b).amplitude / (16 * std::exp(-60.0)), 1, tolerance);
    EXPECT_NEAR(inner_product(a, b) / (16 * 4 * kPi<double> * std::exp(-60.0)), 1, tolerance);
    // And so would kMax with the 4 pi of a constant.
    const SphericalGaussian<T> large{a.axis, T(0), a.amplitude}, small{a.axis, T(0), b.amplitude};
    EXPECT_NEAR(inner_product(large, small) / (64 * kPi<double>), 1, tolerance);
    EXPECT_NEAR(convolve(large, small).amplitude / (64 * kPi<double>), 1, tolerance);
  }
  a.amplitude = b.amplitude = kMax;
  b.axis = a.axis;
  EXPECT_EQ(product(a, b).amplitude, kMax);
  a.amplitude = -kMax;
  EXPECT_EQ(inner_product(a, b), -kMax);
}

TYPED_TEST(Sg, NothingOverflowsAtTheLargestSharpness) {
  using T = TypeParam;
  constexpr T kMax = std::numeric_limits<T>::max();
  SphericalGaussian<T> narrow, other;
  narrow.sharpness = other.sharpness = kMax;
  narrow.amplitude = other.amplitude = T(1e30);
  EXPECT_NEAR(integral(narrow) / T(1e30) * kMax, 2 * kPi<T>, 1e-5);
  const SphericalGaussian<T> same = product(narrow, other);
  EXPECT_EQ(same.sharpness, kMax);
  EXPECT_TRUE(std::isfinite(same.amplitude));
  EXPECT_NEAR((same.axis - narrow.axis).norm(), 0, std::numeric_limits<T>::epsilon());
  EXPECT_TRUE(std::isfinite(inner_product(narrow, other)));
  EXPECT_GT(inner_product(narrow, other), 0);
  EXPECT_NEAR(convolve(narrow, other).sharpness / kMax, 0.5, 1e-6);
  EXPECT_NEAR(convolve_fast(narrow, other).sharpness / kMax, 0.5, 1e-6);
  other.axis = Vector3<T>::UnitX();
  EXPECT_EQ(inner_product(narrow, other), 0);
  // A lobe so narrow picks the other's value: its integral times that.
  other.sharpness = T(0.5);
  narrow.amplitude = other.amplitude = 1;
  EXPECT_NEAR(inner_product(narrow, other) / (integral(narrow) * std::exp(T(-0.5))), 1, 1e-5);
}

TYPED_TEST(Sg, RotationTurnsTheLobe) {
  using T = TypeParam;
  const Eigen::Matrix<T, 3, 3> turn =
      Eigen::AngleAxis<T>(T(0.7), Vector3<T>(1, 2, 3).normalized()).toRotationMatrix();
  const SphericalGaussian<T> lobe{Vector3<T>(0, T(0.6), T(0.8)), T(9), T(2)};
  const Vector3<T> v = Vector3<T>(T(0.3), T(0.2), T(0.9)).normalized();
  EXPECT_NEAR(eval(rotate(lobe, turn), Vector3<T>(turn * v)), eval(lobe, v),
              60 * std::numeric_limits<T>::epsilon());  // the exponent, up to 18, is rounded
}

// Exact convolution at an angle whose cosine is 1 - height: the inner product of the two lobes.
double convolution_at(double l1, double l2, double height) {
  const double d = std::sqrt((l1 + l2) * (l1 + l2) - 2 * l1 * l2 * height);
  return 2 * kPi<double> * std::exp(-2 * l1 * l2 * height / (d + l1 + l2)) * -std::expm1(-2 * d) /
         d;
}

struct ConvolutionError {
  double relative_l2, mass, mean;
};

template <class T>
ConvolutionError convolution_error(const SphericalGaussian<T>& lobe, double l1, double l2) {
  // Over the heights 1 - v . axis that matter; dv = 2 pi dheight.
  const double reach = std::min(2.0, 40 * (1 / l1 + 1 / l2));
  double square = 0, difference = 0, mass = 0, lobe_mass = 0, mean = 0, lobe_mean = 0;
  for (const auto& [h, w] : test::gauss_legendre(200, 0, reach)) {
    const double truth = convolution_at(l1, l2, h);
    const double value = double(lobe.amplitude) * std::exp(-double(lobe.sharpness) * h);
    square += w * truth * truth;
    difference += w * (truth - value) * (truth - value);
    mass += w * truth;
    lobe_mass += w * value;
    mean += w * truth * h;
    lobe_mean += w * value * h;
  }
  return {std::sqrt(difference / square), lobe_mass / mass - 1, lobe_mean / mean - 1};
}

TYPED_TEST(Sg, ConvolutionKeepsMassAndMeanAndItsStatedError) {
  using T = TypeParam;
  // The stated errors, half a unit of the last place given.
  const double rounding = 40 * std::numeric_limits<T>::epsilon();
  for (const auto& [sharpness, error, error_fast] : {std::tuple{0.5, 0.0004, 0.098},
                                                     {1., .0046, .116},
                                                     {2., .0292, .0613},
                                                     {5., .0543, .0346},
                                                     {10., .0319, .0185},
                                                     {50., .0062, .0036},
                                                     {100., .0031, .0018}}) {
    SphericalGaussian<T> lobe;
    lobe.sharpness = T(sharpness);
    const ConvolutionError e = convolution_error(convolve(lobe, lobe), sharpness, sharpness);
    EXPECT_NEAR(e.relative_l2, error, 6e-5) << sharpness;
    EXPECT_NEAR(e.mass, 0, rounding) << sharpness;
    EXPECT_NEAR(e.mean, 0, rounding) << sharpness;
    const ConvolutionError fast =
        convolution_error(convolve_fast(lobe, lobe), sharpness, sharpness);
    EXPECT_NEAR(fast.relative_l2, error_fast, 6e-4) << sharpness;
    EXPECT_NEAR(fast.mass, 0, rounding) << sharpness;
  }
}

TYPED_TEST(Sg, ConvolutionOfUnlikeLobesKeepsMassAndMean) {
  using T = TypeParam;
  const double rounding = 40 * std::numeric_limits<T>::epsilon();
  for (const double l1 : {0.01, 1.0, 30.0, 1e4})
    for (const double l2 : {0.1, 7.0, 500.0, 1e5}) {
      SphericalGaussian<T> a, b;
      a.sharpness = T(l1);
      b.sharpness = T(l2);
      const ConvolutionError e = convolution_error(convolve(a, b), a.sharpness, b.sharpness);
      EXPECT_NEAR(e.mass, 0, rounding) << l1 << " " << l2;
      EXPECT_NEAR(e.mean, 0, rounding) << l1 << " " << l2;
    }
}

TYPED_TEST(Sg, ConvolutionWithAConstantIsAConstant) {
  using T = TypeParam;
  SphericalGaussian<T> lobe, constant;
  lobe.sharpness = 10;
  constant.sharpness = 0;
  const SphericalGaussian<T> result = convolve(lobe, constant);
  EXPECT_EQ(result.sharpness, 0);
  EXPECT_NEAR(result.amplitude / integral(lobe), 1, 4 * std::numeric_limits<T>::epsilon());
}

TYPED_TEST(Sg, SamplesHaveTheDensity) {
  using T = TypeParam;
  const unsigned seed = 20;
  constexpr int kSamples = 100000;
  std::mt19937 random(seed);
  const std::vector<double> sharpnesses = {0, 1e-9, 1e-3, 1, 30, 1e4, 1e8};
  for (const double sharpness : sharpnesses) {
    SphericalGaussian<double> lobe;
    lobe.axis = test::random_direction(random);
    lobe.sharpness = sharpness;
    const SphericalGaussian<T> lobe_t{lobe.axis.cast<T>(), T(sharpness), T(1)};
    const test::SphereCells cells(frame_from_axis(lobe.axis), 0.3 / std::sqrt(sharpness + 1), 1);
    const test::ChiSquare chi = test::chi_square_on_sphere(
        cells,
        [&](double u, double v) -> Vector3d {
          // The offset from the axis, so that a float direction at 1e-4 rad keeps three digits.
          const Vector3<T> d = sample(lobe_t, T(u), T(v));
          EXPECT_NEAR(d.norm(), 1, 8 * std::numeric_limits<T>::epsilon());
          return (d - lobe_t.axis).template cast<double>() + lobe.axis;
        },
        [&](const Vector3d& d) { return pdf(lobe, d); }, kSamples, seed);
    EXPECT_GT(chi.p_value, test::sidak_level(0.01, int(sharpnesses.size())))
        << chi.report("sg") << " sharpness " << sharpness << " seed " << seed;
  }
}

TYPED_TEST(Sg, SamplingReachesItsLimits) {
  using T = TypeParam;
  constexpr T kMax = std::numeric_limits<T>::max(), kTiny = std::numeric_limits<T>::denorm_min();
  for (const T sharpness : {T(0), kTiny, T(1), kMax}) {
    const SphericalGaussian<T> lobe{Vector3<T>::UnitZ(), sharpness, T(1)};
    for (const T u : {T(0), kTiny, T(0.5), 1 - std::numeric_limits<T>::epsilon(), T(1)})
      EXPECT_NEAR(sample(lobe, u, T(0.3)).norm(), 1, 4 * std::numeric_limits<T>::epsilon())
          << sharpness << " " << u;
    EXPECT_EQ(sample(lobe, T(0), T(0.3)), lobe.axis);
    EXPECT_TRUE(std::isfinite(pdf(lobe, lobe.axis)));
  }
  const SphericalGaussian<T> constant{Vector3<T>::UnitZ(), kTiny, T(1)};
  EXPECT_NEAR(sample(constant, T(0.25), T(0)).z(), 0.5, 4 * std::numeric_limits<T>::epsilon());
  EXPECT_NEAR(pdf(constant, constant.axis) * 4 * kPi<T>, 1, 4 * std::numeric_limits<T>::epsilon());
}

// Integral of exp(L (v . p - 1)) max(v . n, 0) for an angle `alpha` between p and n: with n as the
// pole, the azimuth integrates to a Bessel function; smooth, so Gauss-Legendre converges. Panels
// end at the lobe's flanks.
double clamped_cosine_by_quadrature(double sharpness, double alpha) {
  const double width = 9 / std::sqrt(sharpness);
  double sum = 0, from = 0;
  for (const double offset : {-1.0, -0.3, 0.0, 0.3, 1.0, 1e9}) {
    const double to = std::clamp(alpha + offset * width, from, kPi<double> / 2);
    for (const auto& [theta, weight] : test::gauss_legendre(40, from, to)) {
      const double s = std::sin((theta - alpha) / 2);
      sum += weight * std::cos(theta) * std::sin(theta) * std::exp(-2 * sharpness * s * s) *
             scaled_bessel_i0(sharpness * std::sin(theta) * std::sin(alpha));
    }
    from = to;
  }
  return 2 * kPi<double> * sum;
}

TYPED_TEST(Sg, ClampedCosineKeepsItsStatedError) {
  using T = TypeParam;
  double worst = 0;
  for (double exponent = -3; exponent <= 6; exponent += 0.25) {
    SphericalGaussian<T> lobe;
    lobe.sharpness = T(std::pow(10, exponent));
    const double peak = clamped_cosine_by_quadrature(lobe.sharpness, 0);
    double here = 0;
    for (int i = 0; i <= 30; ++i) {
      const double alpha = kPi<double> * i / 30;
      const Vector3<T> normal(T(std::sin(alpha)), 0, T(std::cos(alpha)));
      const double value = clamped_cosine_integral(lobe, normal);
      EXPECT_GE(value, 0);
      here = std::max(here,
                      std::abs(value - clamped_cosine_by_quadrature(lobe.sharpness, alpha)) / peak);
    }
    EXPECT_LT(here, 6e-5) << lobe.sharpness;
    worst = std::max(worst, here);
    for (const double alpha : {0.0, kPi<double>}) {
      const Vector3<T> normal(0, 0, T(std::cos(alpha)));
      const double truth = clamped_cosine_by_quadrature(lobe.sharpness, alpha);
      if (alpha > 0 && lobe.sharpness > 60) continue;  // below e^-60 of the peak
      // Exact there, but for rounding; exp(-L) magnifies that of L.
      const double rounding =
          (20 + (alpha > 0 ? 2 * lobe.sharpness : 0.0)) * std::numeric_limits<T>::epsilon();
      EXPECT_NEAR(clamped_cosine_integral(lobe, normal) / truth, 1, std::max(rounding, 1e-12))
          << lobe.sharpness << " " << alpha;
    }
  }
  EXPECT_GT(worst, 5e-5);  // the statement is not slack
}

TYPED_TEST(Sg, ClampedCosineIsNeverNegativeBehindTheLobe) {
  using T = TypeParam;
  // There the even part is a difference of numbers near exp(-L / 2), the integral exp(-L).
  for (T sharpness = T(0.5); sharpness < T(1e4); sharpness *= T(1.05)) {
    const SphericalGaussian<T> lobe{Vector3<T>::UnitZ(), sharpness, T(1)};
    for (int i = 0; i <= 200; ++i) {
      const T alpha = T(kPi<double> * (1 - 1e-3 * i));
      const Vector3<T> normal(std::sin(alpha), 0, std::cos(alpha));
      EXPECT_GE(clamped_cosine_integral(lobe, normal), 0) << sharpness << " " << alpha;
    }
    for (int i = 0; i <= 40; ++i) {  // where the difference is all rounding
      const T c = i * std::numeric_limits<T>::epsilon() / 2 - 1;
      const Vector3<T> normal(std::sqrt((1 - c) * (1 + c)), 0, c);
      EXPECT_GE(clamped_cosine_integral(lobe, normal), 0) << sharpness << " " << i;
    }
  }
}

TYPED_TEST(Sg, ClampedCosineOfExtremeLobes) {
  using T = TypeParam;
  const T epsilon = std::numeric_limits<T>::epsilon();
  for (const T sharpness : {T(0), std::numeric_limits<T>::denorm_min(), T(1e-8)}) {
    const SphericalGaussian<T> constant{Vector3<T>::UnitZ(), sharpness, T(1)};
    for (const T c : {T(-1), T(-0.6), T(0), T(0.6), T(1)})  // the integral of the cosine alone
      EXPECT_NEAR(clamped_cosine_integral(constant, Vector3<T>(std::sqrt(1 - c * c), 0, c)), kPi<T>,
                  1e-7 + 8 * epsilon);
  }
  SphericalGaussian<T> narrow;
  narrow.sharpness = std::numeric_limits<T>::max();
  narrow.amplitude = T(1e30);
  const Vector3<T> tilted(T(0.6), 0, T(0.8));
  EXPECT_NEAR(clamped_cosine_integral(narrow, tilted) / integral(narrow), 0.8, 1e-5);
  EXPECT_EQ(clamped_cosine_integral(narrow, Vector3<T>(-tilted)), 0);
}

}  // namespace
}  // namespace burnish
