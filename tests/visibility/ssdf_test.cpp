#include "burnish/visibility/ssdf.h"

#include <random>

#include <gtest/gtest.h>

#include "burnish/sphere/octahedral_map.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 5;

/// SSDF of the half-space above a plane: asin(n . d).
std::vector<float> half_space_ssdf(const Vector3f& normal, int resolution) {
  std::vector<float> map;
  for (int i = 0; i < resolution * resolution; ++i)
    map.push_back(std::asin(std::clamp(
        normal.dot(octahedral_texel_direction<float>(i % resolution, i / resolution, resolution)),
        -1.0f, 1.0f)));
  return map;
}

TEST(SsdfLookup, FollowsAHalfSpaceInValueAndGradient) {
  const int n = 128;
  const Vector3f normal = Vector3f(0.3f, 0.5f, -0.8f).normalized();
  const std::vector<float> map = half_space_ssdf(normal, n);
  std::mt19937 random(kSeed);
  const double texel = std::sqrt(4 * kPi<double>) / n;
  int kinked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3f d = test::random_direction(random).cast<float>();
    const float sine = normal.dot(d);
    const SsdfSample sample = lookup_ssdf(map.data(), n, d);
    // A distance function has slope 1: interpolation is wrong by less than a texel anywhere.
    ASSERT_NEAR(sample.distance, std::asin(sine), texel) << "seed " << kSeed;
    if (std::abs(sine) > 0.9f) continue;  // the distance has a kink at its poles
    const Vector3f gradient = (normal - sine * d).normalized();
    ASSERT_NEAR(sample.gradient.norm(), 1, 1e-5);
    if (sample.gradient.dot(gradient) < std::cos(0.1)) ++kinked;
  }
  // Only cells that a fold or a pole of the map crosses: 4 n of n^2 cells, a quarter of them off by
  // .1 rad.
  EXPECT_LT(kinked, 2000 * 4 / n) << "seed " << kSeed;
}

TEST(SsdfLookup, CompressedEqualsTheSumOfItsParts) {
  const int n = 16, terms = 5;
  std::mt19937 random(kSeed);
  std::normal_distribution<float> normal;
  SsdfBasis basis{n, terms, std::vector<float>(n * n), std::vector<float>(n * n * terms)};
  for (float& v : basis.mean) v = normal(random);
  for (float& v : basis.eigen) v = normal(random);
  std::vector<float> coefficients(terms);
  for (float& v : coefficients) v = normal(random);
  for (const int used : {1, 3, 5}) {
    std::vector<float> sum = basis.mean;
    for (int t = 0; t < n * n; ++t)
      for (int k = 0; k < used; ++k) sum[t] += basis.eigen[t * terms + k] * coefficients[k];
    for (int i = 0; i < 200; ++i) {
      const Vector3f d = test::random_direction(random).cast<float>();
      const SsdfSample a = lookup_ssdf(sum.data(), n, d);
      const SsdfSample b = lookup_ssdf(basis, coefficients.data(), used, d);
      ASSERT_NEAR(a.distance, b.distance, 1e-5);
      ASSERT_NEAR((a.gradient - b.gradient).norm(), 0, 1e-4);
    }
  }
}

TEST(SsdfLookup, FlatMapHasNoGradient) {
  const int n = 16;
  const std::vector<float> open(n * n, kPi<float>);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 100; ++i) {
    const SsdfSample sample =
        lookup_ssdf(open.data(), n, test::random_direction(random).cast<float>());
    EXPECT_NEAR(sample.distance, kPi<float>, 1e-5);
    EXPECT_EQ(sample.gradient.norm(), 0);
  }
  for (const Vector3f& pole : {Vector3f(0, 0, 1), Vector3f(0, 0, -1), Vector3f(1, 0, 0)})
    EXPECT_TRUE(lookup_ssdf(open.data(), n, pole).gradient.allFinite());
}

}  // namespace
}  // namespace burnish
