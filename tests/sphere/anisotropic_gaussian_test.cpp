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
