// The kernel that turns what is visible of a lobe into a lobe, on lanes of float.

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "burnish/shading/shading_options.h"
#include "burnish/sphere/anisotropic_gaussian.h"
#include "sphere/simd.h"
#include "support/quadrature.h"

#define HWY_COMPILE_ONLY_STATIC
#include <hwy/highway.h>

#include "shading/visible_part-inl.h"

namespace burnish {
namespace {

namespace kernels = HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

constexpr unsigned kSeed = 83;

/// One lane of the kernel.
AnisotropicGaussian<double> visible_part(const AnisotropicGaussian<double>& lobe,
                                         const Vector3d& gradient, double sine,
                                         const Vector3d& normal, bool is_cut_at_horizon) {
  const hn::ScalableTag<double> d;
  using V = hn::VFromD<decltype(d)>;
  const auto spread = [&](const Vector3d& v) {
    return kernels::Vector3<V>{hn::Set(d, v.x()), hn::Set(d, v.y()), hn::Set(d, v.z())};
  };
  const auto first = [&](const kernels::Vector3<V>& v) {
    return Vector3d(hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z));
  };
  const auto part = kernels::visible_part(
      d,
      kernels::AnisotropicGaussian<V>{spread(lobe.frame.x), spread(lobe.frame.y),
                                      spread(lobe.frame.z), hn::Set(d, lobe.bandwidth_x),
                                      hn::Set(d, lobe.bandwidth_y)},
      kernels::Boundary<V>{hn::Set(d, sine), spread(gradient)}, spread(normal), is_cut_at_horizon);
  AnisotropicGaussian<double> result;
  result.frame.x = first(part.x);
  result.frame.z = first(part.z);
  result.frame.y = result.frame.z.cross(result.frame.x);
  result.bandwidth_x = hn::GetLane(part.bandwidth_x);
  result.bandwidth_y = hn::GetLane(part.bandwidth_y);
  return result;
}

/// The mean, and the covariance in the plane across `axis`, of what of a lobe `visible` holds.
struct Moments {
  Vector3d mean = Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

template <class Visible>
Moments moments_of(const AnisotropicGaussian<double>& lobe, const Visible& visible) {
  // A grid over the orthographic disc about the axis, where the measure of the sphere times v . z
  // is flat; six deviations to either side.
  constexpr int kSteps = 400;
  Moments moments;
  double mass = 0;
  const auto reach = [](double bandwidth) { return std::min(1.0, 6 / std::sqrt(2 * bandwidth)); };
  const double x_end = reach(lobe.bandwidth_x), y_end = reach(lobe.bandwidth_y);
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double x = x_end * (2 * (i + 0.5) / kSteps - 1);
        const double y = y_end * (2 * (j + 0.5) / kSteps - 1);
        if (x * x + y * y >= 1) continue;
        const Vector3d v =
            lobe.frame.x * x + lobe.frame.y * y + lobe.frame.z * std::sqrt(1 - x * x - y * y);
        if (!visible(v)) continue;
        const double weight = std::exp(-lobe.bandwidth_x * x * x - lobe.bandwidth_y * y * y);
        if (pass == 0) {
          mass += weight;
          moments.mean += weight * v;
        } else {
          const Vector3d off = v - moments.mean;
          moments.covariance += weight / mass * off * off.transpose();
        }
      }
    if (pass == 0) moments.mean /= mass;
  }
  return moments;
}

AnisotropicGaussian<double> random_lobe(std::mt19937& random, double least, double most) {
  std::uniform_real_distribution<double> log_bandwidth(std::log(least), std::log(most));
  AnisotropicGaussian<double> lobe;
  lobe.frame = test::random_frame(test::random_direction(random), random);
  lobe.bandwidth_x = std::exp(log_bandwidth(random));
  lobe.bandwidth_y = std::exp(log_bandwidth(random));
  return lobe;
}

double deviation_along(const AnisotropicGaussian<double>& lobe, const Vector3d& direction) {
  const double x = direction.dot(lobe.frame.x), y = direction.dot(lobe.frame.y);
  return std::sqrt(x * x / (2 * lobe.bandwidth_x) + y * y / (2 * lobe.bandwidth_y));
}

TEST(VisiblePart, HasTheMeanAndCovarianceOfWhatLiesPastTheBoundary) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  std::uniform_real_distribution<double> deviations(-1.5, 2);
  for (int i = 0; i < 60; ++i) {
    const AnisotropicGaussian<double> lobe = random_lobe(random, 30, 3000);
    const Vector3d& axis = lobe.frame.z;
    Vector3d gradient = test::random_direction(random);
    gradient = (gradient - gradient.dot(axis) * axis).normalized();
    const double deviation = deviation_along(lobe, gradient);
    const double sine = std::clamp(deviations(random) * deviation, -0.9, 0.9);
    const Vector3d plane = gradient * std::sqrt(1 - sine * sine) + axis * sine;
    const Moments truth = moments_of(lobe, [&](const Vector3d& v) { return v.dot(plane) > 0; });
    const auto part = visible_part(lobe, gradient, sine, axis, false);
    EXPECT_NEAR(part.frame.z.norm(), 1, 1e-6);
    EXPECT_NEAR(part.frame.x.dot(part.frame.z), 0, 1e-6);
    // The sphere bends the plane of the Gaussian: .18 rad at a bandwidth of 30, of which the square
    // is 3 % of a deviation, and the boundary's tangent for its sine as much again.
    const Vector3d mean = truth.mean.normalized();
    EXPECT_LT((part.frame.z - mean).norm(), 0.08 * deviation)
        << lobe.bandwidth_x << " " << lobe.bandwidth_y << " " << sine / deviation;
    // As wide along its own axes as the truth; the same bends count twice in a variance.
    for (const auto& [direction, bandwidth] :
         {std::pair(part.frame.x, part.bandwidth_x), std::pair(part.frame.y, part.bandwidth_y)}) {
      const double expected = direction.dot(truth.covariance * direction);
      EXPECT_NEAR(1 / (2 * bandwidth) / expected, 1, 0.15)
          << lobe.bandwidth_x << " " << lobe.bandwidth_y << " " << sine / deviation;
    }
  }
}

/// The quadratic form that a lobe is the exponential of.
Eigen::Matrix3d form_of(const AnisotropicGaussian<double>& lobe) {
  return lobe.bandwidth_x * lobe.frame.x * lobe.frame.x.transpose() +
         lobe.bandwidth_y * lobe.frame.y * lobe.frame.y.transpose();
}

void expect_same(const AnisotropicGaussian<double>& a, const AnisotropicGaussian<double>& b) {
  EXPECT_LT((a.frame.z - b.frame.z).norm(), 1e-5);
  // Roundings of the larger bandwidth: the axes are found from variances.
  EXPECT_LT((form_of(a) - form_of(b)).norm(), 1e-3 * form_of(b).norm());
}

TEST(VisiblePart, IsTheLobeWhereNothingIsHidden) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int i = 0; i < 100; ++i) {
    const AnisotropicGaussian<double> lobe = random_lobe(random, 20, 1e4);
    // No boundary, or one as far as can be.
    const Vector3d gradient = i % 2 == 0 ? Vector3d(0, 0, 0) : lobe.frame.x;
    expect_same(visible_part(lobe, gradient, 1, lobe.frame.z, true), lobe);
  }
}

TEST(VisiblePart, IsTheLobeAtItsOwnHorizon) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  std::uniform_real_distribution<double> heights(-0.2, 1);
  for (int i = 0; i < 100; ++i) {
    const AnisotropicGaussian<double> lobe = random_lobe(random, 0.6, 1e4);
    const double height = heights(random);
    const Vector3d aside = test::random_frame(lobe.frame.z, random).x;
    const Vector3d normal = lobe.frame.z * height + aside * std::sqrt(1 - height * height);
    expect_same(visible_part(lobe, aside, height, normal, true), lobe);
  }
}

TEST(VisiblePart, IsALobeAtTheExtremes) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (const double bandwidth_x : {1e-3, 0.4, 1.0, 1e4, 1e8})
    for (const double bandwidth_y : {1e-3, 0.4, 1.0, 1e4, 1e8})
      for (const double sine : {-1.0, -1e-9, 0.0, 0.3, 1.0}) {
        AnisotropicGaussian<double> lobe = random_lobe(random, 1, 2);
        lobe.bandwidth_x = bandwidth_x;
        lobe.bandwidth_y = bandwidth_y;
        const Vector3d normal = test::random_direction(random);
        const auto part =
            visible_part(lobe, test::random_frame(lobe.frame.z, random).x, sine, normal, true);
        EXPECT_TRUE(part.frame.x.allFinite() && part.frame.z.allFinite());
        EXPECT_NEAR(part.frame.z.norm(), 1, 1e-6);
        for (const double bandwidth : {part.bandwidth_x, part.bandwidth_y}) {
          EXPECT_GT(bandwidth, 1e-3);
          EXPECT_LT(bandwidth, 1e10);
        }
      }
}

}  // namespace
}  // namespace burnish
