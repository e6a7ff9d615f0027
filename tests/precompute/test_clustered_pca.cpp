#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/clustered_pca.h"

namespace burnish {
namespace {

using Eigen::Index;
constexpr unsigned kSeed = 20030701;

/// Rows in `groups` affine subspaces of dimension `rank`, far from each other; row i in group
/// i mod groups.
RowMatrixf affine_groups(Index rows, Index columns, Index groups, Index rank, double distance) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const auto noise = [&] { return normal(random); };
  std::vector<Eigen::RowVectorXd> means;
  std::vector<Eigen::MatrixXd> spans;
  for (Index g = 0; g < groups; ++g) {
    means.push_back(distance * Eigen::RowVectorXd::NullaryExpr(columns, noise));
    spans.push_back(Eigen::MatrixXd::NullaryExpr(rank, columns, noise));
  }
  RowMatrixf data(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    const auto g = static_cast<std::size_t>(i % groups);
    const Eigen::RowVectorXd weights = Eigen::RowVectorXd::NullaryExpr(rank, noise);
    data.row(i) = (means[g] + weights * spans[g]).cast<float>();
  }
  return data;
}

struct Projected {
  std::vector<float> coefficients;
  std::vector<std::uint8_t> id;
  std::vector<double> squared;
};

Projected project(const std::vector<PcaBasis>& bases, const RowMatrixf& rows) {
  const ClusteredProjector projector(bases);
  const auto count = static_cast<std::size_t>(rows.rows());
  Projected result{std::vector<float>(count * static_cast<std::size_t>(projector.terms())),
                   std::vector<std::uint8_t>(count), std::vector<double>(count)};
  ClusteredProjector::Scratch scratch;
  projector.project(rows, result.coefficients, result.id, result.squared, scratch);
  return result;
}

/// Squared distance of a row from its best reconstruction in a basis, the slow way.
double brute_force_residual(const PcaBasis& basis, const Eigen::RowVectorXf& row) {
  const Eigen::RowVectorXd centred = (row - basis.mean).cast<double>();
  const Eigen::MatrixXd components = basis.components.cast<double>();
  return (centred - centred * components * components.transpose()).squaredNorm();
}

TEST(ClusteredPca, RecoversSeparateLowRankGroups) {
  const RowMatrixf data = affine_groups(600, 300, 4, 5, 3);
  const auto bases = train_clustered_pca(data, {.terms = 5, .bases = 4});
  ASSERT_EQ(bases.size(), 4u);
  const Projected result = project(bases, data);
  std::set<std::uint8_t> ids;
  for (Index i = 0; i < data.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    EXPECT_EQ(result.id[row], result.id[row % 4]);
    ids.insert(result.id[row]);
    // Rounding: a squared distance of 300 * (1 + 3^2 + 5), to 1e-6.
    EXPECT_NEAR(result.squared[row], 0, 300 * 15 * 1e-6);
    EXPECT_LT(brute_force_residual(bases[result.id[row]], data.row(i)), 1e-6);
  }
  EXPECT_EQ(ids.size(), 4u);
}

TEST(ClusteredPca, BasesAreOrthonormalAndAroundTheMeanOfTheirRows) {
  const RowMatrixf data = affine_groups(900, 200, 3, 20, 1);
  const auto bases = train_clustered_pca(data, {.terms = 12, .bases = 3});
  const Projected result = project(bases, data);
  for (std::size_t b = 0; b < bases.size(); ++b) {
    const Eigen::MatrixXd e = bases[b].components.cast<double>();
    EXPECT_LT((e.transpose() * e - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-6);
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(200);
    int count = 0;
    for (Index i = 0; i < data.rows(); ++i)
      if (result.id[static_cast<std::size_t>(i)] == b) {
        mean += data.row(i).cast<double>();
        ++count;
      }
    // These groups are far apart, so that training had assigned each row as projection does.
    EXPECT_LT((mean / count - bases[b].mean.cast<double>()).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(ClusteredPca, FewerTermsAreTheFirstOfMore) {
  const RowMatrixf data = affine_groups(800, 150, 3, 25, 1);
  const auto many = train_clustered_pca(data, {.terms = 20, .bases = 3});
  std::vector<PcaBasis> few = many;
  for (PcaBasis& basis : few) basis.components = basis.components.leftCols(8).eval();
  const Projected a = project(many, data), b = project(few, data);
  for (std::size_t i = 0; i < a.id.size(); ++i) {
    if (a.id[i] != b.id[i]) continue;
    for (std::size_t k = 0; k < 8; ++k)
      EXPECT_NEAR(a.coefficients[i * 20 + k], b.coefficients[i * 8 + k], 1e-5);  // float rounding
    EXPECT_GE(b.squared[i], a.squared[i]);
  }
  // Each group's directions are ordered by how much they hold.
  for (const PcaBasis& basis : many)
    for (std::size_t k = 1; k < 20; ++k) EXPECT_LE(basis.deviations[k], basis.deviations[k - 1]);
}

TEST(ClusteredPca, AssignmentAndResidualMatchBruteForce) {
  // Overlapping groups of more dimensions than terms: residuals are near each other.
  const RowMatrixf data = affine_groups(700, 120, 6, 15, 0.2);
  const auto bases = train_clustered_pca(data, {.terms = 6, .bases = 5});
  ASSERT_EQ(bases.size(), 5u);
  const RowMatrixf others = affine_groups(90, 120, 3, 40, 0.3);
  const Projected result = project(bases, others);
  for (Index i = 0; i < others.rows(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const PcaBasis& basis : bases)
      least = std::min(least, brute_force_residual(basis, others.row(i)));
    const auto row = static_cast<std::size_t>(i);
    const double own = brute_force_residual(bases[result.id[row]], others.row(i));
    const double rounding = 1e-6 * static_cast<double>(others.row(i).squaredNorm());
    EXPECT_NEAR(result.squared[row], own, rounding);
    EXPECT_LE(own, least + 2 * rounding);
    const PcaBasis& basis = bases[result.id[row]];
    const Eigen::RowVectorXd truth =
        (others.row(i) - basis.mean).cast<double>() * basis.components.cast<double>();
    for (Index k = 0; k < 6; ++k)
      EXPECT_NEAR(result.coefficients[row * 6 + static_cast<std::size_t>(k)], truth[k], 1e-4);
  }
}

TEST(ClusteredPca, TiesGoToTheFirst) {
  const RowMatrixf data = affine_groups(200, 60, 1, 10, 1);
  RowMatrixf centred = data;
  const PcaBasis basis = train_pca(centred, {.terms = 7});
  const Projected result = project({basis, basis, basis}, data);
  for (const std::uint8_t id : result.id) EXPECT_EQ(id, 0);
}

TEST(ClusteredPca, RowsDoNotDependOnTheirBlock) {
  const RowMatrixf data = affine_groups(211, 333, 3, 10, 1);
  const auto bases = train_clustered_pca(data, {.terms = 9, .bases = 3});
  const Projected all = project(bases, data);
  for (const Index block : {1, 7, 32, 100})
    for (Index first = 0; first < data.rows(); first += block) {
      const Index size = std::min(block, data.rows() - first);
      const Projected part = project(bases, data.middleRows(first, size));
      for (Index i = 0; i < size; ++i) {
        const auto own = static_cast<std::size_t>(i), row = static_cast<std::size_t>(first + i);
        ASSERT_EQ(part.id[own], all.id[row]);
        ASSERT_EQ(part.squared[own], all.squared[row]);
        for (std::size_t k = 0; k < 9; ++k)
          ASSERT_EQ(part.coefficients[own * 9 + k], all.coefficients[row * 9 + k]);
      }
    }
}

TEST(ClusteredPca, MoreBasesReconstructHeldOutRowsBetter) {
  const RowMatrixf all = affine_groups(2400, 200, 8, 12, 0.5);
  const RowMatrixf data = all.topRows(2000), held_out = all.bottomRows(400);
  double last = std::numeric_limits<double>::infinity();
  for (const int bases : {1, 2, 4, 8}) {
    double sum = 0;
    const auto trained = train_clustered_pca(data, {.terms = 10, .bases = bases});
    for (const double squared : project(trained, held_out).squared) sum += squared;
    EXPECT_LT(sum, last) << bases;
    last = sum;
  }
}

TEST(ClusteredPca, AutoFindsAsManyBasesAsThereAreGroups) {
  EXPECT_EQ(train_clustered_pca(affine_groups(1600, 150, 4, 6, 2), {.terms = 6, .bases = 0}).size(),
            4u);
  EXPECT_EQ(train_clustered_pca(affine_groups(1600, 150, 1, 6, 2), {.terms = 6, .bases = 0}).size(),
            1u);
}

TEST(ClusteredPca, AutoStopsWhereABasisMoreGainsLittle) {
  // Two groups, apart along one direction by 2 d, with noise of variance n in all: a basis of its
  // own saves each group d^2 of the residual d^2 + 149 n, 5 % of its rms; with 2 d = 8 noise it is
  // found.
  std::mt19937 random(kSeed);
  std::normal_distribution<float> noise;
  RowMatrixf data = RowMatrixf::NullaryExpr(1600, 150, [&] { return noise(random); });
  for (Index i = 0; i < data.rows(); ++i) {
    data(i, 1) += i % 2 ? 4.0f : -4.0f;
    data(i, 0) += 6 * noise(random);  // what the only term is for
  }
  EXPECT_EQ(train_clustered_pca(data, {.terms = 1, .bases = 0}).size(), 1u);
  double squared[2];
  for (int k = 0; k < 2; ++k) {
    const auto bases = train_clustered_pca(data, {.terms = 1, .bases = k + 1});
    const std::vector<double> residuals = project(bases, data).squared;
    squared[k] = std::accumulate(residuals.begin(), residuals.end(), 0.0);
  }
  EXPECT_LT(squared[1], 0.95 * squared[0]);  // so there was something to decline
}

TEST(ClusteredPca, AFewOddRowsGetNoBasis) {
  RowMatrixf data = affine_groups(400, 80, 4, 12, 1);
  const RowMatrixf odd = affine_groups(3, 80, 3, 1, 50);  // the first that a start spreads to
  data.topRows(3) = odd;
  const auto bases = train_clustered_pca(data, {.terms = 6, .bases = 6});
  std::vector<int> rows(bases.size());
  for (const std::uint8_t id : project(bases, data).id) ++rows[id];
  for (const int count : rows) EXPECT_GT(count, 6);
}

TEST(ClusteredPca, SameBytesOnAnyNumberOfThreads) {
  const RowMatrixf data = affine_groups(1500, 400, 5, 30, 0.5);
  std::vector<PcaBasis> first;
  Projected first_projected;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto bases = train_clustered_pca(data, {.terms = 16, .bases = 4});
    const Projected projected = project(bases, data);
    if (threads == 1) {
      first = bases;
      first_projected = projected;
      continue;
    }
    ASSERT_EQ(bases.size(), first.size());
    for (std::size_t b = 0; b < bases.size(); ++b) {
      EXPECT_EQ(bases[b].mean, first[b].mean);
      EXPECT_EQ(bases[b].components, first[b].components);
      EXPECT_EQ(bases[b].deviations, first[b].deviations);
    }
    EXPECT_EQ(projected.id, first_projected.id);
    EXPECT_EQ(projected.coefficients, first_projected.coefficients);
    EXPECT_EQ(projected.squared, first_projected.squared);
  }
}

TEST(ClusteredPca, DegenerateDataGiveFiniteBases) {
  const RowMatrixf random = affine_groups(40, 100, 2, 3, 1);
  std::vector<RowMatrixf> cases = {
      random.topRows(1),                    // one row
      random.topRows(2),                    // fewer rows than terms
      random,                               // too few rows for the bases asked for
      random.topRows(1).replicate(500, 1),  // all rows equal
      random.topRows(3).replicate(300, 1),  // fewer distinct rows than bases
      RowMatrixf::Zero(500, 100),
  };
  for (std::size_t c = 0; c < cases.size(); ++c) {
    SCOPED_TRACE(c);
    for (const int wanted : {0, 1, 5, 256}) {
      const auto bases = train_clustered_pca(cases[c], {.terms = 20, .bases = wanted});
      ASSERT_GE(bases.size(), 1u);
      ASSERT_LE(bases.size(), std::max<std::size_t>(1, std::size_t(cases[c].rows()) / 40));
      for (const PcaBasis& basis : bases) {
        EXPECT_TRUE(basis.mean.allFinite() && basis.components.allFinite());
        EXPECT_EQ(basis.terms(), bases[0].terms());
        EXPECT_EQ(basis.deviations.size(), static_cast<std::size_t>(basis.terms()));
      }
      const Projected result = project(bases, cases[c]);
      for (std::size_t i = 0; i < result.id.size(); ++i) {
        const auto row = cases[c].row(static_cast<Index>(i));
        // The data have no more dimensions than a basis has terms.
        EXPECT_LE(result.squared[i], 2e-6 * double(row.cast<double>().squaredNorm()));
      }
    }
  }
}

TEST(ClusteredPca, ScaleChangesNothing) {
  const RowMatrixf data = affine_groups(900, 100, 4, 9, 1);
  const auto truth = train_clustered_pca(data, {.terms = 12, .bases = 4});
  const Projected projected = project(truth, data);
  for (const float scale : {0x1p-20f, 0x1p20f}) {  // powers of two: no rounding of their own
    SCOPED_TRACE(scale);
    const RowMatrixf scaled = scale * data;
    const auto bases = train_clustered_pca(scaled, {.terms = 12, .bases = 4});
    ASSERT_EQ(bases.size(), truth.size());
    for (std::size_t b = 0; b < bases.size(); ++b) {
      EXPECT_EQ(bases[b].mean, scale * truth[b].mean);
      EXPECT_EQ(bases[b].components, truth[b].components);
    }
    EXPECT_EQ(project(bases, scaled).id, projected.id);
  }
}

TEST(ClusteredPca, RefusesOptionsOutOfRange) {
  const RowMatrixf data = affine_groups(20, 10, 1, 3, 1);
  EXPECT_THROW(train_clustered_pca(data, {.terms = 0}), Error);
  EXPECT_THROW(train_clustered_pca(data, {.bases = -1}), Error);
  EXPECT_THROW(train_clustered_pca(data, {.bases = 257}), Error);
  EXPECT_THROW(train_clustered_pca(data, {.restarts = 0}), Error);
  EXPECT_THROW(train_clustered_pca(RowMatrixf(0, 10), {}), Error);
  EXPECT_THROW(ClusteredProjector({}), Error);
  std::vector<PcaBasis> unequal = train_clustered_pca(data, {.terms = 2, .bases = 1});
  unequal.push_back(train_clustered_pca(data, {.terms = 3, .bases = 1})[0]);
  EXPECT_THROW(ClusteredProjector{unequal}, Error);
}

TEST(ClusteredPca, ReportsProgressInOrder) {
  const RowMatrixf data = affine_groups(600, 80, 3, 8, 1);
  for (const int bases : {1, 3}) {
    int last = -1, all = 0;
    train_clustered_pca(data, {.terms = 8, .bases = bases}, [&](int done, int total) {
      EXPECT_GT(done, last);
      last = done;
      all = total;
    });
    EXPECT_EQ(last, all);
  }
}

}  // namespace
}  // namespace burnish
