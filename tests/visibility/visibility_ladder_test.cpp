#include "burnish/visibility/visibility_ladder.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 12;

std::vector<float> harmonics_at(int bands, const Vector3d& direction) {
  std::vector<float> values(static_cast<size_t>(bands) * static_cast<size_t>(bands));
  eval_harmonics(bands, direction.cast<float>(), values);
  return values;
}

/// A ladder of one term with random harmonics, and its value at a direction, in double.
struct RandomLadder {
  LadderBasis basis;
  float coefficient = 0.5f;

  RandomLadder(int bands, std::mt19937& random) {
    std::uniform_real_distribution<float> value(-0.1f, 0.1f);
    basis.bands = bands;
    basis.terms = 1;
    for (int i = 0; i < bands * bands; ++i) {
      basis.mean.push_back(value(random));
      basis.eigen.push_back(value(random));
    }
    basis.mean[0] = 1.7f;  // half the sphere, so that fractions stay between 0 and 1
  }
  double visible_at(const Vector3d& direction) const {
    const std::vector<float> y = harmonics_at(basis.bands, direction);
    double sum = 0;
    for (size_t i = 0; i < y.size(); ++i)
      sum += double(y[i]) * (basis.mean[i] + coefficient * basis.eigen[i]);
    return sum;
  }
};

TEST(LadderHarmonics, AreThoseOfTheStandardLibrary) {
  std::mt19937 random(kSeed);
  std::vector<Vector3d> directions = {Vector3d::UnitZ(), -Vector3d::UnitZ(), Vector3d::UnitX(),
                                      -Vector3d::UnitY()};
  for (int i = 0; i < 200; ++i) directions.push_back(test::random_direction(random));
  for (const Vector3d& d : directions) {
    const std::vector<float> y = harmonics_at(kMaxLadderBands, d);
    const double theta = std::acos(std::clamp(d.z(), -1.0, 1.0)), phi = std::atan2(d.y(), d.x());
    for (unsigned l = 0; l < kMaxLadderBands; ++l)
      for (unsigned m = 0; m <= l; ++m) {
        // sph_legendre has the Condon-Shortley phase.
        const double q =
            std::sph_legendre(l, m, theta) * (m == 0 ? 1 : std::sqrt(2.0)) * (m % 2 == 1 ? -1 : 1);
        // Sixteen steps of a recurrence in float, of values up to 1.6: a few ulps a step.
        EXPECT_NEAR(y[l * l + m], q * std::cos(m * phi), 5e-6) << l << " " << m << " " << kSeed;
        if (m > 0) {
          EXPECT_NEAR(y[l * l + l + m], q * std::sin(m * phi), 5e-6) << l << " " << m;
        }
      }
  }
}

TEST(LobeBands, AreTheLegendreCoefficientsOfTheLobe) {
  for (const double bandwidth : {0.0, 1e-6, 0.1, 1.0, 2.7, 8.0, 40.0, 1000.0}) {
    const LobeBands lobe = lobe_bands(static_cast<float>(bandwidth));
    ASSERT_GE(lobe.bands, 1);
    for (unsigned l = 0; l < kMaxLadderBands; ++l) {
      double sum = 0, whole = 0;
      for (const auto& [x, weight] : test::gauss_legendre(400, -1, 1)) {
        const double value = weight * std::exp(2 * bandwidth * (x - 1));
        whole += value;
        sum += value * std::legendre(l, x);
      }
      if (l < static_cast<unsigned>(lobe.bands))
        // The recurrence starts between two bounds of the ratio, which are closest, and least
        // corrected by its steps, where the sharpness is a few times the number of bands.
        EXPECT_NEAR(lobe.factor[l], sum / whole, 3e-5) << bandwidth << " band " << l;
      else
        EXPECT_LT(sum / whole, 1.01e-4) << bandwidth << " band " << l;  // left out, as documented
    }
  }
}

TEST(LobeBands, AreFiniteForEveryBandwidth) {
  for (const float bandwidth : {0.0f, std::numeric_limits<float>::denorm_min(), 1e20f, 1e38f}) {
    const LobeBands lobe = lobe_bands(bandwidth);
    for (const float factor : lobe.factor) EXPECT_TRUE(factor >= 0 && factor <= 1) << bandwidth;
  }
}

TEST(LadderFraction, IsTheIntegralOfTheLobeOverTheVisibility) {
  std::mt19937 random(kSeed);
  for (const int bands : {1, 4, 5, 13, 16}) {
    const RandomLadder ladder(bands, random);
    const VisibilityHarmonics visibility = reconstruct_harmonics(ladder.basis, &ladder.coefficient);
    for (const double bandwidth : {0.0, 0.5, 3.0, 20.0}) {
      const Vector3d axis = test::random_direction(random);
      double seen = 0, whole = 0;
      for (const test::Node& node :
           test::nodes_about(test::random_frame(axis, random), bandwidth, bandwidth, 64, 48)) {
        const double value = node.weight * std::exp(2 * bandwidth * (node.direction.dot(axis) - 1));
        whole += value;
        seen += value * ladder.visible_at(node.direction);
      }
      // Bands below 1e-4 are left out: each holds at most .15 sqrt(2 l + 1) of the visibility here.
      EXPECT_NEAR(visible_fraction(visibility, axis.cast<float>(),
                                   lobe_bands(static_cast<float>(bandwidth))),
                  std::clamp(seen / whole, 0.0, 1.0), 2e-4)
          << bands << " bands, bandwidth " << bandwidth << ", seed " << kSeed;
    }
  }
}

TEST(LadderFraction, StaysBetweenNoneAndAll) {
  const float coefficient = 0;
  for (const float mean : {-4.0f, 9.0f}) {
    const LadderBasis basis{1, 1, {mean}, {0.0f}};
    const VisibilityHarmonics visibility = reconstruct_harmonics(basis, &coefficient);
    EXPECT_EQ(visible_fraction(visibility, Vector3f::UnitX(), lobe_bands(1)), mean > 0 ? 1 : 0);
  }
}

TEST(LadderFraction, OfEverythingVisibleIsOne) {
  const LadderBasis basis{1, 1, {std::sqrt(4 * kPi<float>)}, {0.0f}};
  const float coefficient = 0;
  const VisibilityHarmonics visibility = reconstruct_harmonics(basis, &coefficient);
  for (const float bandwidth : {0.0f, 1.0f, 30.0f})
    EXPECT_NEAR(visible_fraction(visibility, -Vector3f::UnitZ(), lobe_bands(bandwidth)), 1, 1e-6);
}

}  // namespace
}  // namespace burnish
