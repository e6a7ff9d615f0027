#include "burnish/sphere/spherical_warp.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/csv.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class SphericalWarp : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SphericalWarp, Scalars);

constexpr double kHalfPi = kPi<double> / 2;

template <class T>
AnisotropicGaussian<T> lobe_of(const Frame<double>& frame, double bandwidth_x, double bandwidth_y) {
  return {frame.cast<T>(), T(bandwidth_x), T(bandwidth_y), T(1)};
}

/// A view at an angle from the frame's axis, at an azimuth from its x.
Vector3d view_at(const Frame<double>& frame, double angle, double azimuth) {
  return frame.to_world(
      {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)});
}

/// Largest departure of a frame from a right-handed orthonormal one.
template <class T>
double frame_error(const Frame<T>& frame) {
  Eigen::Matrix3d m;
  m << frame.x.template cast<double>(), frame.y.template cast<double>(),
      frame.z.template cast<double>();
  return std::max((m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
                  std::abs(m.determinant() - 1));
}

TYPED_TEST(SphericalWarp, MatchesGoldenValues) {
  using T = TypeParam;
  int compared = 0;
  for (const auto& row : test::read_golden("warp_hessian.csv")) {
    const auto vector = [&](const std::string& name) {
      return Vector3<T>(T(row.at(name + "x")), T(row.at(name + "y")), T(row.at(name + "z")));
    };
    AnisotropicGaussian<T> half;
    half.frame = {vector("xh"), vector("yh"), vector("zh")};
    half.bandwidth_x = T(row.at("lambda_h"));
    half.bandwidth_y = T(row.at("mu_h"));
    const Vector3<T> o = vector("o");
    const double cos_view = o.dot(half.frame.z);
    if (cos_view < kMinWarpCosine) continue;
    const AnisotropicGaussian<T> warped = warp_to_incoming(half, o).lobe;
    // The inputs are rounded to T: some ten roundings, of a cosine that the bandwidths hold as
    // 1/cos_view^2.
    const double epsilon = std::numeric_limits<T>::epsilon();
    const double tolerance = 50 * epsilon / (cos_view * cos_view);
    EXPECT_NEAR(warped.bandwidth_x / row.at("lambda_i"), 1, tolerance);
    EXPECT_NEAR(warped.bandwidth_y / row.at("mu_i"), 1, tolerance);
    EXPECT_NEAR((warped.frame.z - vector("zi")).norm(), 0, 10 * epsilon);
    EXPECT_LE(frame_error(warped.frame), 10 * epsilon);
    // The axes turn by the matrix' rounding over the gap of its eigenvalues. Equal bandwidths of
    // the half lobe at the axis have none.
    const double gap = 1 - row.at("mu_i") / row.at("lambda_i");
    if (gap > 0.01) {
      EXPECT_NEAR(warped.frame.x.cross(vector("xi")).norm(), 0, tolerance / gap);
    }
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

TYPED_TEST(SphericalWarp, FollowsTheHalfVectorLobeNearItsAxis) {
  using T = TypeParam;
  const unsigned seed = 23;
  std::mt19937 random(seed);
  for (int k = 0; k < 200; ++k) {
    const Frame<double> frame = test::random_frame(test::random_direction(random), random);
    const auto half = lobe_of<T>(frame, 400, 40);
    Vector3<T> o = test::random_direction(random).cast<T>();
    if (o.dot(half.frame.z) < 0) o = -o;
    if (o.dot(half.frame.z) < T(0.2)) continue;
    const AnisotropicGaussian<T> warped = warp_to_incoming(half, o).lobe;
    // A tenth of a deviation off the axis, along both of the warped lobe's axes: the Taylor
    // remainder is third order, .1 of an exponent of .005. Twice the bandwidths, as printed by the
    // paper, would miss by that exponent.
    for (const auto& [dx, dy] : {std::pair{0.1, 0.0}, {0.0, 0.1}, {0.07, -0.07}}) {
      const T x = T(dx) / std::sqrt(2 * warped.bandwidth_x),
              y = T(dy) / std::sqrt(2 * warped.bandwidth_y);
      const Vector3<T> i = warped.frame.to_world({x, y, std::sqrt(1 - x * x - y * y)});
      const Vector3<T> h = (i + o).normalized();
      EXPECT_NEAR(eval(warped, i) / eval(half, h), 1, 2e-3) << "seed " << seed;
    }
  }
}

// The matrix of the exponent, by central differences of the exact one in the tangent plane.
TEST(SphericalWarp, ExponentMatchesFiniteDifferences) {
  const unsigned seed = 5;
  std::mt19937 random(seed);
  for (int k = 0; k < 100; ++k) {
    const Frame<double> frame = test::random_frame(test::random_direction(random), random);
    const auto half = lobe_of<double>(frame, 7, 1.5);
    const double angle = std::uniform_real_distribution<double>(0, 1.2)(random);
    const Vector3d o = view_at(frame, angle, 10 * angle);
    const AnisotropicGaussian<double> warped = warp_to_incoming(half, o).lobe;
    const auto exponent = [&](double x, double y) {
      const Vector3d i = (warped.frame.z + x * warped.frame.x + y * warped.frame.y).normalized();
      const Vector3d h = frame.to_local((i + o).normalized());
      return 7 * h.x() * h.x() + 1.5 * h.y() * h.y();
    };
    // Fourth-order remainder s^2 times derivatives of order bandwidth / cos^4, which is below 500.
    const double s = 1e-4, tolerance = 1e-5;
    EXPECT_NEAR((exponent(s, 0) + exponent(-s, 0)) / (2 * s * s), warped.bandwidth_x, tolerance);
    EXPECT_NEAR((exponent(0, s) + exponent(0, -s)) / (2 * s * s), warped.bandwidth_y, tolerance);
    EXPECT_NEAR(
        (exponent(s, s) - exponent(s, -s) - exponent(-s, s) + exponent(-s, -s)) / (8 * s * s), 0,
        tolerance)
        << "seed " << seed;
  }
}

TYPED_TEST(SphericalWarp, AxisViewQuartersTheBandwidthsAndKeepsTheAxes) {
  using T = TypeParam;
  AnisotropicGaussian<T> half;
  half.bandwidth_x = 12;
  half.bandwidth_y = 300;
  const WarpedLobe<T> warped = warp_to_incoming(half, half.frame.z);
  EXPECT_EQ(warped.jacobian, 4);
  EXPECT_EQ(warped.lobe.bandwidth_x, 75);
  EXPECT_EQ(warped.lobe.bandwidth_y, 3);
  EXPECT_EQ(std::abs(warped.lobe.frame.x.y()), 1);  // the narrow axis comes first
  EXPECT_EQ(warped.lobe.frame.z, half.frame.z);
}

// The axis x' is a quotient of two roundings there, and must not matter.
TYPED_TEST(SphericalWarp, IsContinuousAndOrthonormalAsTheViewNearsTheAxis) {
  using T = TypeParam;
  const double epsilon = std::numeric_limits<T>::epsilon();
  const unsigned seed = 31;
  std::mt19937 random(seed);
  for (int k = 0; k < 200; ++k) {
    const Frame<double> frame = test::random_frame(test::random_direction(random), random);
    const auto half = lobe_of<T>(frame, 1e4, 1e2);
    const double azimuth = std::uniform_real_distribution<double>(0, 2 * kPi<double>)(random);
    for (double angle = 1e-40; angle < 1e-2; angle *= 10) {
      const Vector3<T> o = view_at(frame, angle, azimuth).cast<T>();
      const AnisotropicGaussian<T> warped = warp_to_incoming(half, o).lobe;
      EXPECT_LE(frame_error(warped.frame), 10 * epsilon) << angle << " seed " << seed;
      // Second order in the angle, and the rounding of the half lobe's frame.
      EXPECT_NEAR(warped.bandwidth_x, 2500, 2500 * (angle * angle + 20 * epsilon));
      EXPECT_NEAR(warped.bandwidth_y, 25, 25 * (angle * angle + 20 * epsilon));
      // First order in the angle: the axis leaves the half lobe's by twice the view's angle.
      EXPECT_NEAR(std::abs(warped.frame.x.dot(half.frame.x)), 1, angle * angle + 20 * epsilon);
    }
  }
}

TYPED_TEST(SphericalWarp, FloatAndDoubleAgreeOnTheMatrixForAnyView) {
  using T = TypeParam;
  const double epsilon = std::numeric_limits<T>::epsilon();
  const Frame<double> frame;  // exact in either type
  for (const double bandwidth : {1e-8, 1.0, 1e8}) {
    for (const double ratio : {1.0, 1 + epsilon, 10.0, 1e6}) {
      for (const double angle : {1e-30, 1e-7, 1e-5, 1e-4, 1e-3, 0.3, 1.2, 1.5, kHalfPi, 2.0}) {
        for (const double azimuth : {0.0, 1e-4, 0.7, 1.57, 3.0}) {
          const auto half = lobe_of<T>(frame, bandwidth, bandwidth / ratio);
          const Vector3<T> o = view_at(frame, angle, azimuth).cast<T>();
          const auto exact = warp_to_incoming<double>(
              {frame, half.bandwidth_x, half.bandwidth_y, 1}, o.template cast<double>());
          const AnisotropicGaussian<T> warped = warp_to_incoming(half, o).lobe;
          // Each value is a few products and roots; the largest sees 1/c^2.
          EXPECT_NEAR(warped.bandwidth_x / exact.lobe.bandwidth_x, 1, 20 * epsilon);
          EXPECT_NEAR(warped.bandwidth_y / exact.lobe.bandwidth_y, 1, 20 * epsilon);
          // What an axis off by d does to the lobe is the gap of the bandwidths times d^2 beside
          // the smaller one: at a ratio of 1e6 d = 4e-7 adds 2e-7.
          const double off = warped.frame.x.template cast<double>().dot(exact.lobe.frame.y);
          const double gap = exact.lobe.bandwidth_x - exact.lobe.bandwidth_y;
          EXPECT_LE(gap * off * off, 0.01 * exact.lobe.bandwidth_y + 20 * epsilon * bandwidth)
              << bandwidth << " " << ratio << " " << angle << " " << azimuth;
        }
      }
    }
  }
}

TYPED_TEST(SphericalWarp, StaysFiniteForEveryBandwidthAndView) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  const std::vector<T> bandwidths = {0,      Limits::denorm_min(), T(1e-8), T(1), T(1e3),
                                     T(1e8), Limits::max()};
  const double epsilon = Limits::epsilon();
  for (const T bandwidth_x : bandwidths) {
    for (const T bandwidth_y : bandwidths) {
      for (const double angle : {0.0, epsilon, 1e-4, 1.0, 1.5, kHalfPi - epsilon, kHalfPi,
                                 kHalfPi + epsilon, 3.0, kPi<double> - epsilon, kPi<double>}) {
        const AnisotropicGaussian<T> half{Frame<T>{}, bandwidth_x, bandwidth_y, T(2)};
        const Vector3<T> o = view_at({}, angle, 0.4).cast<T>();
        const WarpedLobe<T> warped = warp_to_incoming(half, o);
        const AnisotropicGaussian<T>& lobe = warped.lobe;
        EXPECT_LE(frame_error(lobe.frame), 20 * epsilon);
        EXPECT_TRUE(std::isfinite(lobe.bandwidth_x) && std::isfinite(lobe.bandwidth_y));
        EXPECT_GE(lobe.bandwidth_x, lobe.bandwidth_y * (1 - 4 * T(epsilon)));
        EXPECT_GE(lobe.bandwidth_y, 0);
        EXPECT_EQ(lobe.amplitude, o.z() > 0 ? 2 : 0) << angle;
        EXPECT_GE(warped.jacobian, T(4 * kMinWarpCosine));
        EXPECT_LE(warped.jacobian, 4 + 8 * T(epsilon));
        if (bandwidth_x == 0 && bandwidth_y == 0) {
          EXPECT_EQ(lobe.bandwidth_x, 0);
        }
      }
    }
  }
}

TYPED_TEST(SphericalWarp, NarrowsAcrossTheViewAsItNearsGrazing) {
  using T = TypeParam;
  const auto half = lobe_of<T>({}, 50, 50);
  T before = 0;
  for (double angle = 0; angle < 3.1; angle += 0.01) {
    const T now = warp_to_incoming<T>(half, view_at({}, angle, 0.3).cast<T>()).lobe.bandwidth_x;
    EXPECT_GE(now, before * (1 - 8 * std::numeric_limits<T>::epsilon()));
    before = now;
  }
}

// Change of variable: the integral of D(h) over h is that of D(h(i)) / (4 o.h) over i.
TYPED_TEST(SphericalWarp, DividingByTheJacobianKeepsTheIntegral) {
  using T = TypeParam;
  for (const double angle : {0.0, 0.5, 1.0}) {
    const auto half = lobe_of<T>({}, 900, 500);
    const Vector3d o = view_at({}, angle, 0.7);
    const WarpedLobe<T> warped = warp_to_incoming<T>(half, o.cast<T>());
    const double of_lobe = integral(warped.lobe) / warped.jacobian;
    EXPECT_NEAR(of_lobe / integral(half), 1, 20 * std::numeric_limits<T>::epsilon());
    const AnisotropicGaussian<double> exact = lobe_of<double>({}, 900, 500);
    const double truth = test::integrate_sphere(
        [&](const Vector3d& i) {
          const Vector3d h = (i + o).normalized();
          return h.z() > 0 ? eval(exact, h) / (4 * h.dot(o)) : 0.0;
        },
        warped.lobe.frame.z.template cast<double>().normalized(), 256);
    // The quadrature's own error is 1e-5 (against 512 steps).
    EXPECT_NEAR(truth / integral(exact), 1, 1e-4);
  }
}

TYPED_TEST(SphericalWarp, CutNormalHasTheMomentsOfItsPositivePart) {
  using T = TypeParam;
  const double deviation = 0.3;
  for (const double ratio : {-3.5, -1.0, 0.0, 1.0, 4.0, 5.99, 6.01, 30.0}) {
    const double mean = ratio * deviation;
    double moment[4] = {};  // of s_+; the zeroth is the probability
    for (const auto& [s, weight] : test::gauss_legendre(200, std::max(0.0, mean - 9 * deviation),
                                                        std::max(mean, 0.0) + 9 * deviation)) {
      const double density = std::exp(-std::pow((s - mean) / deviation, 2) / 2) /
                             (deviation * std::sqrt(2 * kPi<double>));
      for (int k = 0; k < 4; ++k) moment[k] += weight * density * std::pow(s, k);
    }
    const auto cut = internal::cut_normal(T(mean), T(deviation));
    // What is cut at 6 deviations is 1e-10. Far below 0 the terms, ten times the result, cancel
    // twice, to a 20th and to a 30th.
    const double tolerance = 1e4 * std::numeric_limits<T>::epsilon() + (ratio > 4 ? 1e-9 : 0);
    EXPECT_NEAR(cut.mean / moment[1], 1, tolerance) << ratio;
    EXPECT_NEAR(cut.weighted_mean / (moment[2] / moment[1]), 1, tolerance) << ratio;
    EXPECT_NEAR(cut.weighted_square / (moment[3] / moment[1]), 1, tolerance) << ratio;
    EXPECT_NEAR(cut.probability_over_mean / (moment[0] / moment[1]), 1, tolerance) << ratio;
  }
}

/// Mean of the incoming direction and the integral of D(h(i)) over i, as sums over half vectors in
/// the orthographic disc, where the lobe is a plane Gaussian and di = 4 o.h dh.
struct WarpTruth {
  double integral = 0;
  Vector3d mean = Vector3d::Zero();
};

WarpTruth warp_truth(const AnisotropicGaussian<double>& half, const Vector3d& outgoing) {
  WarpTruth truth;
  static const auto rule = test::gauss_legendre(200, -1, 1);
  const auto reach = [](double bandwidth) { return std::min(1.0, 6 / std::sqrt(2 * bandwidth)); };
  for (const auto& [t, weight_t] : rule) {
    const double y = t * reach(half.bandwidth_y);
    const double width = std::min(std::sqrt(1 - y * y), reach(half.bandwidth_x));
    for (const auto& [u, weight_u] : rule) {
      const double x = u * width;
      const Vector3d h = half.frame.to_world({x, y, std::sqrt(1 - x * x - y * y)});
      const double s = h.dot(outgoing);
      if (s <= 0) continue;
      const double weight = weight_t * weight_u * width * reach(half.bandwidth_y) *
                            std::exp(-half.bandwidth_x * x * x - half.bandwidth_y * y * y);
      truth.integral += weight * 4 * s;
      truth.mean += weight * 4 * s * (2 * s * h - outgoing);
    }
  }
  truth.mean.normalize();
  return truth;
}

TYPED_TEST(SphericalWarp, MeanFormKeepsTheMeanDirectionAndTheIntegral) {
  using T = TypeParam;
  // A normal variable lacks the third moments of s: those of the lobe and, near the horizon, those
  // of the cut. They move the axis by a part of the variance of the long axis, 1 / (2 bandwidth).
  const struct {
    double bandwidth_x, bandwidth_y, integral_error;
  } rows[] = {{400, 40, .01}, {100, 10, .01}, {30, 30, .01}, {10, 1, .1}};
  for (const auto& row : rows) {
    const auto shape = make_lobe_shape(T(row.bandwidth_x), T(row.bandwidth_y));
    for (const double angle : {0.0, 0.5, 1.0, 1.4, kHalfPi}) {
      for (const double azimuth : {0.0, 0.8, kHalfPi}) {
        const Vector3d o = view_at({}, angle, azimuth);
        const auto half = lobe_of<T>({}, row.bandwidth_x, row.bandwidth_y);
        const WarpedLobe<T> warped = warp_mean_to_incoming<T>(half, shape, o.cast<T>());
        const WarpTruth truth =
            warp_truth(lobe_of<double>({}, row.bandwidth_x, row.bandwidth_y), o);
        SCOPED_TRACE(testing::Message() << row.bandwidth_x << " " << row.bandwidth_y << " at "
                                        << angle << ", " << azimuth);
        EXPECT_NEAR(integral(warped.lobe) / truth.integral, 1, row.integral_error);
        EXPECT_LE(angle_between<double>(warped.lobe.frame.z.template cast<double>(), truth.mean),
                  0.6 / (2 * row.bandwidth_y));
        EXPECT_NEAR(integral(warped.lobe) / (warped.jacobian * shape.integral), 1,
                    20 * std::numeric_limits<T>::epsilon());
      }
    }
  }
}

// E[s^2 h] is a sum of the lobe's moments up to the third, and no half vector is hidden.
TYPED_TEST(SphericalWarp, MeanFormIsExactWhereNothingIsCut) {
  using T = TypeParam;
  for (const auto& [x, y] : {std::pair{400.0, 40.0}, {60.0, 30.0}}) {
    const auto half = lobe_of<T>({}, x, y);
    const auto shape = make_lobe_shape(half.bandwidth_x, half.bandwidth_y);
    for (const double angle : {0.0, 0.3, 0.6}) {
      const Vector3d o = view_at({}, angle, 0.8);
      const WarpedLobe<T> warped = warp_mean_to_incoming<T>(half, shape, o.cast<T>());
      const WarpTruth truth = warp_truth(lobe_of<double>({}, x, y), o);
      // The quadrature leaves out exp(-18) of the lobe; else rounding.
      const double tolerance = 20 * std::numeric_limits<T>::epsilon() + 2e-8;
      EXPECT_LE((warped.lobe.frame.z.template cast<double>() - truth.mean).norm(), tolerance)
          << x << " " << y << " " << angle;
      EXPECT_NEAR(integral(warped.lobe) / truth.integral, 1, tolerance) << x << " " << y;
    }
  }
}

TYPED_TEST(SphericalWarp, BothFormsAgreeOnNarrowLobes) {
  using T = TypeParam;
  const auto half = lobe_of<T>({}, 1e6, 1e4);
  const auto shape = make_lobe_shape(half.bandwidth_x, half.bandwidth_y);
  for (const double angle : {0.0, 1e-5, 0.5, 1.2}) {
    const Vector3<T> o = view_at({}, angle, 0.6).cast<T>();
    const WarpedLobe<T> peak = warp_to_incoming(half, o);
    const WarpedLobe<T> mean = warp_mean_to_incoming(half, shape, o);
    // The mean leaves the peak by the curvature, variance (5e-5) times tan: some 1e-4.
    EXPECT_LE(angle_between(peak.lobe.frame.z, mean.lobe.frame.z), 1e-3);
    EXPECT_NEAR(mean.lobe.amplitude, 1, 1e-3);
    EXPECT_NEAR(mean.jacobian / peak.jacobian, 1, 1e-3);
    EXPECT_NEAR(mean.lobe.bandwidth_x / peak.lobe.bandwidth_x, 1, 3e-3);
    EXPECT_NEAR(mean.lobe.bandwidth_y / peak.lobe.bandwidth_y, 1, 3e-3);
  }
}

TYPED_TEST(SphericalWarp, MeanFormFadesAsTheViewPassesTheHorizon) {
  using T = TypeParam;
  const auto half = lobe_of<T>({}, 100, 10);
  const auto shape = make_lobe_shape(half.bandwidth_x, half.bandwidth_y);
  T before = 10;
  WarpedLobe<T> last;
  for (double angle = 0.3; angle < 3.14; angle += 0.001) {
    const auto warped = warp_mean_to_incoming<T>(half, shape, view_at({}, angle, 1).cast<T>());
    // E[max(s, 0)] falls with the mean of s; what the deviation adds by turning is below 1e-3.
    EXPECT_LE(warped.jacobian, before + T(1e-5)) << angle;
    if (angle > 0.3) {
      EXPECT_LE(angle_between(warped.lobe.frame.z, last.lobe.frame.z), 0.02) << angle;
    }
    before = warped.jacobian;
    last = warped;
  }
  EXPECT_EQ(before, 0);
  EXPECT_EQ(last.lobe.amplitude, 0);
}

TYPED_TEST(SphericalWarp, MeanFormStaysFiniteForEveryBandwidthAndView) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  const double epsilon = Limits::epsilon();
  for (const double x :
       {0.0, double(Limits::denorm_min()), 1e-8, 1e-3, 1.0, 1e3, 1e8, double(Limits::max())}) {
    for (const double ratio : {1.0, 1 + epsilon, 10.0, 1e6}) {
      const T bandwidth_x = T(x), bandwidth_y = T(x / ratio);
      const auto shape = make_lobe_shape(bandwidth_x, bandwidth_y);
      for (const double angle : {0.0, epsilon, 1e-4, 1.0, 1.5, kHalfPi - epsilon, kHalfPi,
                                 kHalfPi + epsilon, 1.7, 3.0, kPi<double> - epsilon, kPi<double>}) {
        for (const double amplitude : {0.0, double(Limits::denorm_min()), 1e30, -1.0}) {
          const AnisotropicGaussian<T> half{{}, bandwidth_x, bandwidth_y, T(amplitude)};
          const Vector3<T> o = view_at({}, angle, 0.4).cast<T>();
          const WarpedLobe<T> warped = warp_mean_to_incoming(half, shape, o);
          const AnisotropicGaussian<T>& lobe = warped.lobe;
          SCOPED_TRACE(testing::Message() << x << " " << ratio << " " << angle);
          EXPECT_LE(frame_error(lobe.frame), 40 * epsilon);
          EXPECT_TRUE(std::isfinite(lobe.bandwidth_x) && std::isfinite(lobe.bandwidth_y));
          EXPECT_GE(lobe.bandwidth_y, 0);
          EXPECT_TRUE(std::isfinite(lobe.amplitude));
          EXPECT_GE(lobe.amplitude * amplitude, 0);
          EXPECT_GE(warped.jacobian, 0);
          EXPECT_LE(warped.jacobian, 4 + 8 * T(epsilon));
          const auto exact = warp_mean_to_incoming<double>(
              {{}, half.bandwidth_x, half.bandwidth_y, 1},
              make_lobe_shape<double>(half.bandwidth_x, half.bandwidth_y),
              o.template cast<double>());
          EXPECT_NEAR(warped.jacobian, exact.jacobian, 200 * epsilon);
          // Of the widest, 4 deviations past the horizon: E has cancelled to 1/20 of its terms, the
          // mean square to 1/30 of those.
          if (bandwidth_x <= T(1e8)) {
            EXPECT_NEAR(lobe.bandwidth_x, exact.lobe.bandwidth_x,
                        1e4 * epsilon * exact.lobe.bandwidth_x + Limits::denorm_min());
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace burnish
