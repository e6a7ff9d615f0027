#include "burnish/sphere/normalised_asg.h"

#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"
#include "support/sphere_sampling.h"
#include "support/stored.h"

namespace burnish {
namespace {

template <class T>
class Nasg : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Nasg, Scalars);

// The definition, in extended precision, for the direction of v, whose length is rounded.
long double nasg_by_definition(const NormalisedAsg<double>& lobe, const Vector3d& v) {
  const long double x = v.dot(lobe.frame.x), y = v.dot(lobe.frame.y), z = v.dot(lobe.frame.z);
  const long double k = (1 + z / std::sqrt(x * x + y * y + z * z)) / 2;
  const long double e = lobe.anisotropy * x * x / (x * x + y * y);
  return lobe.amplitude * std::pow(k, e) * std::exp(2 * lobe.sharpness * (std::pow(k, 1 + e) - 1));
}

template <class T>
NormalisedAsg<T> lobe_of(double sharpness, double anisotropy) {
  return {{}, T(sharpness), T(anisotropy), T(1)};
}

TYPED_TEST(Nasg, ValueMatchesTheDefinition) {
  using T = TypeParam;
  const unsigned seed = 3;
  std::mt19937 random(seed);
  for (int i = 0; i < 2000; ++i) {
    const double sharpness = std::pow(10, std::uniform_real_distribution<double>(-3, 2)(random));
    const double anisotropy = std::pow(10, std::uniform_real_distribution<double>(-3, 3)(random));
    const NormalisedAsg<T> lobe = lobe_of<T>(sharpness, anisotropy);
    const Vector3<T> v = test::stored<T>(test::random_direction(random));
    const NormalisedAsg<double> same = lobe_of<double>(lobe.sharpness, lobe.anisotropy);
    const double truth = double(nasg_by_definition(same, v.template cast<double>()));
    // The exponent is anisotropy times at most |log K| plus twice the sharpness, each rounded.
    const double exponent = 4 * sharpness + anisotropy * 10 + 4;
    EXPECT_NEAR(eval(lobe, v), truth,
                4 * exponent * std::numeric_limits<T>::epsilon() * truth + 1e-30)
        << "seed " << seed;
  }
}

TYPED_TEST(Nasg, ValueKeepsItsDigitsNearTheAxis) {
  using T = TypeParam;
  // At an angle t the exponent is -l (1 + a cos^2 phi) t^2 / 2 to a relative t^2 and 1 / l.
  for (const double t : {1e-7, 1e-6, 1e-5, 1e-4})
    for (const double phi : {0.0, 0.4, 1.2}) {
      const NormalisedAsg<T> lobe = lobe_of<T>(1 / (t * t), 8);
      const Vector3<T> v(T(t * std::cos(phi)), T(t * std::sin(phi)), 1);
      const double truth = std::exp(-(1 + 8 * std::cos(phi) * std::cos(phi)) / 2);
      EXPECT_NEAR(eval(lobe, v) / truth, 1, 40 * std::numeric_limits<T>::epsilon() + 100 * t * t);
    }
  EXPECT_EQ(eval(lobe_of<T>(5, 3), Vector3<T>(Vector3<T>::UnitZ())), 1);
}

TYPED_TEST(Nasg, ValueIsContinuousNearTheOppositeOfTheAxis) {
  using T = TypeParam;
  // K^e vanishes for any azimuth but pi/2, where exp(-2 l) remains.
  const Vector3<T> opposite = -Vector3<T>::UnitZ();
  EXPECT_EQ(eval(lobe_of<T>(2, 3), opposite), 0);
  EXPECT_NEAR(eval(lobe_of<T>(2, 0), opposite), std::exp(-4.0),
              8 * std::numeric_limits<T>::epsilon());
  const Vector3<T> beside(0, T(1e-6), -1);
  // K = 2.5e-13 there, and the exponent 2 l (K - 1).
  EXPECT_NEAR(eval(lobe_of<T>(2, 3), beside) / std::exp(-4.0), 1,
              8 * std::numeric_limits<T>::epsilon() + 1e-12);
}

TYPED_TEST(Nasg, IsASphericalGaussianWithoutAnisotropy) {
  using T = TypeParam;
  const unsigned seed = 4;
  std::mt19937 random(seed);
  for (const double sharpness : {0.0, 0.1, 3.0, 40.0}) {
    const SphericalGaussian<T> sg{Vector3<T>::UnitZ(), T(sharpness), T(1)};
    for (int i = 0; i < 50; ++i) {
      const Vector3<T> v = test::random_direction(random).cast<T>();
      EXPECT_NEAR(eval(lobe_of<T>(sharpness, 0), v), eval(sg, v),
                  8 * (1 + 2 * sharpness) * std::numeric_limits<T>::epsilon() * eval(sg, v))
          << "seed " << seed;
    }
    EXPECT_EQ(integral(lobe_of<T>(sharpness, 0)), integral(sg));
  }
}

TEST(Nasg, IntegralMatchesQuadrature) {
  for (const auto& [sharpness, anisotropy] :
       {std::pair{1e-3, 0.0}, {1e-3, 5.0}, {1.0, 1.0}, {4.0, 20.0}, {30.0, 3.0}, {300.0, 50.0}}) {
    const NormalisedAsg<double> lobe = lobe_of<double>(sharpness, anisotropy);
    const double finest = 0.3 / std::sqrt(sharpness * (1 + anisotropy) + 1);
    const test::SphereCells cells(lobe.frame, finest, std::sqrt(1 + anisotropy));
    double sum = 0;
    for (const double part : cells.integrate([&](const Vector3d& v) { return eval(lobe, v); }))
      sum += part;
    // K^e has a cusp at the opposite of the axis, which slows the quadrature down.
    EXPECT_NEAR(sum / integral(lobe), 1, 1e-6) << sharpness << " " << anisotropy;
  }
}

TYPED_TEST(Nasg, SamplesHaveTheDensity) {
  using T = TypeParam;
  const unsigned seed = 21;
  constexpr int kSamples = 100000;
  const std::vector<std::pair<double, double>> shapes = {{0, 0},   {1e-8, 4}, {1, 1},    {5, 100},
                                                         {100, 0}, {1e4, 8},  {1e6, 1e3}};
  std::mt19937 random(seed);
  for (const auto& [sharpness, anisotropy] : shapes) {
    NormalisedAsg<double> lobe = lobe_of<double>(sharpness, anisotropy);
    lobe.frame = test::random_frame(test::random_direction(random), random);
    const NormalisedAsg<T> lobe_t = {lobe.frame.cast<T>(), T(sharpness), T(anisotropy), T(1)};
    const double finest = 0.3 / std::sqrt(sharpness * (1 + anisotropy) + 1);
    const test::SphereCells cells(lobe.frame, finest, std::sqrt(1 + anisotropy));
    const test::ChiSquare chi = test::chi_square_on_sphere(
        cells,
        [&](double u, double v) -> Vector3d {
          const Vector3<T> d = sample(lobe_t, T(u), T(v));
          EXPECT_NEAR(d.norm(), 1, 8 * std::numeric_limits<T>::epsilon());
          return d.template cast<double>();
        },
        [&](const Vector3d& d) { return pdf(lobe, d); }, kSamples, seed);
    EXPECT_GT(chi.p_value, test::sidak_level(0.01, int(shapes.size())))
        << chi.report("nasg") << " sharpness " << sharpness << " anisotropy " << anisotropy
        << " seed " << seed;
  }
}

TYPED_TEST(Nasg, DensityIsTheLobeOverItsIntegral) {
  using T = TypeParam;
  const NormalisedAsg<T> lobe{{}, T(3), T(7), T(1)};
  const Vector3<T> v = Vector3<T>(T(0.3), T(0.5), T(0.7)).normalized();
  EXPECT_NEAR(pdf(lobe, v), eval(lobe, v) / integral(lobe),
              8 * std::numeric_limits<T>::epsilon() * pdf(lobe, v));
}

TYPED_TEST(Nasg, ConvertsToTheAsgItIsNearItsAxisAndBack) {
  using T = TypeParam;
  const NormalisedAsg<T> lobe{{}, T(1e4), T(8), T(2)};
  const AnisotropicGaussian<T> asg = asg_from_nasg(lobe);
  for (const double phi : {0.0, 0.5, 1.5}) {
    const Vector3<T> v =
        Vector3<T>(T(0.01 * std::cos(phi)), T(0.01 * std::sin(phi)), 1).normalized();
    // They differ by the order of e K, i.e. (1 + 8) 0.01^2 / 4 and of its square times 2 l.
    EXPECT_NEAR(eval(lobe, v) / eval(asg, v), 1, 3e-3);
  }
  const NormalisedAsg<T> back = nasg_from_asg(asg);
  EXPECT_NEAR(back.sharpness, lobe.sharpness, 1e-2);
  EXPECT_NEAR(back.anisotropy, lobe.anisotropy, 1e-5);
  const NormalisedAsg<T> turned =
      nasg_from_asg(AnisotropicGaussian<T>{{}, asg.bandwidth_y, asg.bandwidth_x, T(2)});
  EXPECT_NEAR(turned.anisotropy, lobe.anisotropy, 1e-5);
  EXPECT_EQ(turned.frame.x, Vector3<T>(Vector3<T>::UnitY()));
  EXPECT_NEAR((turned.frame.x.cross(turned.frame.y) - turned.frame.z).norm(), 0, 1e-6);
}

}  // namespace
}  // namespace burnish
