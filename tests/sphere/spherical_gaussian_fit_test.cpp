#include "burnish/sphere/spherical_gaussian_fit.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class MeanResultants : public testing::Test {
 public:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
};
template <class T>
class SgFit : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(MeanResultants, Scalars);
TYPED_TEST_SUITE(SgFit, Scalars);

// coth(L) - 1/L and its complement in extended precision; small L by the power series of
// L cosh(L) - sinh(L) over L sinh(L), whose terms are positive.
MeanResultant<long double> langevin(long double l) {
  if (l > 5) {
    const long double complement = 1 / l - 2 / std::expm1(2 * l);
    return {1 - complement, complement};
  }
  // sum of 2k / (2k + 1)! L^(2k + 1) over sum of L^(2k + 2) / (2k + 1)!
  long double term = l, above = 0, below = 0;  // L^(2k + 1) / (2k + 1)!
  for (int k = 0; k < 30; ++k) {
    above += 2 * k * term;
    below += l * term;
    term *= l * l / ((2 * k + 2) * (2 * k + 3));
  }
  const long double length = above / below;
  return {length, 1 - length};
}

TYPED_TEST(MeanResultants, MatchTheLangevinFunction) {
  using T = TypeParam;
  for (double exponent = -8; exponent < 30; exponent += 0.003) {
    const T sharpness = T(std::pow(10, exponent));
    const MeanResultant<long double> truth = langevin(sharpness);
    EXPECT_NEAR(double(mean_cosine(sharpness) / truth.length), 1, 3 * this->kEpsilon) << sharpness;
    EXPECT_NEAR(double(mean_cosine_complement(sharpness) / truth.complement), 1, 3 * this->kEpsilon)
        << sharpness;
  }
  EXPECT_NEAR(mean_cosine(T(1e-20)) / T(1e-20), 1 / 3., this->kEpsilon);
}

TYPED_TEST(MeanResultants, SharpnessFromMeanInvertsThem) {
  using T = TypeParam;
  for (double exponent = -8; exponent < 30; exponent += 0.003) {
    const long double sharpness = std::pow(10.0L, static_cast<long double>(exponent));
    const MeanResultant<long double> truth = langevin(sharpness);
    const MeanResultant<T> rounded{T(truth.length), T(truth.complement)};
    // The rounding of the mean itself counts up to thrice between the two limits.
    EXPECT_NEAR(double(sharpness_from_mean(rounded) / sharpness), 1, 6 * this->kEpsilon)
        << exponent;
  }
}

TYPED_TEST(MeanResultants, CheapRulesKeepTheirStatedErrors) {
  using T = TypeParam;
  double worst = 0;
  for (double exponent = -4; exponent < 6; exponent += 0.01) {
    const T sharpness = T(std::pow(10, exponent));
    const MeanResultant<T> mean = mean_resultant(sharpness);
    const double error = sharpness_approximate(mean) / sharpness - 1;
    EXPECT_GT(error, -1e-6) << sharpness;
    worst = std::max(worst, error);
    // r / (1 - r) = L - 1 for narrow lobes.
    if (sharpness > 20) {
      EXPECT_NEAR(sharpness_toksvig(mean) / sharpness, 1 - 1 / sharpness, 1e-6) << sharpness;
    }
  }
  EXPECT_NEAR(worst, 0.0494, 5e-5);
  EXPECT_NEAR(sharpness_toksvig(mean_resultant(T(1))), 1 - 0.544, 5e-4);
  EXPECT_NEAR(sharpness_toksvig(mean_resultant(T(1e-4))) / T(1e-4), 1 / 3., 1e-4);
}

TYPED_TEST(MeanResultants, LimitsAreFinite) {
  using T = TypeParam;
  constexpr T kMax = std::numeric_limits<T>::max();
  const auto parallel = resultant_from_length(T(1)), uniform = resultant_from_length(T(0));
  EXPECT_EQ(sharpness_toksvig(parallel), kMax);
  EXPECT_EQ(sharpness_approximate(parallel), kMax);
  EXPECT_EQ(sharpness_from_mean(parallel), kMax);
  EXPECT_EQ(sharpness_toksvig(uniform), 0);
  EXPECT_EQ(sharpness_approximate(uniform), 0);
  EXPECT_EQ(sharpness_from_mean(uniform), 0);
  EXPECT_EQ(mean_cosine(T(0)), 0);
  EXPECT_EQ(mean_cosine_complement(T(0)), 1);
  EXPECT_GT(mean_cosine_complement(kMax), 0);
  EXPECT_NEAR(sharpness_from_mean(mean_resultant(kMax)) / kMax, 1, 1e-6);
}

TYPED_TEST(MeanResultants, RiseAcrossTheJointOfTheirBranches) {
  using T = TypeParam;
  T sharpness = T(1.5) * (1 - 100 * T(this->kEpsilon));
  for (int i = 0; i < 200; ++i) {
    const T next = std::nextafter(sharpness, T(2));
    // Neighbours may differ by the rounding of either.
    EXPECT_GE(mean_cosine(next), mean_cosine(sharpness) * (1 - 4 * T(this->kEpsilon)));
    sharpness = next;
  }
}

TYPED_TEST(SgFit, RecoversTheLobeThatDirectionsWereDrawnFrom) {
  using T = TypeParam;
  const unsigned seed = 6;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  constexpr int kSamples = 40000;
  for (const double sharpness : {1.0, 10.0, 1e3, 1e6, 1e9}) {
    SphericalGaussian<T> lobe;
    lobe.axis = test::random_direction(random).cast<T>();
    lobe.sharpness = T(sharpness);
    std::vector<Vector3<T>> directions;
    for (int i = 0; i < kSamples; ++i)
      directions.push_back(sample(lobe, T(uniform(random)), T(uniform(random))));
    const SphericalGaussian<T> fit =
        sg_from_mean(mean_direction(std::span<const Vector3<T>>(directions)));
    // 1 - v . axis is exponentially distributed for a narrow lobe: its mean has a relative
    // deviation of 1 / sqrt(n). Five of them; wide lobes are known up to twice as badly.
    EXPECT_NEAR(fit.sharpness / sharpness, 1, 10 / std::sqrt(double(kSamples)))
        << sharpness << " seed " << seed;
    EXPECT_LT((fit.axis - lobe.axis).norm(), 10 / std::sqrt(double(kSamples) * sharpness) + 1e-7);
    EXPECT_NEAR(integral(fit) / kSamples, 1, 1e-5);
  }
}

TYPED_TEST(SgFit, AccumulationKeepsTheWidthOfNarrowLobes) {
  using T = TypeParam;
  // Pairs of directions at +-angle: the mean's length is cos(angle), whatever their number.
  for (const double angle : {1e-1, 1e-3, 1e-5, 1e-6}) {
    std::vector<Vector3<T>> directions;
    for (int i = 0; i < 500; ++i)
      for (const double sign : {-1.0, 1.0})
        directions.emplace_back(T(sign * std::sin(angle)), T(0), T(std::cos(angle)));
    const MeanDirection<T> mean = mean_direction(std::span<const Vector3<T>>(directions));
    const double truth = 2 * std::sin(angle / 2) * std::sin(angle / 2);
    // The components are rounded, to half an epsilon of the sine and of 1; so is each of a thousand
    // additions in double.
    const double summation = 1000 * std::numeric_limits<double>::epsilon();
    const double epsilon = std::numeric_limits<T>::epsilon();
    EXPECT_NEAR(mean.resultant.complement / truth, 1,
                8 * epsilon + std::pow(epsilon / angle, 2) + summation)
        << angle;
    EXPECT_EQ(mean.weight, 1000);
  }
}

TYPED_TEST(SgFit, ToksvigFromASinglePrecisionLengthIsWrongByPercents) {
  // The reason why the functions take 1 - r: at sharpness 1e6 a float r knows 1 - r to 3 %.
  const float r = float(double(langevin(1e6L).length));
  EXPECT_GT(std::abs(sharpness_toksvig(resultant_from_length(r)) / 1e6 - 1), 0.01);
  const TypeParam complement = TypeParam(langevin(1e6L).complement);
  EXPECT_NEAR(sharpness_toksvig(resultant_from_complement(complement)) / 1e6, 1, 1.1e-6);
}

TYPED_TEST(SgFit, WeightsCountAsRepetitions) {
  using T = TypeParam;
  const std::vector<Vector3<T>> two = {Vector3<T>::UnitX(), Vector3<T>::UnitY()};
  const std::vector<T> weights = {3, 1};
  const std::vector<Vector3<T>> four = {two[0], two[0], two[0], two[1]};
  const auto a = mean_direction(std::span<const Vector3<T>>(two), std::span<const T>(weights));
  const auto b = mean_direction(std::span<const Vector3<T>>(four));
  EXPECT_NEAR(a.resultant.length, std::sqrt(10.0) / 4, 1e-6);
  EXPECT_EQ(a.resultant.length, b.resultant.length);
  EXPECT_EQ(a.axis, b.axis);
  EXPECT_EQ(a.weight, b.weight);
}

TYPED_TEST(SgFit, OpposedDirectionsAndNoneGiveAConstant) {
  using T = TypeParam;
  const std::vector<Vector3<T>> opposed = {Vector3<T>::UnitX(), -Vector3<T>::UnitX()};
  const auto mean = mean_direction(std::span<const Vector3<T>>(opposed));
  EXPECT_EQ(mean.resultant.length, 0);
  EXPECT_EQ(mean.resultant.complement, 1);
  EXPECT_EQ(mean.axis.norm(), 1);
  EXPECT_EQ(sg_from_mean(mean).sharpness, 0);
  EXPECT_NEAR(integral(sg_from_mean(mean)), 2, 1e-6);
  const auto none = mean_direction(std::span<const Vector3<T>>());
  EXPECT_EQ(none.weight, 0);
  EXPECT_EQ(none.resultant.length, 0);
  EXPECT_EQ(none.resultant.complement, 1);
  EXPECT_EQ(none.axis, Vector3<T>::UnitZ());
  // As none: directions that weigh nothing.
  const std::vector<T> nothing = {0, 0};
  const auto weightless =
      mean_direction(std::span<const Vector3<T>>(opposed), std::span<const T>(nothing));
  EXPECT_EQ(weightless.weight, 0);
  EXPECT_EQ(weightless.resultant.length, 0);
  EXPECT_EQ(weightless.resultant.complement, 1);
  EXPECT_EQ(sg_from_mean(weightless).amplitude, 0);
  EXPECT_EQ(sg_from_mean(none).amplitude, 0);
}

TYPED_TEST(SgFit, OfLobesKeepsTheirCommonMean) {
  using T = TypeParam;
  // One lobe is its own fit; two alike at +-angle have the mean r cos(angle).
  for (const double sharpness : {0.3, 20.0, 1e6}) {
    const double angle = 0.5 / std::sqrt(sharpness);
    SphericalGaussian<T> a{Vector3<T>(T(std::sin(angle)), 0, T(std::cos(angle))), T(sharpness),
                           T(2)};
    SphericalGaussian<T> b = a;
    b.axis.x() = -b.axis.x();
    const std::vector<SphericalGaussian<T>> lobes = {a, b};
    const std::span<const SphericalGaussian<T>> span(lobes);
    const SphericalGaussian<T> one = sg_from_mean(mean_direction(span.first(1)));
    EXPECT_NEAR(one.sharpness / a.sharpness, 1, 1e-5);
    EXPECT_NEAR(one.amplitude, 2, 2e-5);
    const auto mean = mean_direction(span);
    const MeanResultant<long double> own = langevin(static_cast<long double>(a.sharpness));
    const double s = std::sin(angle / 2);
    // Rounded axes move by half an epsilon of the angle.
    EXPECT_NEAR(mean.resultant.complement / double(own.complement + own.length * 2 * s * s), 1,
                1e-5);
    EXPECT_NEAR(integral(sg_from_mean(mean)) / (2 * integral(a)), 1, 1e-5);
  }
}

}  // namespace
}  // namespace burnish
