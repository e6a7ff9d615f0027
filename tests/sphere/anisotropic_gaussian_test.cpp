#include "burnish/sphere/anisotropic_gaussian.h"

#include <random>

#include <gtest/gtest.h>

#include "support/csv.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class Asg : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Asg, Scalars);

TYPED_TEST(Asg, ExactIntegralMatchesGoldenValues) {
  using T = TypeParam;
  // The accuracy that AsgIntegral::exact promises.
  const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-12;
  for (const auto& row : test::read_golden("asg_integral.csv")) {
    const T lambda = T(row.at("lambda")), mu = T(row.at("mu"));
    EXPECT_NEAR(asg_integral_exact(lambda, mu) / row.at("integral"), 1, tolerance)
        << lambda << " " << mu;
    EXPECT_EQ(asg_integral_exact(mu, lambda), asg_integral_exact(lambda, mu));
  }
}

TYPED_TEST(Asg, ExactIntegralOfZeroBandwidths) {
  using T = TypeParam;
  EXPECT_NEAR(asg_integral_exact(T(0), T(0)), kPi<T>, 1e-6);
  // One bandwidth zero: integral of 2 sqrt(1 - x^2) exp(-lambda x^2) = pi e^(-lambda/2) (I0 +
  // I1)(lambda/2).
  EXPECT_NEAR(asg_integral_exact(T(100), T(0)), 0.353601177424, 1e-6);
}

TEST(Asg, FastAndSeriesIntegralsKeepThePapersBounds) {
  double worst_fast = 0, worst_series = 0, worst_series_above_one = 0;
  for (const auto& row : test::read_golden("asg_integral.csv")) {
    const double lambda = row.at("lambda"), mu = row.at("mu"), truth = row.at("integral");
    if (std::min(lambda, mu) <= 1) continue;
    const double series = std::abs(asg_integral_series(lambda, mu) / truth - 1);
    worst_series_above_one = std::max(worst_series_above_one, series);
    if (std::min(lambda, mu) <= 5) continue;
    worst_fast = std::max(worst_fast, std::abs(asg_integral_fast(lambda, mu) / truth - 1));
    worst_series = std::max(worst_series, series);
  }
  // xu2013asg section 4.1; the bounds are theirs, confirmed in docs/maths.md.
  EXPECT_LT(worst_fast, 0.0068);
  EXPECT_LT(worst_series, 0.00027);
  EXPECT_LT(worst_series_above_one, 0.052);
  EXPECT_GT(worst_fast, 0);
}

TYPED_TEST(Asg, ProductMatchesGoldenValues) {
  using T = TypeParam;
  // Eigenvalues of a matrix of bandwidths up to 1e3, in T's own rounding of that matrix.
  const double tolerance = std::is_same_v<T, float> ? 2e-3 : 1e-9;
  for (const auto& row : test::read_golden("asg_product.csv")) {
    const auto vector = [&](const std::string& name) {
      return Vector3<T>(T(row.at(name + "x")), T(row.at(name + "y")), T(row.at(name + "z")));
    };
    AnisotropicGaussian<T> a, b;
    a.bandwidth_x = T(row.at("lambda1"));
    a.bandwidth_y = T(row.at("mu1"));
    b.frame = {vector("x2"), vector("y2"), vector("z2")};
    b.bandwidth_x = T(row.at("lambda2"));
    b.bandwidth_y = T(row.at("mu2"));
    const AnisotropicGaussian<T> c = product(a, b);
    EXPECT_NEAR(c.bandwidth_x / row.at("lambda3"), 1, tolerance);
    EXPECT_NEAR(c.bandwidth_y / row.at("mu3"), 1, tolerance);
    EXPECT_NEAR(c.amplitude, row.at("c3"), tolerance);
    EXPECT_NEAR(std::abs(c.frame.z.dot(vector("z3"))), 1, tolerance);
    EXPECT_NEAR(c.frame.x.cross(c.frame.y).dot(c.frame.z), 1, 1e-5) << "right-handed";
  }
}

TYPED_TEST(Asg, ConvolutionMatchesEq18AndTendsToTheTruth) {
  using T = TypeParam;
  double error = 0, truth = 0;
  for (const auto& row : test::read_golden("asg_sg_convolution.csv")) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(row.at("lambda"));
    lobe.bandwidth_y = T(row.at("mu"));
    SphericalGaussian<T> kernel;
    kernel.sharpness = T(2 * row.at("nu"));
    const Vector3<T> p(T(row.at("px")), T(row.at("py")), T(row.at("pz")));
    const double value = eval(convolve(lobe, kernel), p);
    EXPECT_NEAR(value, row.at("eq18"), 1e-5 * std::abs(row.at("eq18")) + 1e-7);
    if (row.at("nu") < 50) continue;
    error += std::pow(value - row.at("true_convolution"), 2);
    truth += std::pow(row.at("true_convolution"), 2);
  }
  // Relative L2 at nu = 50 is .01 for these lobes (docs/maths.md); the samples weight the peak
  // more.
  ASSERT_GT(truth, 0);
  EXPECT_LT(std::sqrt(error / truth), 0.02);
}

TEST(Asg, IntegralAndEvalAgreeUnderRotation) {
  const unsigned seed = 3;
  std::mt19937 random(seed);
  for (const auto& [lambda, mu] : {std::pair{0.0, 0.0}, {1.0, 0.2}, {30.0, 2.0}}) {
    AnisotropicGaussian<double> lobe;
    lobe.frame = test::random_frame(test::random_direction(random), random);
    lobe.bandwidth_x = lambda;
    lobe.bandwidth_y = mu;
    lobe.amplitude = 0.7;
    const double quadrature =
        test::integrate_sphere([&](const Vector3d& v) { return eval(lobe, v); }, lobe.frame.z);
    EXPECT_NEAR(integral(lobe), quadrature, 1e-10) << "seed " << seed;
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(1.1, test::random_direction(random)).toRotationMatrix();
    const Vector3d v = test::random_direction(random);
    EXPECT_NEAR(eval(rotate(lobe, rotation), Vector3d(rotation * v)), eval(lobe, v), 1e-14);
  }
}

TEST(Asg, MatchesTheSphericalGaussianOfTwiceItsBandwidth) {
  SphericalGaussian<double> sg;
  sg.sharpness = 400;
  const AnisotropicGaussian<double> asg = asg_from_sg(sg);
  EXPECT_EQ(asg.bandwidth_x, 200);
  EXPECT_NEAR(effective_sharpness(asg), 400, 1e-12);
  EXPECT_NEAR(integral(asg) / integral(sg), 1, 1e-12);  // both 2 pi / 400
  const Vector3d v(std::sin(0.05), 0, std::cos(0.05));
  EXPECT_NEAR(eval(asg, v) / eval(sg, v), 1, 2e-3);  // they differ by the smooth term, 1 - cos(.05)
}

}  // namespace
}  // namespace burnish
