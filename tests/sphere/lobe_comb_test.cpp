#include "burnish/sphere/lobe_comb.h"

#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/spherical_warp.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class LobeCombs : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(LobeCombs, Scalars);

TYPED_TEST(LobeCombs, OneToothIsTheLobeItself) {
  using T = TypeParam;
  for (const T bandwidth : {T(0), T(3), T(700)}) {
    const AnisotropicGaussian<T> lobe{Frame<T>{}, T(50), bandwidth, T(0.3)};
    const LobeComb<T> comb = make_lobe_comb<T>(lobe.bandwidth_x, lobe.bandwidth_y, 1);
    const AnisotropicGaussian<T> tooth = comb_tooth(comb, lobe, 0);
    EXPECT_EQ(comb.taps.count, 1);
    EXPECT_EQ(comb.taps.tap[0].weight, 1);
    EXPECT_EQ(tooth.bandwidth_x, lobe.bandwidth_x);
    EXPECT_EQ(tooth.bandwidth_y, lobe.bandwidth_y);
    EXPECT_EQ(tooth.amplitude, lobe.amplitude);
    EXPECT_EQ(tooth.frame.x, lobe.frame.x);
    EXPECT_EQ(tooth.frame.y, lobe.frame.y);
    EXPECT_EQ(tooth.frame.z, lobe.frame.z);
  }
}

TYPED_TEST(LobeCombs, TeethKeepTheIntegralOfTheLobe) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  const std::vector<T> bandwidths = {0,      Limits::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                                     T(1e8), Limits::max()};
  for (const T bandwidth_x : bandwidths) {
    for (const T bandwidth_y : bandwidths) {
      const AnisotropicGaussian<T> lobe{Frame<T>{}, bandwidth_x, bandwidth_y, T(2)};
      for (int count = 1; count <= kMaxTaps; ++count) {
        const LobeComb<T> comb = make_lobe_comb(bandwidth_x, bandwidth_y, count);
        ASSERT_EQ(comb.taps.count, count);
        double sum = 0, weights = 0;
        for (int k = 0; k < count; ++k) {
          const AnisotropicGaussian<T> tooth = comb_tooth(comb, lobe, k);
          sum += integral(tooth);
          weights += comb.taps.tap[k].weight;
          EXPECT_GT(comb.taps.tap[k].weight, 0);
          EXPECT_TRUE(std::isfinite(tooth.bandwidth_x) && std::isfinite(tooth.bandwidth_y));
          EXPECT_TRUE(std::isfinite(tooth.amplitude) && tooth.amplitude > 0);
          EXPECT_LT(std::abs(comb.taps.tap[k].sine), 1);
          EXPECT_GE(make_lobe_shape(tooth.bandwidth_x, tooth.bandwidth_y).integral, 0);
        }
        // The integral's own error (4e-7 in float, 6e-15 in double), twice, and the rounding of the
        // sum; near the largest bandwidths an integral is a denormal number.
        const double whole = integral(lobe);
        EXPECT_NEAR(sum, whole, 20 * Limits::epsilon() * whole + 20 * Limits::denorm_min())
            << bandwidth_x << " " << bandwidth_y << " " << count;
        EXPECT_NEAR(weights, 1, 4 * Limits::epsilon());
      }
    }
  }
}

TYPED_TEST(LobeCombs, TeethStandOnTheLongAxisInFramesOfTheirOwn) {
  using T = TypeParam;
  const unsigned seed = 3;
  std::mt19937 random(seed);
  const double epsilon = std::numeric_limits<T>::epsilon();
  for (const bool along_x : {false, true}) {
    AnisotropicGaussian<T> lobe;
    lobe.frame = test::random_frame(test::random_direction(random), random).template cast<T>();
    lobe.bandwidth_x = along_x ? 9 : 200;
    lobe.bandwidth_y = along_x ? 200 : 9;
    const LobeComb<T> comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, 6);
    for (int k = 0; k < 6; ++k) {
      const AnisotropicGaussian<T> tooth = comb_tooth(comb, lobe, k);
      const Frame<T>& f = tooth.frame;
      const Vector3<T>& narrow = along_x ? f.y : f.x;
      EXPECT_EQ(narrow, along_x ? lobe.frame.y : lobe.frame.x);
      EXPECT_EQ(along_x ? tooth.bandwidth_y : tooth.bandwidth_x, 200);
      EXPECT_NEAR(f.z.dot(along_x ? lobe.frame.x : lobe.frame.y), comb.taps.tap[k].sine,
                  4 * epsilon);
      EXPECT_NEAR((f.x.cross(f.y) - f.z).norm(), 0, 8 * epsilon);
      EXPECT_NEAR(f.x.norm() + f.y.norm(), 2, 8 * epsilon);
      // The row is symmetric.
      EXPECT_NEAR(comb.taps.tap[k].sine, -comb.taps.tap[5 - k].sine, 4 * epsilon);
      EXPECT_EQ(comb.taps.tap[k].weight, comb.taps.tap[5 - k].weight);
    }
  }
}

TYPED_TEST(LobeCombs, KeepTheVarianceOfANarrowLobe) {
  using T = TypeParam;
  const T bandwidth = T(1e6);
  for (int count = 2; count <= kMaxTaps; ++count) {
    const LobeComb<T> comb = make_lobe_comb<T>(T(1e8), bandwidth, count);
    double variance = 0;
    for (int k = 0; k < count; ++k) {
      const LobeTap<T>& tap = comb.taps.tap[k];
      variance += tap.weight * (double(tap.sine) * tap.sine + 1 / (2 * double(tap.bandwidth)));
    }
    // The weights are given to six digits; curvature adds 1 / bandwidth.
    EXPECT_NEAR(variance * 2 * bandwidth, 1, 2e-5) << count;
  }
}

// Along the great circle of the long axis; across it teeth and lobe are equal.
TYPED_TEST(LobeCombs, SumFollowsTheLobe) {
  using T = TypeParam;
  // The least-squares residuals of the normal density itself, see make_lobe_comb; a lobe of
  // deviation .05 adds its curvature, of the order of its square.
  const double stated[] = {0, .111, .0504, .0446, .0328, .0262, .0220, .0193, .0176};
  const AnisotropicGaussian<T> lobe{Frame<T>{}, T(2000), T(200), T(1)};
  for (int count = 1; count <= kMaxTaps; ++count) {
    const LobeComb<T> comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, count);
    double error = 0, norm = 0;
    for (double angle = -0.4; angle < 0.4; angle += 1e-3) {
      const Vector3<T> v(0, T(std::sin(angle)), T(std::cos(angle)));
      T sum = 0;
      for (int k = 0; k < count; ++k) sum += eval(comb_tooth(comb, lobe, k), v);
      error += std::pow(sum - eval(lobe, v), 2);
      norm += std::pow(eval(lobe, v), 2);
    }
    EXPECT_NEAR(std::sqrt(error / norm), stated[count - 1], 0.0025) << count;
  }
}

/// Integral of a unit-amplitude ASG times f over the hemisphere of its axis, by Gauss-Legendre in
/// the orthographic disc, where the lobe is a plane Gaussian. f takes a direction.
template <class F>
double integrate_lobe(const AnisotropicGaussian<double>& lobe, const F& f) {
  static const auto outer = test::gauss_legendre(48, -1, 1);
  static const auto inner = test::gauss_legendre(24, -1, 1);
  const double reach_y = std::min(1.0, 5 / std::sqrt(2 * lobe.bandwidth_y));
  double sum = 0;
  for (const auto& [s, weight_y] : outer) {
    const double y = s * reach_y;
    const double reach_x = std::min(std::sqrt(1 - y * y), 5 / std::sqrt(2 * lobe.bandwidth_x));
    for (const auto& [t, weight_x] : inner) {
      const double x = t * reach_x;
      const Vector3d v = lobe.frame.to_world({x, y, std::sqrt(1 - x * x - y * y)});
      sum += weight_y * reach_y * weight_x * reach_x *
             std::exp(-lobe.bandwidth_x * x * x - lobe.bandwidth_y * y * y) * f(v);
    }
  }
  return lobe.amplitude * sum;
}

/// Relative RMS error of (warped teeth) x cosine x light over random views and lights, against the
/// integral over half vectors of D(h) cos(i) light(i) 4 o.h. Count 0: one lobe in the peak form.
constexpr int kScenes = 400;
double shading_error(double alpha_x, double alpha_y, double view, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const AnisotropicGaussian<double> half{{}, 1 / (alpha_x * alpha_x), 1 / (alpha_y * alpha_y), 1};
  const LobeComb<double> comb =
      make_lobe_comb(half.bandwidth_x, half.bandwidth_y, std::max(count, 1));
  double error = 0, norm = 0;
  for (int scene = 0; scene < kScenes; ++scene) {
    const double azimuth = 2 * kPi<double> * (scene + uniform(random)) / kScenes;
    const Vector3d o(std::sin(view) * std::cos(azimuth), std::sin(view) * std::sin(azimuth),
                     std::cos(view));
    SphericalGaussian<double> light{test::random_direction(random),
                                    2 * std::pow(10, uniform(random)), 1};
    light.axis.z() = std::abs(light.axis.z());
    const auto lit = [&](const Vector3d& i) { return std::max(i.z(), 0.0) * eval(light, i); };
    const double truth = integrate_lobe(half, [&](const Vector3d& h) {
      const double s = h.dot(o);
      return s > 0 ? 4 * s * lit(2 * s * h - o) : 0.0;
    });
    double value = 0;
    if (count == 0) value = integrate_lobe(warp_to_incoming(half, o).lobe, lit);
    for (int k = 0; k < count; ++k) {
      const AnisotropicGaussian<double> tooth = comb_tooth(comb, half, k);
      value += integrate_lobe(
          warp_mean_to_incoming(tooth, make_lobe_shape(tooth.bandwidth_x, tooth.bandwidth_y), o)
              .lobe,
          lit);
    }
    error += (value - truth) * (value - truth);
    norm += truth * truth;
  }
  return std::sqrt(error / norm);
}

// The stated errors are means over 1000 scenes (docs/maths.md, "Lobe comb"). Those of 400 hang on
// the few brightest: over ten seeds other than this one they were .65 to 1.16 of what is stated.
TEST(LobeComb, ShadedHighlightKeepsItsStatedError) {
  const struct {
    double alpha_x, alpha_y, degrees;
    double peak, mean, comb3, comb5;
  } rows[] = {
      {.0316, .316, 30, .053, .026, .0117, .0045}, {.0316, .316, 60, .153, .045, .0156, .0062},
      {.0316, .316, 80, .504, .105, .0356, .0163}, {.058, .17, 80, .310, .044, .0136, .0068},
      {.01, .1, 80, .165, .0119, .0035, .0016},    {.095, .95, 60, .468, .180, .0490, .0256}};
  const unsigned seed = 7;
  for (const auto& row : rows) {
    SCOPED_TRACE(testing::Message() << row.alpha_y << " at " << row.degrees << ", seed " << seed);
    const auto error = [&](int count) {
      return shading_error(row.alpha_x, row.alpha_y, row.degrees * kPi<double> / 180, count, seed);
    };
    EXPECT_NEAR(error(0) / row.peak, 1, .2);
    EXPECT_LE(error(1), 1.2 * row.mean);
    EXPECT_LE(error(3), 1.2 * row.comb3);
    EXPECT_LE(error(5), 1.2 * row.comb5);
  }
}

}  // namespace
}  // namespace burnish
