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
  SsdfBasis basis{.resolution = n,
                  .terms = terms,
                  .mean = std::vector<float>(n * n),
                  .eigen = std::vector<float>(n * n * terms)};
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

// A basis without variation, whose mean is the encoded map.
SsdfBasis encoded_basis(const std::vector<float>& map, int resolution, float amplitude_rad) {
  SsdfBasis basis{.resolution = resolution,
                  .terms = 1,
                  .amplitude_rad = amplitude_rad,
                  .mean = map,
                  .eigen = std::vector<float>(map.size())};
  encode_ssdf(basis.mean, amplitude_rad);
  return basis;
}

TEST(SsdfLookup, EncodedDistancesComeBack) {
  std::vector<float> distances;
  for (int i = -1000; i <= 1000; ++i)
    distances.push_back(kPi<float> * static_cast<float>(i) / 1000);
  distances.push_back(-0.0f);
  for (const float amplitude : {0.1f, 0.5f, 0.7f, 2.0f}) {
    std::vector<float> encoded = distances;
    encode_ssdf(encoded, amplitude);
    for (size_t i = 0; i < distances.size(); ++i) {
      const double scaled = double(distances[i]) / double(amplitude);
      ASSERT_NEAR(encoded[i], std::tanh(scaled), 2e-7);
      const float back = decode_ssdf(encoded[i], amplitude);
      ASSERT_LE(std::abs(back), kPi<float>);
      // d distance / d encoded = amplitude cosh^2; where it is large the value may be 1 itself,
      // which stands for pi.
      const double slope = double(amplitude) * std::pow(std::cosh(scaled), 2);
      ASSERT_EQ(std::signbit(back), std::signbit(distances[i]));
      if (slope > 1e5) continue;
      ASSERT_NEAR(back, distances[i], 2.5e-7 * slope + 2e-7) << amplitude;
    }
  }
  EXPECT_EQ(decode_ssdf(1.5f, 0.5f), kPi<float>);  // a reconstruction may overshoot
  EXPECT_EQ(decode_ssdf(-1.0f, 0.5f), -kPi<float>);
  std::vector<float> plain = distances;
  encode_ssdf(plain, 0);
  EXPECT_EQ(plain, distances);
  EXPECT_EQ(decode_ssdf(2.5f, 0), 2.5f);
}

TEST(SsdfLookup, EncodedMapGivesTheDistanceAndItsGradient) {
  const int n = 128;
  const float amplitude = 0.6f;
  const Vector3f normal = Vector3f(-0.2f, 0.7f, 0.4f).normalized();
  const std::vector<float> map = half_space_ssdf(normal, n);
  const SsdfBasis basis = encoded_basis(map, n, amplitude);
  const float coefficient = 3;  // of an eigen-SSDF of zeros
  std::mt19937 random(kSeed);
  for (int i = 0; i < 2000; ++i) {
    const Vector3f d = test::random_direction(random).cast<float>();
    const SsdfSample plain = lookup_ssdf(map.data(), n, d);
    const SsdfSample sample = lookup_ssdf(basis, &coefficient, 1, d);
    // tanh is no straight line over a texel, h = 4 pi^(1/2) / 128 = .055 with its corners: that
    // moves the distance by at most h^2 / 8 times max |tanh''| / tanh' = 2 / amplitude.
    ASSERT_NEAR(sample.distance, plain.distance, 0.055 * 0.055 / 8 * 2 / 0.6) << "seed " << kSeed;
    if (std::abs(normal.dot(d)) > 0.9f) continue;  // the distance has a kink at its poles
    // Slopes across the cell differ by h * 2 / amplitude, which turns the gradient by less.
    ASSERT_GT(sample.gradient.dot(plain.gradient), std::cos(0.055 * 2 / 0.6)) << "seed " << kSeed;
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
  const SsdfBasis basis = encoded_basis(open, n, 0.6f);
  const float coefficient = 1;
  const SsdfSample sample = lookup_ssdf(basis, &coefficient, 1, Vector3f(0.6f, 0, 0.8f));
  // 1 - tanh(pi / .6)^2 is 1.1e-4: a distance of pi comes back to 1e-3.
  EXPECT_NEAR(sample.distance, kPi<float>, 1e-3);
  EXPECT_EQ(sample.gradient.norm(), 0);
  for (const Vector3f& pole : {Vector3f(0, 0, 1), Vector3f(0, 0, -1), Vector3f(1, 0, 0)})
    EXPECT_TRUE(lookup_ssdf(open.data(), n, pole).gradient.allFinite());
}

}  // namespace
}  // namespace burnish
