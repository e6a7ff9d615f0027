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

// One lane of the kernels.

const hn::ScalableTag<double> kTag;
using Lanes = hn::VFromD<hn::ScalableTag<double>>;

kernels::Vector3<Lanes> spread(const Vector3d& v) {
  return {hn::Set(kTag, v.x()), hn::Set(kTag, v.y()), hn::Set(kTag, v.z())};
}

kernels::AnisotropicGaussian<Lanes> spread(const AnisotropicGaussian<double>& lobe) {
  return {spread(lobe.frame.x), spread(lobe.frame.y), spread(lobe.frame.z),
          hn::Set(kTag, lobe.bandwidth_x), hn::Set(kTag, lobe.bandwidth_y)};
}

struct Part : AnisotropicGaussian<double> {
  double third = 0;
};

Part visible_part(const AnisotropicGaussian<double>& lobe, const Vector3d& gradient, double sine,
                  const Vector3d& normal, bool is_cut_at_horizon) {
  const auto first = [](const kernels::Vector3<Lanes>& v) {
    return Vector3d(hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z));
  };
  const auto part = kernels::visible_part(
      kTag, spread(lobe), kernels::Boundary<Lanes>{hn::Set(kTag, sine), spread(gradient)},
      spread(normal), is_cut_at_horizon);
  Part result;
  result.frame.x = first(part.lobe.x);
  result.frame.z = first(part.lobe.z);
  result.frame.y = result.frame.z.cross(result.frame.x);
  result.bandwidth_x = hn::GetLane(part.lobe.bandwidth_x);
  result.bandwidth_y = hn::GetLane(part.lobe.bandwidth_y);
  result.third = hn::GetLane(part.third);
  return result;
}

double visible_share(const AnisotropicGaussian<double>& lobe, const Vector3d& gradient, double sine,
                     const Vector3d& normal) {
  return hn::GetLane(kernels::visible_share(
      kTag, VisibilityModel::directional, spread(lobe),
      kernels::Boundary<Lanes>{hn::Set(kTag, sine), spread(gradient)}, spread(normal)));
}

/// Of what of a lobe `visible` holds.
struct Moments {
  double mass = 0;
  Vector3d mean = Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double third = 0;  ///< along a direction
};

template <class Visible>
Moments moments_of(const AnisotropicGaussian<double>& lobe, const Visible& visible,
                   const Vector3d& direction = Vector3d::UnitX()) {
  // A grid over the orthographic disc about the axis, where the measure of the sphere times v . z
  // is flat; six deviations to either side.
  constexpr int kSteps = 400;
  Moments moments;
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
          moments.mass += weight;
          moments.mean += weight * v;
        } else {
          const Vector3d off = v - moments.mean;
          moments.covariance += weight / moments.mass * off * off.transpose();
          moments.third += weight / moments.mass * std::pow(off.dot(direction), 3);
        }
      }
    if (pass == 0) moments.mean /= moments.mass;
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

/// A lobe that stands for what of `whole` is above a horizon: of its mean and covariance.
AnisotropicGaussian<double> part_above(const AnisotropicGaussian<double>& whole,
                                       const Vector3d& normal) {
  const Moments above = moments_of(whole, [&](const Vector3d& v) { return v.dot(normal) > 0; });
  const Vector3d axis = above.mean.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(across * above.covariance * across);
  AnisotropicGaussian<double> lobe;  // the first axis is `axis`, of no variance
  lobe.frame.z = axis;
  lobe.frame.x = axes.eigenvectors().col(2);
  lobe.frame.y = axis.cross(lobe.frame.x);
  lobe.bandwidth_x = 1 / (2 * axes.eigenvalues()(2));
  lobe.bandwidth_y = 1 / (2 * axes.eigenvalues()(1));
  return lobe;
}

/// A lobe, a normal whose horizon it is at, and the direction across it, in the lobe's plane.
struct AtHorizon {
  AnisotropicGaussian<double> lobe;
  Vector3d normal, across;
};

AtHorizon random_at_horizon(std::mt19937& random, double least_deviations, double most_deviations) {
  std::uniform_real_distribution<double> deviations(least_deviations, most_deviations);
  AtHorizon result;
  result.lobe = random_lobe(random, 100, 3000);
  const Vector3d& axis = result.lobe.frame.z;
  result.across = test::random_frame(axis, random).x;
  const double sine = deviations(random) * deviation_along(result.lobe, result.across);
  result.normal = result.across * std::sqrt(1 - sine * sine) + axis * sine;
  return result;
}

TEST(VisiblePart, IsAsSkewAsWhatLiesPastTheBoundary) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int i = 0; i < 60; ++i) {
    const auto [lobe, plane, across] = random_at_horizon(random, -1.5, 2);
    const double sine = plane.dot(lobe.frame.z);
    const auto part = visible_part(lobe, across, sine, lobe.frame.z, false);
    const Moments truth = moments_of(
        lobe, [&, normal = plane](const Vector3d& v) { return v.dot(normal) > 0; }, part.frame.x);
    // Half of it is meant. The sphere's bend is in it, and where the part is nearly round its axes
    // are anywhere.
    const double unit = std::pow(2 * part.bandwidth_x, -1.5);
    EXPECT_NEAR(part.third / unit, 0.5 * truth.third / unit, 0.12)
        << lobe.bandwidth_x << " " << lobe.bandwidth_y << " "
        << sine / deviation_along(lobe, across);
  }
}

TEST(VisiblePart, AtItsOwnHorizonIsAsSkewAsTheCutMadeIt) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int i = 0; i < 60; ++i) {
    const auto [whole, normal, across] = random_at_horizon(random, -1, 2.5);
    const AnisotropicGaussian<double> lobe = part_above(whole, normal);
    const double sine = normal.dot(lobe.frame.z);
    const Vector3d gradient = (normal - sine * lobe.frame.z).normalized();
    const auto part = visible_part(lobe, gradient, sine, normal, true);
    const Moments truth = moments_of(
        whole, [&, up = normal](const Vector3d& v) { return v.dot(up) > 0; }, part.frame.x);
    const double unit = std::pow(2 * part.bandwidth_x, -1.5);
    // The fit's .05 are halved, too.
    EXPECT_NEAR(part.third / unit, 0.5 * truth.third / unit, 0.1)
        << whole.bandwidth_x << " " << whole.bandwidth_y << " "
        << normal.dot(whole.frame.z) / deviation_along(whole, across);
  }
}

TEST(VisibleShare, OfALobeAboveItsHorizonIsWhatAnotherBoundaryLeaves) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  std::uniform_real_distribution<double> deviations(-1.5, 2);
  double error = 0, error_as_one = 0;
  constexpr int kLobes = 150;
  for (int i = 0; i < kLobes; ++i) {
    const auto [whole, normal, across] = random_at_horizon(random, -0.5, 1.5);
    const AnisotropicGaussian<double> lobe = part_above(whole, normal);
    const Vector3d gradient = test::random_frame(lobe.frame.z, random).x;
    const double sine = deviations(random) * deviation_along(lobe, gradient);
    const Vector3d wall = gradient * std::sqrt(1 - sine * sine) + lobe.frame.z * sine;
    const double above =
        moments_of(whole, [&, up = normal](const Vector3d& v) { return v.dot(up) > 0; }).mass;
    const double seen = moments_of(whole, [&, up = normal](const Vector3d& v) {
                          return v.dot(up) > 0 && v.dot(wall) > 0;
                        }).mass;
    error += std::pow(visible_share(lobe, gradient, sine, normal) - seen / above, 2);
    // Taken as if the boundary cut what the horizon cuts.
    const double straight = normal.dot(lobe.frame.z);
    const Vector3d up = (normal - straight * lobe.frame.z).normalized();
    const auto fraction = [&](double s, const Vector3d& g) {
      return 0.5 + 0.5 * std::erf(s / deviation_along(lobe, g) / std::sqrt(2));
    };
    const double as_one = std::min(1.0, fraction(sine, gradient) / fraction(straight, up));
    error_as_one += std::pow(as_one - seen / above, 2);
  }
  // A Gaussian has no edge at the horizon: a boundary that cuts there finds less than it should.
  EXPECT_LT(std::sqrt(error / kLobes), 0.06);
  EXPECT_LT(error, 0.7 * error_as_one);
}

TEST(VisibleShare, IsAllAtItsOwnHorizon) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int i = 0; i < 100; ++i) {
    const auto [lobe, normal, across] = random_at_horizon(random, -1, 3);
    EXPECT_NEAR(visible_share(lobe, across, normal.dot(lobe.frame.z), normal), 1, 1e-5);
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
