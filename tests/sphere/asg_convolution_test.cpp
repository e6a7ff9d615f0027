#include "burnish/sphere/asg_convolution.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/csv.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

using Lobe = AnisotropicGaussian<double>;

template <class T>
class AsgConvolution : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(AsgConvolution, Scalars);

std::vector<test::Node> nodes_about(const Lobe& lobe, int steps) {
  return test::nodes_about(lobe.frame, lobe.bandwidth_x, lobe.bandwidth_y, steps, steps);
}

/// Relative L2 error of `result` as the convolution of a lobe, kernel_at(p, v) being the kernel's
/// value at v when it is about p.
template <class Kernel>
double relative_l2(const Lobe& result, const Lobe& lobe, const Kernel& kernel_at) {
  std::vector<test::Node> inner = nodes_about(lobe, 64);
  std::vector<double> values;
  for (const test::Node& node : inner) values.push_back(node.weight * eval(lobe, node.direction));
  double error = 0, norm = 0;
  for (const test::Node& outer : nodes_about(result, 20)) {
    double truth = 0;
    for (size_t i = 0; i < inner.size(); ++i) {
      if (values[i] > 1e-12) truth += values[i] * kernel_at(outer.direction, inner[i].direction);
    }
    error += outer.weight * std::pow(eval(result, outer.direction) - truth, 2);
    norm += outer.weight * truth * truth;
  }
  return std::sqrt(error / norm);
}

TYPED_TEST(AsgConvolution, MatchesEq18AndTendsToTheTruth) {
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
    // Eq. 18 takes the plane's integral where we take the disc's, at most exp(-bandwidth) less.
    const double edge = std::exp(-(std::min(row.at("lambda"), row.at("mu")) + row.at("nu")));
    EXPECT_NEAR(value, row.at("eq18"), (edge + 1e-5) * std::abs(row.at("eq18")) + 1e-7);
    if (row.at("nu") < 50) continue;
    error += std::pow(value - row.at("true_convolution"), 2);
    truth += std::pow(row.at("true_convolution"), 2);
  }
  // Relative L2 at nu = 50 is .01 for these lobes; the samples weight the peak more.
  ASSERT_GT(truth, 0);
  EXPECT_LT(std::sqrt(error / truth), 0.02);
}

TEST(AsgConvolutionForms, WithAnSgKeepsItsStatedErrors) {
  struct Case {
    double bandwidth_x, bandwidth_y, nu, relative_l2;
  };
  // xu2013asg, Fig. 6, is ((5, 5), 1), ((40, 1), 10) and ((100, 10), 100), and states 0.2 % to 2.8
  // % for any kernel: only the last is below. The kernel rules the error.
  for (const Case& c : {Case{5, 5, 1, 0.35},
                        {5, 5, 5, 0.071},
                        {5, 5, 10, 0.041},
                        {5, 5, 50, 0.0104},
                        {40, 1, 1, 0.35},
                        {40, 1, 10, 0.038},
                        {40, 1, 50, 0.0088},
                        {100, 10, 10, 0.029},
                        {100, 10, 100, 0.0046}}) {
    Lobe lobe;
    lobe.bandwidth_x = c.bandwidth_x;
    lobe.bandwidth_y = c.bandwidth_y;
    SphericalGaussian<double> kernel;
    kernel.sharpness = 2 * c.nu;
    const double found =
        relative_l2(convolve(lobe, kernel), lobe, [&](const Vector3d& p, const Vector3d& v) {
          return std::exp(-c.nu * (p - v).squaredNorm());
        });
    // Two digits were stated; the kinks of long lobes at the horizon leave some percent.
    EXPECT_NEAR(found / c.relative_l2, 1, 0.1)
        << c.bandwidth_x << " " << c.bandwidth_y << " " << c.nu;
  }
}

TEST(AsgConvolutionForms, WithAnAsgKeepsItsStatedErrors) {
  constexpr unsigned kSeed = 41;
  std::mt19937 random(kSeed);
  struct Case {
    double bandwidth_x, bandwidth_y, kernel_x, kernel_y, turn, relative_l2;
  };
  // The figures of the declaration's comment.
  for (const Case& c : {Case{5, 5, 5, 5, 0, 0.064},
                        {5, 5, 50, 50, 0, 0.0105},
                        {40, 4, 50, 5, 0, 0.040},
                        {40, 4, 50, 5, 0.7, 0.028},
                        {40, 4, 50, 5, 1.57, 0.013},
                        {100, 10, 400, 40, 0.7, 0.0065},
                        {1000, 100, 400, 40, 0.7, 0.0022}}) {
    Lobe lobe, kernel;
    lobe.frame = test::random_frame(test::random_direction(random), random);
    lobe.bandwidth_x = c.bandwidth_x;
    lobe.bandwidth_y = c.bandwidth_y;
    kernel.bandwidth_x = c.kernel_x;
    kernel.bandwidth_y = c.kernel_y;
    const Vector3d z = lobe.frame.z;
    const Vector3d x = std::cos(c.turn) * lobe.frame.x + std::sin(c.turn) * lobe.frame.y;
    kernel.frame = {x, z.cross(x), z};
    const double found =
        relative_l2(convolve(lobe, kernel), lobe, [&](const Vector3d& p, const Vector3d& v) {
          // Into the kernel's own frame by the inverse of the smallest rotation from z to p.
          return eval(kernel, Vector3d(minimal_rotation(p, z) * v));
        });
    // Two digits were stated; the kinks at the horizons leave less.
    EXPECT_NEAR(found / c.relative_l2, 1, 0.05)
        << c.kernel_x << " " << c.kernel_y << " " << c.turn << " seed " << kSeed;
  }
}

TYPED_TEST(AsgConvolution, OfAnAsgByARoundKernelIsThatByTheSg) {
  using T = TypeParam;
  constexpr unsigned kSeed = 43;
  std::mt19937 random(kSeed);
  for (const T nu : {T(1e-3), T(1), T(300)}) {
    AnisotropicGaussian<T> lobe, kernel;
    lobe.frame = test::random_frame(test::random_direction(random), random).template cast<T>();
    lobe.bandwidth_x = 40;
    lobe.bandwidth_y = 3;
    kernel.frame = test::random_frame(test::random_direction(random), random).template cast<T>();
    kernel.bandwidth_x = kernel.bandwidth_y = nu;
    SphericalGaussian<T> sg;
    sg.sharpness = 2 * nu;
    const AnisotropicGaussian<T> by_asg = convolve(lobe, kernel), by_sg = convolve(lobe, sg);
    const double tolerance = 32 * std::numeric_limits<T>::epsilon();
    EXPECT_NEAR(by_asg.bandwidth_x / by_sg.bandwidth_x, 1, tolerance) << "seed " << kSeed;
    EXPECT_NEAR(by_asg.bandwidth_y / by_sg.bandwidth_y, 1, tolerance);
    EXPECT_NEAR(by_asg.amplitude / by_sg.amplitude, 1, tolerance);
    EXPECT_NEAR(std::abs(by_asg.frame.x.dot(by_sg.frame.x)), 1, tolerance);
  }
}

TYPED_TEST(AsgConvolution, DoesNotDependOnWhereTheKernelIs) {
  using T = TypeParam;
  // Turned by the smallest rotation to another axis, from where it comes back by the smallest.
  constexpr unsigned kSeed = 47;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 100; ++i) {
    Lobe lobe, kernel;
    lobe.frame = test::random_frame(test::random_direction(random), random);
    lobe.bandwidth_x = 40;
    lobe.bandwidth_y = 4;
    kernel.frame = test::random_frame(lobe.frame.z, random);
    kernel.bandwidth_x = 50;
    kernel.bandwidth_y = 5;
    const Vector3d axis = test::random_direction(random);
    const Lobe elsewhere = rotate(kernel, minimal_rotation(kernel.frame.z, axis));
    const auto stored = [](const Lobe& l) {
      return AnisotropicGaussian<T>{l.frame.cast<T>(), T(l.bandwidth_x), T(l.bandwidth_y), T(1)};
    };
    const AnisotropicGaussian<T> here = convolve(stored(lobe), stored(kernel));
    const AnisotropicGaussian<T> there = convolve(stored(lobe), stored(elsewhere));
    // Frames are rounded to T. The smallest rotation from an axis to nearly the opposite one turns
    // by the rounding over the angle that is left; and an ellipse's axis by its own rounding over
    // the difference of its bandwidths (4 to 22 here), which moves it little.
    const double left = (axis + lobe.frame.z).norm();
    const double tolerance = 64 * std::numeric_limits<T>::epsilon() / std::min(left, 1.0);
    EXPECT_NEAR(there.bandwidth_x / here.bandwidth_x, 1, tolerance) << "seed " << kSeed;
    EXPECT_NEAR(there.bandwidth_y / here.bandwidth_y, 1, tolerance) << "seed " << kSeed;
    EXPECT_NEAR(there.amplitude / here.amplitude, 1, tolerance) << "seed " << kSeed;
    EXPECT_NEAR(
        std::abs(there.frame.x.dot(here.frame.y)) * (1 - here.bandwidth_y / here.bandwidth_x), 0,
        tolerance)
        << "seed " << kSeed;
  }
}

TYPED_TEST(AsgConvolution, OnlyTheDirectionOfTheKernelsFrameCounts) {
  using T = TypeParam;
  // An axis that has drifted from unit length does not change the kernel's widths.
  AnisotropicGaussian<T> lobe, kernel;
  lobe.bandwidth_x = 40;
  lobe.bandwidth_y = 4;
  kernel.bandwidth_x = 50;
  kernel.bandwidth_y = 5;
  const AnisotropicGaussian<T> exact = convolve(lobe, kernel);
  kernel.frame.x *= T(1.01);
  const AnisotropicGaussian<T> stretched = convolve(lobe, kernel);
  EXPECT_NEAR(stretched.bandwidth_x / exact.bandwidth_x, 1, 8 * std::numeric_limits<T>::epsilon());
  EXPECT_NEAR(stretched.amplitude / exact.amplitude, 1, 8 * std::numeric_limits<T>::epsilon());
}

TYPED_TEST(AsgConvolution, AmplitudesSaturateAtTheLargestNumber) {
  using T = TypeParam;
  constexpr T kLargest = std::numeric_limits<T>::max();
  AnisotropicGaussian<T> lobe, kernel;
  SphericalGaussian<T> sg;
  lobe.amplitude = kernel.amplitude = sg.amplitude = std::sqrt(kLargest) * 4;
  EXPECT_EQ(convolve(lobe, kernel).amplitude, kLargest);
  EXPECT_EQ(convolve(lobe, sg).amplitude, kLargest);
  lobe.amplitude = -lobe.amplitude;
  EXPECT_EQ(convolve(lobe, kernel).amplitude, -kLargest);
  EXPECT_EQ(convolve(lobe, sg).amplitude, -kLargest);
  // Neither does a product that is within the range go through one that is not.
  lobe.amplitude = std::numeric_limits<T>::min();
  kernel.amplitude = sg.amplitude = kLargest;
  lobe.bandwidth_x = lobe.bandwidth_y = kLargest;
  const double expected = double(lobe.amplitude) * double(kLargest) * (kPi<double> / kLargest);
  // pi / kLargest is denormal: 22 or 51 bits.
  EXPECT_NEAR(convolve(lobe, kernel).amplitude / expected, 1, 1e-5);
  EXPECT_NEAR(convolve(lobe, sg).amplitude / expected, 1, 1e-5);
}

TYPED_TEST(AsgConvolution, KeepsTheMassOfNarrowLobes) {
  using T = TypeParam;
  // To first order in 1 / bandwidth: the planes' integrals multiply.
  for (const T width : {T(30), T(1000), T(1e6)}) {
    AnisotropicGaussian<T> lobe, kernel;
    lobe.bandwidth_x = 4 * width;
    lobe.bandwidth_y = width;
    kernel.bandwidth_x = width;
    kernel.bandwidth_y = 9 * width;
    const T mass = integral(lobe) * integral(kernel);
    EXPECT_NEAR(integral(convolve(lobe, kernel)) / mass, 1, 2e-6);  // float's rounding
    SphericalGaussian<T> sg;
    sg.sharpness = 2 * width;
    const T sg_mass = integral(lobe) * 4 * kPi<T> * one_minus_exp_over(2 * sg.sharpness);
    EXPECT_NEAR(integral(convolve(lobe, sg)) / sg_mass, 1, 2e-6);
  }
}

TYPED_TEST(AsgConvolution, IsFiniteForAnyBandwidths) {
  using T = TypeParam;
  const T extremes[] = {0,      std::numeric_limits<T>::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                        T(1e8), std::numeric_limits<T>::max()};
  // Rounding, and what a ratio of bandwidths of 1e-311 keeps as a denormal number.
  constexpr T kTight = 1 + 32 * std::numeric_limits<T>::epsilon() + T(1e-11);
  for (const T ax : extremes) {
    for (const T ay : extremes) {
      for (const T bx : extremes) {
        AnisotropicGaussian<T> lobe;
        lobe.bandwidth_x = ax;
        lobe.bandwidth_y = ay;
        SphericalGaussian<T> sg;
        sg.sharpness = bx;
        // A convolution is wider than either lobe, and its peak at most the disc's area.
        const AnisotropicGaussian<T> by_sg = convolve(lobe, sg);
        EXPECT_TRUE(by_sg.bandwidth_x <= std::min(ax, bx) && by_sg.bandwidth_x >= 0 &&
                    by_sg.bandwidth_y <= std::min(ay, bx) && by_sg.bandwidth_y >= 0)
            << ax << " " << ay << " " << bx;
        EXPECT_TRUE(by_sg.amplitude > 0 && by_sg.amplitude <= kPi<T> * kTight)
            << ax << " " << ay << " " << bx;
        for (const T by : extremes) {
          AnisotropicGaussian<T> kernel;
          kernel.bandwidth_x = bx;
          kernel.bandwidth_y = by;
          const AnisotropicGaussian<T> c = convolve(lobe, kernel);
          EXPECT_TRUE(c.bandwidth_y >= 0 && c.bandwidth_x >= c.bandwidth_y &&
                      c.bandwidth_x <= kTight * std::max(std::min(ax, bx), std::min(ay, by)) &&
                      c.amplitude > 0 && c.amplitude <= kPi<T> * kTight)
              << ax << " " << ay << " " << bx << " " << by << ": " << c.bandwidth_x << " "
              << c.bandwidth_y << " " << c.amplitude;
        }
      }
    }
  }
}

TYPED_TEST(AsgConvolution, WithAConstantKernelHasTheConstantsValue) {
  using T = TypeParam;
  AnisotropicGaussian<T> lobe;
  lobe.bandwidth_x = 7;
  lobe.amplitude = 3;
  SphericalGaussian<T> kernel;
  kernel.sharpness = 0;
  const AnisotropicGaussian<T> c = convolve(lobe, kernel);
  EXPECT_EQ(c.bandwidth_x, 0);
  EXPECT_EQ(c.bandwidth_y, 0);
  EXPECT_NEAR(c.amplitude / integral(lobe), 1, 4 * std::numeric_limits<T>::epsilon());
}

}  // namespace
}  // namespace burnish
