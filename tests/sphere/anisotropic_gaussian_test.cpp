#include "burnish/sphere/anisotropic_gaussian.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

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
  // Relative L2 over the sphere, and integrals that agree to exp(-sharpness / 2).
  for (const auto& [sharpness, relative_l2] :
       {std::pair{2.0, 0.274}, {20.0, 0.0180}, {200.0, 0.00177}}) {
    SphericalGaussian<double> sg;
    sg.sharpness = sharpness;
    const AnisotropicGaussian<double> asg = asg_from_sg(sg);
    EXPECT_EQ(asg.bandwidth_x, sharpness / 2);
    EXPECT_NEAR(effective_sharpness(asg), sharpness, 1e-12);
    EXPECT_NEAR(integral(asg) / integral(sg), 1, std::exp(-sharpness / 2));
    double error = 0, norm = 0;
    error = test::integrate_sphere(
        [&](const Vector3d& v) { return std::pow(eval(asg, v) - eval(sg, v), 2); });
    norm = test::integrate_sphere([&](const Vector3d& v) { return std::pow(eval(sg, v), 2); });
    EXPECT_NEAR(std::sqrt(error / norm) / relative_l2, 1, 0.01)
        << sharpness;  // three digits stated
    const SphericalGaussian<double> back = sg_from_asg(asg);
    EXPECT_NEAR(back.sharpness, sharpness, 1e-12);
    EXPECT_EQ(back.axis, sg.axis);
  }
}

TEST(Asg, AlgebraicFormRoundTrips) {
  const unsigned seed = 5;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 200; ++i) {
    AnisotropicGaussian<double> lobe;
    lobe.frame = test::random_frame(test::random_direction(random), random);
    lobe.bandwidth_y = std::pow(10, 4 * uniform(random) - 1);
    lobe.bandwidth_x = lobe.bandwidth_y * std::pow(10, 2 * uniform(random));
    // A multiple of the identity is a factor: v^T v = 1.
    const double shift = 4 * uniform(random) - 2;
    const Eigen::Matrix3d form = algebraic_form(lobe) + shift * Eigen::Matrix3d::Identity();
    const AnisotropicGaussian<double> back = asg_from_algebraic(form, lobe.frame.z, 3.0);
    // Eigenvalues are good to the rounding of the largest, up to 1e5.
    EXPECT_NEAR(back.bandwidth_x, lobe.bandwidth_x, 1e-10) << "seed " << seed;
    EXPECT_NEAR(back.bandwidth_y, lobe.bandwidth_y, 1e-10) << "seed " << seed;
    EXPECT_NEAR(back.amplitude / (3 * std::exp(-shift)), 1, 1e-10) << "seed " << seed;
    EXPECT_NEAR(back.frame.z.dot(lobe.frame.z), 1, 1e-12) << "seed " << seed;
    EXPECT_NEAR(back.frame.x.cross(back.frame.y).dot(back.frame.z), 1, 1e-12) << "right-handed";
    const Vector3d v = test::random_direction(random);
    EXPECT_NEAR(eval(back, v),
                lobe.frame.z.dot(v) <= 0 ? 0 : 3 * lobe.frame.z.dot(v) * std::exp(-v.dot(form * v)),
                1e-9 * 3 * std::exp(2.0))
        << "seed " << seed;
    const Vector3d hint = -lobe.frame.z;
    EXPECT_NEAR(asg_from_algebraic(form, hint).frame.z.dot(lobe.frame.z), -1, 1e-12);
  }
}

template <class T>
class AsgExtremes : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(AsgExtremes, Scalars);

TYPED_TEST(AsgExtremes, EvalIsTheAmplitudeAtTheAxisOfAnyLobe) {
  using T = TypeParam;
  const unsigned seed = 7;
  std::mt19937 random(seed);
  const Frame<T> frame =
      test::random_frame(test::random_direction(random), random).template cast<T>();
  const T eps = std::numeric_limits<T>::epsilon();
  for (const T bandwidth :
       {T(0), std::numeric_limits<T>::denorm_min(), T(1), T(1e8), std::numeric_limits<T>::max()}) {
    for (const T amplitude : {T(0), std::numeric_limits<T>::denorm_min(), T(1), T(1e30), T(-2)}) {
      const AnisotropicGaussian<T> lobe{frame, bandwidth, bandwidth / 3, amplitude};
      EXPECT_NEAR(eval(lobe, frame.z), amplitude, 4 * eps * std::abs(amplitude));
      for (const Vector3<T>& v : {frame.x, frame.y, Vector3<T>(-frame.z)}) {
        EXPECT_TRUE(std::isfinite(eval(lobe, v))) << bandwidth << " " << amplitude;
        EXPECT_LE(std::abs(eval(lobe, v)), std::abs(amplitude) * 2 * eps);
      }
    }
  }
}

TYPED_TEST(AsgExtremes, SupportAnglesAreWhereTheLobeFallsToTheThreshold) {
  using T = TypeParam;
  for (T bandwidth = T(1e-9); bandwidth < T(1e9); bandwidth *= T(1.9)) {
    for (const T threshold : {T(1e-6), T(1e-3), T(0.1), T(0.5), T(0.9), T(0.999)}) {
      AnisotropicGaussian<T> lobe;
      lobe.bandwidth_x = bandwidth;
      lobe.bandwidth_y = 2 * bandwidth;
      const AsgSupport<T> angles = support(lobe, threshold);
      // The logarithm's slope in the angle is tan(t) + bandwidth sin(2 t), so that an angle good to
      // some epsilons, of itself and of pi / 2 - t, leaves this of the threshold's logarithm.
      const auto check = [&](double t, double b) {
        const double value = std::log(std::cos(t)) - b * std::pow(std::sin(t), 2);
        const double slope = std::tan(t) + b * std::sin(2 * t);
        EXPECT_NEAR(value, std::log(double(threshold)),
                    16 * std::numeric_limits<T>::epsilon() * (1 + slope * t - std::log(threshold)))
            << bandwidth << " " << threshold;
      };
      check(angles.angle_x, bandwidth);
      check(angles.angle_y, 2 * bandwidth);
      EXPECT_LE(angles.angle_y, angles.angle_x);
    }
  }
}

TYPED_TEST(AsgExtremes, SupportAnglesAreMonotoneAndInsideTheHemisphere) {
  using T = TypeParam;
  const T thresholds[] = {0, std::numeric_limits<T>::denorm_min(), T(1e-8), T(1e-3), T(0.5), 1, 2};
  const T bandwidths[] = {0,      std::numeric_limits<T>::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                          T(1e8), std::numeric_limits<T>::max()};
  const T slack = 1 + 4 * std::numeric_limits<T>::epsilon();
  for (size_t i = 0; i < std::size(bandwidths); ++i) {
    for (size_t j = 0; j < std::size(thresholds); ++j) {
      const T angle = support_angle(bandwidths[i], thresholds[j]);
      EXPECT_TRUE(angle >= 0 && angle <= kPi<T> / 2) << bandwidths[i] << " " << thresholds[j];
      if (i > 0) {
        EXPECT_LE(angle, support_angle(bandwidths[i - 1], thresholds[j]) * slack);
      }
      if (j > 0) {
        EXPECT_LE(angle, support_angle(bandwidths[i], thresholds[j - 1]) * slack);
      }
    }
  }
  EXPECT_EQ(support_angle(T(3), T(1)), 0);
  EXPECT_EQ(support_angle(T(3), T(0)), kPi<T> / 2);
  EXPECT_NEAR(support_angle(T(0), T(0.5)), kPi<T> / 3, 4 * std::numeric_limits<T>::epsilon());
}

}  // namespace
}  // namespace burnish
