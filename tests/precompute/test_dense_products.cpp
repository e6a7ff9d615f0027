#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "dense_products.h"

namespace burnish {
namespace {

using Eigen::Index;
constexpr unsigned kSeed = 2008;

RowMatrixf random_matrix(Index rows, Index columns) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  return RowMatrixf::NullaryExpr(rows, columns, [&] { return uniform(random); });
}

std::span<const float> span_of(const Eigen::RowVectorXf& row) {
  return {row.data(), static_cast<std::size_t>(row.size())};
}

/// Numbers in [-1, 1], the centre half of that: a product of `depth` terms in float, each at most
/// 1.5, summed in blocks of 256 that are added up.
double rounding(Index depth) {
  return 1.5 * static_cast<double>(std::min<Index>(depth, 256) + depth / 256) * 6e-8 *
         std::sqrt(static_cast<double>(depth));
}

TEST(DenseProducts, MatchDoubleAtEverySize) {
  // Sizes around those of tiles (3, 12, 32), blocks (96, 192) and depths (256).
  for (const Index rows : {1, 3, 11, 13, 96, 97, 193, 300})
    for (const Index depth : {1, 17, 256, 257, 600})
      for (const Index columns : {1, 31, 32, 33, 70}) {
        SCOPED_TRACE(testing::Message() << rows << " x " << depth << " x " << columns);
        const RowMatrixf left = random_matrix(rows, depth), right = random_matrix(depth, columns);
        const Eigen::RowVectorXf centre = 0.5f * random_matrix(1, depth);
        const Eigen::MatrixXd centred = (left.rowwise() - centre).cast<double>();
        const RowMatrixf product = multiply({left, span_of(centre)}, PackedFactor(right));
        ASSERT_LE((product.cast<double>() - centred * right.cast<double>()).cwiseAbs().maxCoeff(),
                  rounding(depth));

        const RowMatrixf weights = random_matrix(rows, columns);
        const RowMatrixf transposed =
            multiply_transposed({left, span_of(centre)}, PackedFactor(weights));
        ASSERT_LE((transposed.cast<double>() - centred.transpose() * weights.cast<double>())
                      .cwiseAbs()
                      .maxCoeff(),
                  rounding(rows));
      }
}

TEST(DenseProducts, ChosenRowsAreTheRowsOfACopy) {
  const RowMatrixf left = random_matrix(500, 270), right = random_matrix(270, 40);
  const Eigen::RowVectorXf centre = random_matrix(1, 270);
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 1; i < 500; i += 3) chosen.push_back(i);
  RowMatrixf copy(static_cast<Index>(chosen.size()), 270);
  for (std::size_t i = 0; i < chosen.size(); ++i)
    copy.row(static_cast<Index>(i)) = left.row(chosen[i]);
  EXPECT_EQ(multiply({left, span_of(centre), chosen}, PackedFactor(right)),
            multiply({copy, span_of(centre)}, PackedFactor(right)));
  const PackedFactor weights(random_matrix(copy.rows(), 35));
  EXPECT_EQ(multiply_transposed({left, span_of(centre), chosen}, weights),
            multiply_transposed({copy, span_of(centre)}, weights));
}

TEST(DenseProducts, SquaredNormsAreThoseOfCentredRows) {
  const RowMatrixf left = random_matrix(130, 1000);
  const Eigen::RowVectorXf centre = 0.5f * random_matrix(1, 1000);
  RowMatrixf product(130, 5);
  std::vector<double> squared(130, -1);
  multiply_here(left, span_of(centre), PackedFactor(random_matrix(1000, 5)), product, squared);
  for (Index i = 0; i < 130; ++i) {
    const double truth = (left.row(i) - centre).cast<double>().squaredNorm();
    EXPECT_NEAR(squared[static_cast<std::size_t>(i)] / truth, 1, 1e-6);  // float sums of 256
  }
}

TEST(DenseProducts, SameBytesOnAnyNumberOfThreads) {
  const RowMatrixf left = random_matrix(700, 900);
  const PackedFactor right(random_matrix(900, 50)), weights(random_matrix(700, 50));
  const RowMatrixf product = multiply({left}, right);
  const RowMatrixf transposed = multiply_transposed({left}, weights);
  const Eigen::MatrixXd gram = gram_matrix(left.leftCols(60));
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(multiply({left}, right), product);
    EXPECT_EQ(multiply_transposed({left}, weights), transposed);
    EXPECT_EQ(gram_matrix(left.leftCols(60)), gram);
  }
}

TEST(DenseProducts, GramMatrixMatchesItsDefinition) {
  const RowMatrixf matrix = random_matrix(2500, 37);
  const Eigen::MatrixXd truth = matrix.cast<double>().transpose() * matrix.cast<double>();
  EXPECT_LE((gram_matrix(matrix) - truth).cwiseAbs().maxCoeff(), 1e-11);  // 2500 sums in double
}

}  // namespace
}  // namespace burnish
