#include "burnish/sphere/lobe_moments.h"

#include <array>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class LobeMomentsTest : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(LobeMomentsTest, Scalars);

template <class T>
std::vector<T> as_list(const LobeMoments<T>& m) {
  return {m.mean_z,    m.mean_xx,   m.mean_yy,   m.variance_z, m.mean_xxz,  m.mean_yyz, m.mean_zzz,
          m.mean_xxxx, m.mean_yyyy, m.mean_zzzz, m.mean_xxyy,  m.mean_xxzz, m.mean_yyzz};
}

/// Moments by a rule of the orthographic disc that is independent of the subject's: y = sin(a) and
/// x along the chord, Gauss-Legendre on panels that halve toward the center of the chord and of
/// the disc, so that a needle's width is resolved; 1 - z without cancellation.
LobeMoments<double> moments_by_quadrature(double bandwidth_x, double bandwidth_y) {
  static const auto rule = test::gauss_legendre(20, 0, 1);
  const auto halving = [](double end, double width) {
    std::vector<std::pair<double, double>> panels;  // [0, end], fine near both ends
    for (double to = end / 2;; to /= 2) {
      panels.push_back({to / 2, to});
      if (to < width) {
        panels.push_back({0, to / 2});
        break;
      }
    }
    double gap = end / 2;
    for (int i = 0; i < 24; ++i, gap /= 2) panels.push_back({end - gap, end - gap / 2});
    panels.push_back({end - gap, end});
    return panels;
  };
  double one = 0, mean_w = 0;
  std::vector<std::array<double, 4>> nodes;  // x^2, y^2, w = 1 - z, weight
  const double reach_y = 1 / std::sqrt(bandwidth_y + 1), reach_x = 1 / std::sqrt(bandwidth_x + 1);
  for (const auto& [y_from, y_to] : halving(kPi<double> / 2, reach_y)) {
    for (const auto& [u, u_weight] : rule) {
      const double a = y_from + (y_to - y_from) * u;
      const double y = std::sin(a), chord = std::cos(a);
      const double outer = u_weight * (y_to - y_from) * chord * std::exp(-bandwidth_y * y * y);
      if (outer < 1e-25 * (y_to - y_from)) continue;
      for (const auto& [x_from, x_to] : halving(kPi<double> / 2, reach_x)) {
        for (const auto& [v, v_weight] : rule) {
          const double b = x_from + (x_to - x_from) * v;
          const double x = chord * std::sin(b), z = chord * std::cos(b);
          const double weight =
              outer * v_weight * (x_to - x_from) * z * std::exp(-bandwidth_x * x * x);
          const double w = (x * x + y * y) / (1 + z);
          nodes.push_back({x * x, y * y, w, weight});
          one += weight;
          mean_w += weight * w;
        }
      }
    }
  }
  mean_w /= one;
  LobeMoments<double> m;
  m.mean_z = 1 - mean_w;
  for (const auto& [xx, yy, w, weight] : nodes) {
    const double f = weight / one, d = mean_w - w;
    m.mean_xx += f * xx;
    m.mean_yy += f * yy;
    m.variance_z += f * d * d;
    m.mean_xxz += f * xx * d;
    m.mean_yyz += f * yy * d;
    m.mean_zzz += f * d * d * d;
    m.mean_xxxx += f * xx * xx;
    m.mean_yyyy += f * yy * yy;
    m.mean_zzzz += f * d * d * d * d;
    m.mean_xxyy += f * xx * yy;
    m.mean_xxzz += f * xx * d * d;
    m.mean_yyzz += f * yy * d * d;
  }
  return m;
}

TYPED_TEST(LobeMomentsTest, OfAnAsgMatchQuadratureInAllTheirDigits) {
  using T = TypeParam;
  // Sums of 540 terms, and differences of numbers up to 20 times the moment; in float, the result's
  // rounding.
  const double tolerance = std::is_same_v<T, float> ? 2e-7 : 1e-11;
  for (const auto& [bx, by] : {std::pair{0.0, 0.0},
                               {1e-4, 2.0},
                               {1.0, 1.0},
                               {10.0, 1.0},
                               {60.0, 60.0},
                               {0.5, 90.0},
                               {1e4, 0.1},
                               {3e5, 3e5},
                               {1e6, 100.0}}) {
    const std::vector<double> truth = as_list(moments_by_quadrature(T(bx), T(by)));
    const std::vector<T> found = as_list(asg_moments(T(bx), T(by)));
    for (size_t i = 0; i < truth.size(); ++i) {
      // E[x^2 d] vanishes against its bound where x and z hardly depend on each other, by
      // cancellation of what is rounded.
      const double bound = i == 4   ? std::sqrt(truth[7] * truth[3])
                           : i == 5 ? std::sqrt(truth[8] * truth[3])
                                    : std::abs(truth[i]);
      EXPECT_NEAR(found[i], truth[i], tolerance * bound) << bx << " " << by << " moment " << i;
    }
  }
}

TYPED_TEST(LobeMomentsTest, AreFiniteAndOrderedForAnyBandwidths) {
  using T = TypeParam;
  const T extremes[] = {0,      std::numeric_limits<T>::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                        T(1e8), std::numeric_limits<T>::max()};
  for (const T bx : extremes) {
    for (const T by : extremes) {
      const LobeMoments<T> m = asg_moments(bx, by);
      for (const T value : as_list(m)) EXPECT_TRUE(std::isfinite(value)) << bx << " " << by;
      EXPECT_TRUE(m.mean_z >= T(0.666) && m.mean_z <= 1) << bx << " " << by;
      for (const T even : {m.mean_xx, m.mean_yy, m.variance_z, m.mean_xxxx, m.mean_yyyy,
                           m.mean_zzzz, m.mean_xxyy, m.mean_xxzz, m.mean_yyzz})
        EXPECT_GE(even, 0) << bx << " " << by;
      if (bx > by) {
        EXPECT_LE(m.mean_xx, m.mean_yy * (1 + 8 * std::numeric_limits<T>::epsilon()))
            << bx << " " << by;
      }
      for (const Vector3<T>& n : {Vector3<T>(1, 0, 0), Vector3<T>(0, 1, 0), Vector3<T>(0, 0, 1),
                                  Vector3<T>(0, 0, -1), Vector3<T>(T(0.6), 0, T(-0.8))}) {
        const T cosine = mean_clamped_cosine(m, n);
        EXPECT_TRUE(cosine >= 0 && cosine <= 1) << bx << " " << by << ": " << cosine;
      }
    }
  }
}

TEST(LobeMoments, OfACapMatchQuadrature) {
  for (const double height : {1e-9, 1e-3, 0.05, 0.7, 1.5, 2.0}) {
    std::vector<double> truth(13, 0.0);
    for (const auto& [w, weight] : test::gauss_legendre(20, 0, height)) {
      // The azimuth's means: cos^2 1/2, cos^4 3/8, cos^2 sin^2 1/8.
      const double f = weight / height, d = height / 2 - w, rr = w * (2 - w);
      const double terms[13] = {1 - w,           rr / 2,        rr / 2,      d * d,
                                rr / 2 * d,      rr / 2 * d,    d * d * d,   3 * rr * rr / 8,
                                3 * rr * rr / 8, d * d * d * d, rr * rr / 8, rr / 2 * d * d,
                                rr / 2 * d * d};
      for (size_t i = 0; i < truth.size(); ++i) truth[i] += f * terms[i];
    }
    const std::vector<double> found = as_list(cap_moments(height));
    for (size_t i = 0; i < truth.size(); ++i) {
      // The third moment of z is 0, and so may be others; all are sums of a few terms.
      EXPECT_NEAR(found[i], truth[i], 1e-12 * std::abs(truth[i]) + 1e-16 * height * height * height)
          << height << " moment " << i;
    }
  }
}

/// Relative L2 error over normals of mean_clamped_cosine for an ASG. The quadrature's pole is the
/// normal, so that the clamp's edge is a node boundary; the lobe's own horizon is a kink in its
/// derivative only, which leaves 1e-4.
double clamped_cosine_error(double bandwidth_x, double bandwidth_y) {
  AnisotropicGaussian<double> lobe;
  lobe.bandwidth_x = bandwidth_x;
  lobe.bandwidth_y = bandwidth_y;
  const LobeMoments<double> moments = asg_moments(bandwidth_x, bandwidth_y);
  const double whole = integral(lobe);
  double error = 0, norm = 0;
  for (int t = 0; t <= 12; ++t) {
    for (int p = 0; p < 4; ++p) {
      const double theta = kPi<double> * t / 12, phi = kPi<double> / 6 * p;
      const Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
      const double truth = test::integrate_sphere(
          [&](const Vector3d& v) { return eval(lobe, v) * std::max(n.dot(v), 0.0); }, n, 80);
      const double estimate = whole * mean_clamped_cosine(moments, n);
      error += std::sin(theta) * (estimate - truth) * (estimate - truth);
      norm += std::sin(theta) * truth * truth;
    }
  }
  return std::sqrt(error / norm);
}

TEST(LobeMoments, ClampedCosineKeepsItsStatedError) {
  // Bandwidths that the fit has not seen among them. The stated .002, and the quadrature's 1e-4.
  for (const auto& [bx, by] : {std::pair{0.0, 0.0},
                               {1.0, 1.0},
                               {4.0, 1.0},
                               {10.0, 1.0},
                               {16.0, 4.0},
                               {100.0, 1.0},
                               {64.0, 64.0},
                               {2.2, 0.05},
                               {45.0, 0.6},
                               {6.0, 5.0}}) {
    const double error = clamped_cosine_error(bx, by);
    EXPECT_LT(error, 0.0021) << bx << " " << by;
  }
}

TEST(LobeMoments, ClampedCosineOfCapsKeepsItsStatedError) {
  // The truth by Gauss-Legendre in z, the azimuth in closed form.
  for (const double height : {0.02, 0.3, 0.8, 1.0, 1.4, 2.0}) {
    const LobeMoments<double> moments = cap_moments(height);
    double error = 0, norm = 0;
    for (const auto& [cos_normal, weight] : test::gauss_legendre(24, -1, 1)) {
      const double sin_normal = std::sqrt(1 - cos_normal * cos_normal);
      double truth = 0;
      for (const auto& [z, z_weight] : test::gauss_legendre(400, 1 - height, 1)) {
        // mean over phi of max(a + b cos(phi), 0)
        const double a = cos_normal * z, b = sin_normal * std::sqrt(1 - z * z);
        const double edge = a >= b ? kPi<double> : a <= -b ? 0.0 : std::acos(-a / b);
        truth += z_weight / height * (a * edge + b * std::sin(edge)) / kPi<double>;
      }
      const double found = mean_clamped_cosine(moments, Vector3d(sin_normal, 0, cos_normal));
      error += weight * std::pow(found - truth, 2);
      norm += weight * truth * truth;
    }
    EXPECT_LT(std::sqrt(error / norm), 0.0021) << height;
  }
}

TYPED_TEST(LobeMomentsTest, ClampedCosineIntegralOfATurnedLobeMatchesQuadrature) {
  using T = TypeParam;
  constexpr unsigned kSeed = 53;
  std::mt19937 random(kSeed);
  for (const auto& [bx, by] : {std::pair{0.0, 0.0}, {1.0, 4.0}, {100.0, 1.0}, {20.0, 30.0}}) {
    AnisotropicGaussian<double> lobe{test::random_frame(test::random_direction(random), random), bx,
                                     by, 3.0};
    const AnisotropicGaussian<T> stored{lobe.frame.cast<T>(), T(bx), T(by), T(3)};
    double error = 0, norm = 0;
    for (int i = 0; i < 30; ++i) {
      const Vector3d n = test::random_direction(random);
      const double truth = test::integrate_sphere(
          [&](const Vector3d& v) { return eval(lobe, v) * std::max(n.dot(v), 0.0); }, n, 60);
      error += std::pow(clamped_cosine_integral(stored, Vector3<T>(n.cast<T>())) - truth, 2);
      norm += truth * truth;
    }
    // The stated .002 is over all normals; thirty of them know it to a sixth.
    EXPECT_LT(std::sqrt(error / norm), 0.0025) << bx << " " << by << " seed " << kSeed;
  }
}

TYPED_TEST(LobeMomentsTest, MeanCosineStaysWithinWhatItsFirstTwoMomentsAllow) {
  using T = TypeParam;
  // max(E, 0) <= E[max(s, 0)] <= (E + sqrt(E[s^2])) / 2; the upper bound holds with equality for
  // two values +-a, whose excess kurtosis, the smallest there is, takes the fit far beyond it.
  LobeMoments<T> two;  // v = +-x, equally often
  two.mean_z = 0;
  two.mean_xx = two.mean_xxxx = 1;
  EXPECT_LE(mean_clamped_cosine(two, Vector3<T>(1, 0, 0)), T(0.5));
  // And a single value far out: the largest kurtosis.
  LobeMoments<T> rare;
  rare.mean_z = 0;
  rare.mean_xx = T(0.01);
  rare.mean_xxxx = T(0.01);
  const T cosine = mean_clamped_cosine(rare, Vector3<T>(1, 0, 0));
  EXPECT_GE(cosine, 0);
  EXPECT_LE(cosine, T(0.05) * (1 + 4 * std::numeric_limits<T>::epsilon()));
}

TYPED_TEST(LobeMomentsTest, ClampedCosineOfOppositeNormalsDiffersByTheMean) {
  using T = TypeParam;
  // max(s, 0) - max(-s, 0) = s, exactly.
  constexpr unsigned kSeed = 51;
  std::mt19937 random(kSeed);
  for (const auto& [bx, by] : {std::pair{0.0, 0.0}, {30.0, 1.0}, {1000.0, 200.0}}) {
    const LobeMoments<T> m = asg_moments(T(bx), T(by));
    for (int i = 0; i < 100; ++i) {
      const Vector3<T> n = test::random_direction(random).template cast<T>();
      EXPECT_NEAR(mean_clamped_cosine(m, n) - mean_clamped_cosine(m, Vector3<T>(-n)),
                  n.z() * m.mean_z, 8 * std::numeric_limits<T>::epsilon())
          << "seed " << kSeed;
    }
  }
}

TYPED_TEST(LobeMomentsTest, ClampedCosineIsFiniteForNeedles) {
  using T = TypeParam;
  const LobeMoments<T> needle;  // all of it at z
  EXPECT_NEAR(mean_clamped_cosine(needle, Vector3<T>(0, T(0.6), T(0.8))), 0.8, 1e-6);
  EXPECT_EQ(mean_clamped_cosine(needle, Vector3<T>(0, T(0.6), T(-0.8))), 0);
  EXPECT_EQ(mean_clamped_cosine(needle, Vector3<T>(1, 0, 0)), 0);
}

TYPED_TEST(LobeMomentsTest, SecondMomentsAreThoseOfAllMoments) {
  using T = TypeParam;
  // Two independent quadratures; the errors stated for them.
  const double tolerance = std::is_same_v<T, float> ? 3e-6 : 1e-12;
  for (double log_x = -4; log_x < 8; log_x += 0.61) {
    for (double log_y = -4; log_y < 8; log_y += 0.43) {
      const T x = T(std::pow(10, log_x)), y = T(std::pow(10, log_y));
      const AsgSecondMoments<T> found = asg_second_moments(x, y);
      const LobeMoments<double> all = asg_moments<double>(x, y);
      EXPECT_NEAR(found.mean_xx / all.mean_xx, 1, tolerance) << x << " " << y;
      EXPECT_NEAR(found.mean_yy / all.mean_yy, 1, tolerance) << x << " " << y;
      EXPECT_NEAR(found.integral / asg_integral_exact<double>(x, y), 1, tolerance) << x << " " << y;
    }
  }
}

TYPED_TEST(LobeMomentsTest, SecondMomentsHoldAtTheEnds) {
  using T = TypeParam;
  const auto uniform = asg_second_moments(T(0), T(0));  // x is uniform on the disc: E[x^2] = 1 / 4
  EXPECT_NEAR(uniform.mean_xx, 0.25, 1e-6);
  EXPECT_NEAR(uniform.integral, kPi<double>, 1e-5);
  const T large = T(1e30);
  const auto needle = asg_second_moments(large, large);
  EXPECT_NEAR(needle.mean_xx * large, 0.5, 1e-6);
  const auto blade = asg_second_moments(large, T(0));
  EXPECT_NEAR(blade.mean_xx * large, 0.5, 1e-5);
  EXPECT_NEAR(blade.mean_yy, 1.0 / 3, 1e-5);  // y is uniform in -1..1
}

}  // namespace
}  // namespace burnish
