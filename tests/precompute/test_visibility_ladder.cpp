#include <cmath>
#include <cstring>
#include <random>

#include <Eigen/SVD>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/coverage.h"
#include "burnish/precompute/visibility_ladder.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/sphere/sg_half_space.h"
#include "burnish/visibility/visibility_ladder.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 77;
using Bytes = std::vector<std::uint8_t>;

TEST(Coverage, IsTheCountOfVisibleDirections) {
  std::mt19937_64 random(kSeed);
  for (const int directions : {64, 128, 256, 512, 1024}) {
    VisibilityMask mask(directions);
    // Rows of noise among rows that are all visible or all occluded.
    for (std::size_t word = 0; word < mask.bits.size(); ++word)
      mask.bits[word] = word % 3 == 0 ? random() : (word / 8) % 2 == 0 ? 0 : ~std::uint64_t{0};
    for (const int resolution : {1, 2, 16, 32, 64}) {
      Bytes coverage(static_cast<std::size_t>(resolution) * static_cast<std::size_t>(resolution));
      measure_coverage(mask, resolution, coverage);
      const int side = directions / resolution;
      for (int texel = 0; texel < resolution * resolution; ++texel) {
        int count = 0;
        for (int i = 0; i < side * side; ++i)
          count += mask.visible(texel % resolution * side + i % side,
                                texel / resolution * side + i / side);
        const double exact = 255.0 * count / (side * side);
        ASSERT_LE(std::abs(coverage[static_cast<std::size_t>(texel)] - exact), 0.5)
            << directions << " to " << resolution << ", texel " << texel << ", seed " << kSeed;
      }
    }
  }
}

TEST(Coverage, RefusesAMapThatDoesNotDivideTheDirections) {
  Bytes coverage(64 * 64);
  EXPECT_THROW(measure_coverage(VisibilityMask(192), 64, std::span(coverage).first(63)), Error);
  EXPECT_THROW(measure_coverage(VisibilityMask(64), 128, coverage), Error);
  EXPECT_THROW(measure_coverage(VisibilityMask(64), 48, coverage), Error);
  EXPECT_THROW(measure_coverage(VisibilityMask(64), 0, coverage), Error);
}

/// Coverage of half-spaces.
Bytes half_spaces(const std::vector<Vector3d>& normals) {
  constexpr int kDirections = 256;
  const DirectionTable table(kDirections);
  Bytes coverage(normals.size() * kLadderTexels);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    VisibilityMask mask(kDirections);
    for (int texel = 0; texel < kDirections * kDirections; ++texel) {
      const int x = texel % kDirections, y = texel / kDirections;
      if (table.direction(x, y).dot(normals[i].cast<float>()) > 0) mask.set_visible(x, y);
    }
    measure_coverage(mask, kLadderCoverageResolution,
                     std::span(coverage).subspan(i * kLadderTexels, kLadderTexels));
  }
  return coverage;
}

std::vector<Vector3d> random_normals(int count, std::mt19937& random) {
  std::vector<Vector3d> normals;
  for (int i = 0; i < count; ++i) normals.push_back(test::random_direction(random));
  return normals;
}

/// Random blobs: smooth, with about as many degrees of freedom as asked for.
Bytes random_coverage(int vertices, int blobs, std::mt19937& random) {
  std::vector<Vector3d> centres = random_normals(blobs, random);
  std::uniform_real_distribution<double> share(0, 1);
  Bytes coverage;
  for (int vertex = 0; vertex < vertices; ++vertex) {
    std::vector<double> weight;
    for (int i = 0; i < blobs; ++i) weight.push_back(share(random));
    for (std::size_t texel = 0; texel < kLadderTexels; ++texel) {
      const Vector3d d = octahedral_texel_direction<double>(static_cast<int>(texel) % 64,
                                                            static_cast<int>(texel) / 64, 64);
      double sum = 0;
      for (int i = 0; i < blobs; ++i)
        sum += weight[static_cast<std::size_t>(i)] *
               std::exp(3 * (centres[static_cast<std::size_t>(i)].dot(d) - 1));
      coverage.push_back(static_cast<std::uint8_t>(255 * sum / (1 + sum)));
    }
  }
  return coverage;
}

/// Harmonics of the vertices' coverage by plain sums, [vertices][bands^2].
Eigen::MatrixXd exact_harmonics(const Bytes& coverage, int bands) {
  const auto vertices = static_cast<Eigen::Index>(coverage.size() / kLadderTexels);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(vertices, bands * bands);
  std::vector<float> y(static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands));
  for (std::size_t texel = 0; texel < kLadderTexels; ++texel) {
    eval_harmonics(bands,
                   octahedral_texel_direction<double>(static_cast<int>(texel) % 64,
                                                      static_cast<int>(texel) / 64, 64)
                       .cast<float>(),
                   y);
    for (Eigen::Index vertex = 0; vertex < vertices; ++vertex)
      for (std::size_t i = 0; i < y.size(); ++i)
        result(vertex, static_cast<Eigen::Index>(i)) +=
            4 * kPi<double> / kLadderTexels * double(y[i]) *
            coverage[static_cast<std::size_t>(vertex) * kLadderTexels + texel] / kFullCoverage;
  }
  return result;
}

std::vector<float> project(const VisibilityLadder& ladder, const Bytes& coverage) {
  std::vector<float> coefficients(coverage.size() / kLadderTexels *
                                  static_cast<std::size_t>(ladder.basis.terms));
  project_ladder(ladder, coverage, coefficients);
  return coefficients;
}

/// What the ladder makes of the vertices' harmonics.
Eigen::MatrixXd rebuilt_harmonics(const VisibilityLadder& ladder, const Bytes& coverage) {
  const std::vector<float> coefficients = project(ladder, coverage);
  const int terms = ladder.basis.terms;
  const auto harmonics = static_cast<Eigen::Index>(ladder.basis.mean.size());
  const Eigen::MatrixXf eigen =
      Eigen::Map<const RowMatrixf>(ladder.basis.eigen.data(), harmonics, terms);
  const auto vertices = static_cast<Eigen::Index>(coefficients.size()) / terms;
  const Eigen::Map<const RowMatrixf> weights(coefficients.data(), vertices, terms);
  const Eigen::Map<const Eigen::VectorXf> mean(ladder.basis.mean.data(), harmonics);
  Eigen::MatrixXf result = weights * eigen.transpose();
  result.rowwise() += mean.transpose();
  return result.cast<double>();
}

TEST(VisibilityLadder, GivesTheClosedFormOfHalfSpaces) {
  std::mt19937 random(kSeed);
  const Bytes training = half_spaces(random_normals(300, random));
  const std::vector<Vector3d> normals = random_normals(40, random);
  const Bytes others = half_spaces(normals);
  const VisibilityLadder ladder = train_ladders(training, {.terms = 169})[0];
  const std::vector<float> coefficients = project(ladder, others);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const VisibilityHarmonics visibility = reconstruct_harmonics(
        ladder.basis, &coefficients[i * static_cast<std::size_t>(ladder.basis.terms)]);
    for (const double bandwidth : {0.3, 1.0, 2.5, 4.0}) {
      const Vector3d axis = test::random_direction(random);
      const double exact = visible_fraction_hemisphere(
          2 * bandwidth, std::asin(axis.dot(normals[i])), HemisphereLevel::exact);
      // Some 200 texels are cut by the boundary, each wrong by up to an eighth where the lobe is
      // four times as dense as the sphere: 4 * sqrt(200) / 8 / 4096. Thrice that.
      EXPECT_NEAR(visible_fraction(visibility, axis.cast<float>(),
                                   lobe_bands(static_cast<float>(bandwidth))),
                  exact, 5e-3)
          << bandwidth << " seed " << kSeed;
    }
  }
}

TEST(VisibilityLadder, AllTermsReproduceTheHarmonics) {
  std::mt19937 random(kSeed);
  const Bytes coverage = random_coverage(60, 40, random);
  const VisibilityLadder ladder = train_ladders(coverage, {.terms = 99, .bands = 6})[0];
  EXPECT_EQ(ladder.basis.terms, 36);  // bands^2, of which 40 blobs span all
  EXPECT_EQ(ladder.basis.mean.size(), 36u);
  // Sums of 4096 products in float.
  EXPECT_LT(
      (rebuilt_harmonics(ladder, coverage) - exact_harmonics(coverage, 6)).cwiseAbs().maxCoeff(),
      1e-4);
}

TEST(VisibilityLadder, FewTermsAreTheBestInItsMetric) {
  std::mt19937 random(kSeed);
  constexpr int kBands = 6, kTerms = 5;
  const Bytes coverage = random_coverage(80, 30, random);
  const LadderOptions options{.terms = kTerms, .bands = kBands, .metric_bandwidth = 3};
  const VisibilityLadder ladder = train_ladders(coverage, options)[0];

  Eigen::VectorXd root(kBands * kBands);
  for (int l = 0; l < kBands; ++l)
    root.segment(l * l, 2 * l + 1).setConstant(std::sqrt(lobe_bands(3).factor[l]));
  const Eigen::MatrixXd exact = exact_harmonics(coverage, kBands);
  const Eigen::MatrixXd weighted = (exact.rowwise() - exact.colwise().mean()) * root.asDiagonal();
  const Eigen::VectorXd singular = weighted.jacobiSvd().singularValues();
  const double left = singular.tail(singular.size() - kTerms).squaredNorm();
  const Eigen::MatrixXd error = (rebuilt_harmonics(ladder, coverage) - exact) * root.asDiagonal();
  EXPECT_GT(left, 1e-3);
  // Float rounding of values of about 1, 1e-6 of each, in the sum of squares.
  EXPECT_NEAR(error.squaredNorm(), left, 1e-3 * left) << "seed " << kSeed;
}

bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool same(const VisibilityLadder& a, const VisibilityLadder& b) {
  return same(a.basis.mean, b.basis.mean) && same(a.basis.eigen, b.basis.eigen) &&
         a.projection == b.projection && a.offset == b.offset;
}

TEST(VisibilityLadder, HasTheSameBytesAtAnyNumberOfThreads) {
  std::mt19937 random(kSeed);
  const Bytes coverage = half_spaces(random_normals(300, random));
  Bytes ids(300);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<std::uint8_t>(i % 3);
  std::vector<std::vector<VisibilityLadder>> results;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(train_ladders(coverage, {.terms = 20}, ids, 3));
  }
  for (const auto& result : results)
    for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(same(result[i], results[0][i])) << i;
}

TEST(VisibilityLadder, GroupsAreTrainedApartWithEqualTerms) {
  std::mt19937 random(kSeed);
  const Bytes round = half_spaces(random_normals(60, random));
  const Bytes same_one = half_spaces(std::vector<Vector3d>(4, Vector3d::UnitX()));
  Bytes all = round;
  all.insert(all.end(), same_one.begin(), same_one.end());
  Bytes ids(64, 0);
  std::fill(ids.begin() + 60, ids.end(), std::uint8_t{2});
  const auto ladders = train_ladders(all, {.terms = 12}, ids, 3);
  ASSERT_EQ(ladders.size(), 3u);
  EXPECT_TRUE(same(ladders[0], train_ladders(round, {.terms = 12})[0]));
  EXPECT_TRUE(same(ladders[1], train_ladders(all, {.terms = 12})[0]));  // nobody's
  EXPECT_EQ(ladders[2].basis.terms, 12);
  for (const float value : ladders[2].basis.eigen) EXPECT_EQ(value, 0);
}

TEST(VisibilityLadder, OfEqualVerticesIsTheirMean) {
  const Bytes coverage = half_spaces({Vector3d(0.3, 0.4, 0.5), Vector3d(0.3, 0.4, 0.5)});
  const VisibilityLadder ladder = train_ladders(coverage, {})[0];
  EXPECT_EQ(ladder.basis.terms, 1);
  EXPECT_LT(
      (rebuilt_harmonics(ladder, coverage) - exact_harmonics(coverage, 13)).cwiseAbs().maxCoeff(),
      1e-4);
}

TEST(VisibilityLadder, RefusesWhatItCannotTrainOn) {
  const Bytes coverage(2 * kLadderTexels, 100);
  const Bytes ids = {0, 1};
  EXPECT_THROW(train_ladders(coverage, {.terms = 0}), Error);
  EXPECT_THROW(train_ladders(coverage, {.bands = 0}), Error);
  EXPECT_THROW(train_ladders(coverage, {.bands = kMaxLadderBands + 1}), Error);
  EXPECT_THROW(train_ladders(coverage, {.metric_bandwidth = 0}), Error);
  EXPECT_THROW(train_ladders(coverage, {.metric_bandwidth = std::nanf("")}), Error);
  EXPECT_THROW(train_ladders({}, {}), Error);
  EXPECT_THROW(train_ladders(std::span(coverage).first(5000), {}), Error);
  EXPECT_THROW(train_ladders(coverage, {}, ids, 1), Error);
  EXPECT_THROW(train_ladders(coverage, {}, std::span(ids).first(1), 2), Error);
  EXPECT_THROW(train_ladders(coverage, {}, {}, 2), Error);
  EXPECT_THROW(train_ladders(coverage, {}, {}, 0), Error);
  std::vector<float> coefficients(3);
  EXPECT_THROW(project_ladder(train_ladders(coverage, {})[0], coverage, coefficients), Error);
}

TEST(LadderMeasure, FindsTheErrorThatWasPutIn) {
  std::mt19937 random(kSeed);
  constexpr int kDirections = 128;
  const DirectionTable table(kDirections);
  std::vector<VisibilityMask> masks;
  Bytes coverage;
  for (const Vector3d& normal : random_normals(20, random)) {
    VisibilityMask mask(kDirections);
    for (int y = 0; y < kDirections; ++y)
      for (int x = 0; x < kDirections; ++x)
        if (table.direction(x, y).dot(normal.cast<float>()) > 0) mask.set_visible(x, y);
    Bytes own(kLadderTexels);
    measure_coverage(mask, kLadderCoverageResolution, own);
    coverage.insert(coverage.end(), own.begin(), own.end());
    masks.push_back(std::move(mask));
  }
  VisibilityLadder ladder = train_ladders(coverage, {.terms = 19})[0];
  ASSERT_EQ(ladder.basis.terms, 19);  // all that twenty vertices have
  const std::vector<float> coefficients = project(ladder, coverage);
  const float bandwidths[] = {0.5f, 2};
  const LadderSamples samples{{&ladder.basis, 1}, {}, coefficients, masks};
  // 64^2 texels in place of 128^2.
  for (const LobeError& error : measure_ladder(samples, bandwidths))
    EXPECT_LT(error.relative_rms, 2e-3) << error.bandwidth;
  // A constant of .05 too much everywhere, in parts of the half-spaces' mean square over all
  // directions. Twenty half-spaces and 64 directions leave a sampling error of some per cent of it.
  ladder.basis.mean[0] += 0.05f * std::sqrt(4 * kPi<float>);
  for (const LobeError& error : measure_ladder(samples, bandwidths)) {
    double square = 0;
    for (const auto& [sine, weight] : test::gauss_legendre(40, -1, 1))
      square += weight / 2 *
                std::pow(visible_fraction_hemisphere(2 * error.bandwidth, std::asin(sine),
                                                     HemisphereLevel::exact),
                         2);
    EXPECT_NEAR(error.relative_rms / (0.05 / std::sqrt(square)), 1, 0.06) << error.bandwidth;
  }
  EXPECT_THROW(measure_ladder({}, bandwidths), Error);
  EXPECT_THROW(measure_ladder(samples, bandwidths, 0), Error);
  EXPECT_THROW(measure_ladder({{&ladder.basis, 1}, {}, {}, masks}, bandwidths), Error);
  std::vector<VisibilityMask> mixed = masks;
  mixed.back() = VisibilityMask(64);
  EXPECT_THROW(measure_ladder({{&ladder.basis, 1}, {}, coefficients, mixed}, bandwidths), Error);
}

TEST(LadderCrossover, LiesWhereTheErrorsCross) {
  const std::vector<LobeError> ssdf = {{1, .4}, {4, .2}, {16, .1}, {64, .05}};
  const auto ladder = [](double a, double b, double c, double d) {
    return std::vector<LobeError>{{1, a}, {4, b}, {16, c}, {64, d}};
  };
  // Log-log lines from a ratio of 2 to one of 1/2: halfway, the geometric mean of 4 and 16.
  EXPECT_NEAR(find_ladder_crossover(ssdf, ladder(.01, .1, .2, .3)), 8, 1e-4);
  EXPECT_NEAR(find_ladder_crossover(ssdf, ladder(.01, .01, .1, .3)), 16, 1e-4);
  EXPECT_EQ(find_ladder_crossover(ssdf, ladder(.01, .01, .01, .01)), 64);
  EXPECT_EQ(find_ladder_crossover(ssdf, ladder(.5, .5, .5, .5)), 0);
  EXPECT_EQ(find_ladder_crossover({}, {}), 0);
  EXPECT_GT(find_ladder_crossover(ssdf, ladder(0, 0, 0, .1)), 16);
  EXPECT_THROW(find_ladder_crossover(ssdf, std::span(ssdf).first(2)), Error);
  const std::vector<LobeError> others = {{1, .4}, {5, .2}, {16, .1}, {64, .05}};
  EXPECT_THROW(find_ladder_crossover(ssdf, others), Error);
}

}  // namespace
}  // namespace burnish
