#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/clustered_pca_target.h"
#include "burnish/precompute/lobe_visibility_error.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/ssdf.h"
#include "lobe_visibility_samples.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

using Eigen::Index;
constexpr unsigned kSeed = 20090212;
constexpr int kResolution = 32;
constexpr Index kTexels = Index{kResolution} * kResolution;

VisibilityMask half_space_mask(const Vector3d& normal, int resolution) {
  VisibilityMask mask(resolution);
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x)
      if (octahedral_texel_direction<double>(x, y, resolution).dot(normal) > 0)
        mask.set_visible(x, y);
  return mask;
}

/// Fraction of exp(2 b (cos - 1)) on the visible side of a great circle at a signed distance from
/// its axis: over circles around the axis, of which each is visible in part.
double half_space_fraction(double bandwidth, double distance) {
  const int steps = 200000;
  const double sine = std::sin(distance), cosine = std::cos(distance);
  double visible = 0, all = 0;
  for (int i = 0; i < steps; ++i) {
    const double z = -1 + (i + 0.5) * 2 / steps;
    const double weight = std::exp(2 * bandwidth * (z - 1));
    const double reach = cosine * std::sqrt(1 - z * z);
    const double edge =
        reach > 0 ? std::clamp(-z * sine / reach, -1.0, 1.0) : (z * sine > 0 ? -1 : 1);
    all += weight;
    visible += weight * std::acos(edge) / kPi<double>;
  }
  return visible / all;
}

TEST(ExactVisibleFraction, MatchesQuadratureOfAHalfSpace) {
  std::mt19937 random(kSeed);
  for (int i = 0; i < 8; ++i) {
    const Vector3d normal = test::random_direction(random), axis = test::random_direction(random);
    const VisibilityMask mask = half_space_mask(normal, 256);
    for (const double bandwidth : {1.0, 8.0, 32.0, 128.0}) {
      const double fraction = exact_visible_fraction(mask, axis.cast<float>(), bandwidth);
      // The mask's boundary is a staircase of texels of edge h = .0138: over the n = sqrt(pi /
      // (2 b)) / h texels that the lobe has along it, each off by at most h / 2 and as often to
      // either side, 4 standard deviations of the mean; in units of the lobe's density there,
      // sqrt(2 b / pi).
      const double h = std::sqrt(4 * kPi<double>) / 256,
                   density = std::sqrt(2 * bandwidth / kPi<double>);
      const double tolerance = 4 * h / std::sqrt(12.0) * density * std::sqrt(h * density);
      EXPECT_NEAR(fraction, half_space_fraction(bandwidth, std::asin(axis.dot(normal))), tolerance)
          << bandwidth << ", seed " << kSeed;
    }
  }
}

TEST(ExactVisibleFraction, OpenIsOneAndBlockedIsZero) {
  VisibilityMask open(64);
  for (std::uint64_t& word : open.bits) word = ~std::uint64_t{0};
  for (const double bandwidth : {0.0, 1.0, 100.0}) {
    EXPECT_EQ(exact_visible_fraction(open, Vector3f(0.6f, 0, 0.8f), bandwidth), 1);
    EXPECT_EQ(exact_visible_fraction(VisibilityMask(64), Vector3f(0, 0, 1), bandwidth), 0);
  }
}

/// SSDFs of half-spaces (asin(n . d)), and their masks.
struct Scene {
  RowMatrixf ssdfs;
  std::vector<VisibilityMask> masks;

  explicit Scene(int vertices, int mask_resolution = 128) : ssdfs(vertices, kTexels) {
    std::mt19937 random(kSeed);
    for (Index i = 0; i < vertices; ++i) {
      const Vector3d normal = test::random_direction(random);
      masks.push_back(half_space_mask(normal, mask_resolution));
      for (int t = 0; t < kTexels; ++t) {
        const Vector3d d =
            octahedral_texel_direction<double>(t % kResolution, t / kResolution, kResolution);
        ssdfs(i, t) = static_cast<float>(std::asin(std::clamp(normal.dot(d), -1.0, 1.0)));
      }
    }
  }
};

struct Compressed {
  std::vector<SsdfBasis> bases;
  std::vector<std::uint8_t> id;
  std::vector<float> coefficients;
};

Compressed compress(const std::vector<PcaBasis>& bases, const RowMatrixf& ssdfs,
                    float amplitude_rad) {
  RowMatrixf encoded = ssdfs;
  encode_ssdf({encoded.data(), static_cast<std::size_t>(encoded.size())}, amplitude_rad);
  const ClusteredProjector projector(bases);
  const auto count = static_cast<std::size_t>(ssdfs.rows());
  Compressed result;
  result.id.resize(count);
  result.coefficients.resize(count * static_cast<std::size_t>(projector.terms()));
  std::vector<double> squared(count);
  ClusteredProjector::Scratch scratch;
  projector.project(encoded, result.coefficients, result.id, squared, scratch);
  for (const PcaBasis& basis : bases)
    result.bases.push_back(
        {.resolution = kResolution,
         .terms = static_cast<int>(basis.terms()),
         .amplitude_rad = amplitude_rad,
         .mean = {basis.mean.data(), basis.mean.data() + basis.mean.size()},
         .eigen = {basis.components.data(), basis.components.data() + basis.components.size()}});
  return result;
}

std::vector<PcaBasis> train(const Scene& scene, float amplitude_rad, int terms, int bases) {
  RowMatrixf encoded = scene.ssdfs;
  encode_ssdf({encoded.data(), static_cast<std::size_t>(encoded.size())}, amplitude_rad);
  return train_clustered_pca(encoded, {.terms = terms, .bases = bases});
}

LobeVisibilityErrors measure(const Scene& scene, const Compressed& compressed,
                             const LobeVisibilityOptions& options = {}) {
  return measure_lobe_visibility(
      {compressed.bases, compressed.id, compressed.coefficients, scene.ssdfs, scene.masks},
      options);
}

TEST(LobeVisibility, LosslessBasisHasNoCompressionError) {
  const Scene scene(30);
  for (const float amplitude : {0.0f, 0.6f}) {
    const auto errors =
        measure(scene, compress(train(scene, amplitude, 64, 1), scene.ssdfs, amplitude));
    // Rounding of 30-term sums, 1e-6, times the density sqrt(2 b / pi) = 18 of the narrowest lobe.
    // Interpolated over h = .11 after encoding, a distance d is off by h^2 / 8 times 2 tanh(d / s)
    // / s, which the density at d, exp(-b d^2) of that at 0, turns into at most h^2 / 8 * 2 / s^2 *
    // sqrt(2 / pi) * max(x exp(-x^2)) = .003 for s = .6.
    for (const LobeError& error : errors.compression)
      EXPECT_LT(error.relative_rms, amplitude == 0 ? 2e-5 : 3e-3) << error.bandwidth;
    EXPECT_LT(errors.rms_rad, 1e-5);
    // Only a texel whose distance is zero to rounding could change its sign.
    EXPECT_LT(errors.wrong_sign_fraction, 1e-3);
  }
}

TEST(LobeVisibility, HalfSpacesAreWhatTheModelIsFor) {
  // Uncompressed, the half-space model errs by .003 of its own, and by the interpolation of asin
  // over texels of h = .11: h^2 / 8 = .0015 rad times the lobe's density. The fraction's rms is
  // .65.
  const Scene scene(40, 512);
  const auto errors = measure(scene, compress(train(scene, 0, 64, 1), scene.ssdfs, 0));
  ASSERT_EQ(errors.whole.size(), 4u);
  for (const LobeError& error : errors.whole)
    EXPECT_LT(error.relative_rms,
              (0.003 + 0.0015 * std::sqrt(2 * error.bandwidth / kPi<double>)) / 0.65)
        << error.bandwidth;
}

TEST(LobeVisibility, ErrorsMatchTheSlowForm) {
  const Scene scene(12);
  const Compressed compressed = compress(train(scene, 0.6f, 3, 2), scene.ssdfs, 0.6f);
  const LobeVisibilityOptions options{.bandwidths = {8, 60}, .strata = 4};
  const auto errors = measure(scene, compressed, options);
  ASSERT_EQ(errors.compression.size(), 2u);
  const std::vector<Vector3f> directions = stratified_directions(4, options.seed);
  for (std::size_t b = 0; b < 2; ++b) {
    const float bandwidth = options.bandwidths[b];
    SquaredError compression, whole;
    for (std::size_t v = 0; v < 12; ++v)
      for (std::size_t i = v % kEachOf; i < directions.size(); i += kEachOf) {
        const Vector3f& d = directions[i];
        const float* coefficients = compressed.coefficients.data() + v * 3;
        const double value = isotropic_fraction(
            bandwidth, d, lookup_ssdf(compressed.bases[compressed.id[v]], coefficients, 3, d));
        const float* ssdf = scene.ssdfs.row(static_cast<Index>(v)).data();
        compression.add(value, isotropic_fraction(bandwidth, d, lookup_ssdf(ssdf, kResolution, d)));
        whole.add(value, exact_visible_fraction(scene.masks[v], d, double(bandwidth)));
      }
    EXPECT_NEAR(errors.compression[b].relative_rms, compression.relative_rms(), 1e-7);
    // The fast form sums coarser texels, which errs by a 24th of .23^2 of the second derivative,
    // and stops where 1e-5 of the lobe is left.
    EXPECT_NEAR(errors.whole[b].relative_rms, whole.relative_rms(), 0.003);
  }
}

TEST(LobeVisibility, SameResultOnAnyNumberOfThreads) {
  const Scene scene(20);
  const Compressed compressed = compress(train(scene, 0.6f, 3, 2), scene.ssdfs, 0.6f);
  std::vector<LobeVisibilityErrors> results;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(measure(scene, compressed));
  }
  for (const LobeVisibilityErrors& other : results) {
    EXPECT_EQ(other.rms_rad, results[0].rms_rad);
    for (std::size_t b = 0; b < 4; ++b) {
      EXPECT_EQ(other.compression[b].relative_rms, results[0].compression[b].relative_rms);
      EXPECT_EQ(other.whole[b].relative_rms, results[0].whole[b].relative_rms);
    }
  }
}

TEST(LobeVisibility, RefusesWhatDoesNotMatch) {
  const Scene scene(4);
  const Compressed good = compress(train(scene, 0, 2, 1), scene.ssdfs, 0);
  const auto expect_refusal = [&](const Compressed& compressed,
                                  const LobeVisibilityOptions& options) {
    EXPECT_THROW(measure(scene, compressed, options), Error);
  };
  Compressed bad = good;
  bad.id[3] = 1;
  expect_refusal(bad, {});
  bad = good;
  bad.id.pop_back();
  expect_refusal(bad, {});
  bad = good;
  bad.coefficients.pop_back();
  expect_refusal(bad, {});
  bad = good;
  bad.bases.clear();
  expect_refusal(bad, {});
  expect_refusal(good, {.bandwidths = {8, -1}});
  expect_refusal(good, {.strata = 1});
  Scene few = scene;
  few.masks.pop_back();
  EXPECT_THROW(measure(few, good), Error);
}

TEST(CompressionTarget, ErrorsFallToTheMeasuredOnes) {
  const Scene scene(300);
  const float amplitude = 0.6f;
  const auto bases = train(scene, amplitude, 10, 3);
  const std::vector<double> errors = compression_errors(bases, amplitude, scene.ssdfs);
  ASSERT_EQ(errors.size(), 10u);
  EXPECT_LT(errors[9], 0.7 * errors[3]);
  // Two ways to the same number: with k terms, bases cut to k and measured.
  for (const Index terms : {1, 4, 10}) {
    std::vector<PcaBasis> cut = bases;
    for (PcaBasis& basis : cut) basis.components = basis.components.leftCols(terms).eval();
    const auto measured =
        measure(scene, compress(cut, scene.ssdfs, amplitude), {.bandwidths = {128}});
    // Rounding, and vertices between two bases that are equally good to rounding.
    EXPECT_NEAR(errors[static_cast<std::size_t>(terms - 1)], measured.compression[0].relative_rms,
                1e-4);
  }
}

TEST(CompressionTarget, TakesTheFewestTermsThatMeetIt) {
  const Scene scene(300);
  const Scene held_out(60);
  RowMatrixf encoded = scene.ssdfs;
  const CompressionTarget target{.error = 0.1};
  const TargetedPca result =
      train_to_target(encoded, held_out.ssdfs, 0, target, {.terms = 20, .bases = 1});
  ASSERT_TRUE(result.met);
  ASSERT_EQ(result.bases.size(), 1u);
  EXPECT_LE(result.error, target.error);
  const std::vector<double> errors = compression_errors(
      train_clustered_pca(encoded, {.terms = 20, .bases = 1}), 0, held_out.ssdfs, target);
  const auto terms = static_cast<std::size_t>(result.bases[0].terms());
  EXPECT_EQ(result.error, errors[terms - 1]);
  for (std::size_t k = 0; k + 1 < terms; ++k) EXPECT_GT(errors[k], target.error);
}

TEST(CompressionTarget, SaysWhenItCannotBeMet) {
  const Scene scene(300);
  const TargetedPca result =
      train_to_target(scene.ssdfs, scene.ssdfs, 0, {.error = 1e-9}, {.terms = 2, .bases = 0});
  EXPECT_FALSE(result.met);
  EXPECT_EQ(result.bases.size(), 16u);
  EXPECT_EQ(result.bases[0].terms(), 2);
  EXPECT_GT(result.error, 1e-9);
}

}  // namespace
}  // namespace burnish
