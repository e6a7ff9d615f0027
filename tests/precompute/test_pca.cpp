#include <cmath>
#include <random>
#include <vector>

#include <Eigen/SVD>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/precompute/pca.h"

namespace burnish {
namespace {

using Eigen::Index;
constexpr unsigned kSeed = 99;

// Rows with the given standard deviations along random orthogonal directions, around a mean of
// size 1: what SSDFs look like.
RowMatrixf random_data(Index rows, Index columns, const std::vector<double>& deviations) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  const auto noise = [&] { return normal(random); };
  const auto count = static_cast<Index>(deviations.size());
  const Eigen::MatrixXd any = Eigen::MatrixXd::NullaryExpr(columns, count, noise);
  const Eigen::MatrixXd directions = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ() *
                                     Eigen::MatrixXd::Identity(columns, count);
  Eigen::MatrixXd weights = Eigen::MatrixXd::NullaryExpr(rows, count, noise);
  for (Index k = 0; k < count; ++k) weights.col(k) *= deviations[static_cast<std::size_t>(k)];
  const Eigen::RowVectorXd mean = Eigen::RowVectorXd::NullaryExpr(columns, noise);
  Eigen::MatrixXd data = weights * directions.transpose();
  data.rowwise() += mean;
  return data.cast<float>();
}

std::vector<double> falling_deviations(int count, double ratio) {
  std::vector<double> deviations;
  for (int k = 0; k < count; ++k) deviations.push_back(10 * std::pow(ratio, k));
  return deviations;
}

struct DenseSvd {
  Eigen::VectorXd values;
  Eigen::MatrixXd directions;
};

DenseSvd dense_svd(const RowMatrixf& data) {
  Eigen::MatrixXd centred = data.cast<double>();
  centred.rowwise() -= centred.colwise().mean().eval();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixV()};
}

double orthonormality_error(const PcaBasis& basis) {
  const Eigen::MatrixXd e = basis.components.cast<double>();
  return (e.transpose() * e - Eigen::MatrixXd::Identity(e.cols(), e.cols())).cwiseAbs().maxCoeff();
}

TEST(Pca, MatchesDenseSvdOnFallingSpectrum) {
  const RowMatrixf data = random_data(150, 240, falling_deviations(100, 0.8));
  const DenseSvd truth = dense_svd(data);
  RowMatrixf centred = data;
  const PcaBasis basis = train_pca(centred, {.terms = 12});
  ASSERT_EQ(basis.terms(), 12);
  EXPECT_LT(orthonormality_error(basis), 1e-6);  // rounding of the components to float
  for (Index k = 0; k < 12; ++k) {
    // The 16 directions beyond the 12th, at a ratio of 0.8 a direction and eight passes, leave
    // 0.8^(16 * 8) = 4e-13: what remains is float rounding of the products, 150 x 240 terms.
    const double deviation = truth.values[k] / std::sqrt(150.0);
    EXPECT_NEAR(basis.deviations[static_cast<std::size_t>(k)] / deviation, 1, 1e-5) << k;
    EXPECT_NEAR(std::abs(basis.components.col(k).cast<double>().dot(truth.directions.col(k))), 1,
                1e-5)
        << k;
  }
}

TEST(Pca, FlatSpectrumIsWithinHalkosBound) {
  // Nothing falls off, the worst case: the directions are arbitrary, but the part of the data they
  // miss may be only little more than the best directions miss.
  const RowMatrixf data = random_data(120, 200, std::vector<double>(120, 1.0));
  const DenseSvd truth = dense_svd(data);
  RowMatrixf centred = data;
  const PcaBasis basis = train_pca(centred, {.terms = 20});
  double captured = 0;
  for (const double d : basis.deviations) captured += 120 * d * d;
  const double total = truth.values.squaredNorm(), best = truth.values.head(20).squaredNorm();
  EXPECT_LE(captured, best * (1 + 1e-5));
  EXPECT_LE(total - captured, 1.02 * (total - best));
}

TEST(Pca, AllComponentsReproduceTheData) {
  for (const auto& [rows, columns] : {std::pair<Index, Index>{40, 300}, {300, 40}}) {
    const RowMatrixf data = random_data(rows, columns, falling_deviations(40, 0.9));
    RowMatrixf centred = data;
    const PcaBasis basis = train_pca(centred, {.terms = 1000});
    EXPECT_LT(orthonormality_error(basis), 1e-6);
    const RowMatrixf weights = centred * basis.components;
    RowMatrixf rebuilt = weights * basis.components.transpose();
    rebuilt.rowwise() += basis.mean;
    // Data of size 10 pass through some 300-term sums in float: 10 * 300 * 6e-8, if all add up.
    EXPECT_LT((rebuilt - data).cwiseAbs().maxCoeff(), 2e-4f);
  }
}

TEST(Pca, DropsDirectionsTheDataDoNotHave) {
  RowMatrixf data = random_data(80, 100, {3.0, 2.0, 1.0, 0.5, 0.1});
  EXPECT_EQ(train_pca(data, {.terms = 48}).terms(), 5);
}

TEST(Pca, FewVectorsGiveFewComponents) {
  RowMatrixf data = random_data(4, 100, falling_deviations(50, 0.9));
  EXPECT_EQ(train_pca(data, {.terms = 48}).terms(), 3) << "around their mean, 4 vectors span 3";
}

TEST(Pca, EqualVectorsGiveOneZeroComponent) {
  for (const Index rows : {1, 7, 300}) {
    RowMatrixf data = random_data(1, 100, {1.0}).replicate(rows, 1);
    const Eigen::RowVectorXf row = data.row(0);
    const PcaBasis basis = train_pca(data, {});
    ASSERT_EQ(basis.terms(), 1);
    EXPECT_EQ(basis.mean, row);
    EXPECT_TRUE(basis.components.isZero(0));
    EXPECT_TRUE(data.isZero(0)) << "centred, nothing is left";
  }
}

TEST(Pca, LargestComponentIsPositive) {
  RowMatrixf data = random_data(60, 100, falling_deviations(30, 0.8));
  const PcaBasis basis = train_pca(data, {.terms = 20});
  for (Index k = 0; k < basis.terms(); ++k)
    EXPECT_EQ(basis.components.col(k).maxCoeff(), basis.components.col(k).cwiseAbs().maxCoeff());
}

TEST(Pca, SameBytesOnAnyNumberOfThreads) {
  const RowMatrixf data = random_data(700, 1200, falling_deviations(200, 0.97));
  PcaBasis bases[2];
  for (int i = 0; i < 2; ++i) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 3);
    RowMatrixf copy = data;
    bases[i] = train_pca(copy, {.terms = 24});
  }
  EXPECT_EQ(bases[0].mean, bases[1].mean);
  EXPECT_EQ(bases[0].components, bases[1].components);
}

TEST(Pca, ReportsEveryPassInOrder) {
  RowMatrixf data = random_data(20, 30, {1.0, 0.5});
  std::vector<int> seen;
  int total = 0;
  train_pca(data, {}, [&](int done, int all) {
    seen.push_back(done);
    total = all;
  });
  ASSERT_EQ(static_cast<int>(seen.size()), total + 1);
  for (int i = 0; i <= total; ++i) EXPECT_EQ(seen[static_cast<std::size_t>(i)], i);
}

}  // namespace
}  // namespace burnish
