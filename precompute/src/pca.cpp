#include "burnish/precompute/pca.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Eigenvalues>
#include <tbb/parallel_for.h>

#include "dense_products.h"
#include "pca_subspace.h"

// Based on: halko2011randomized, Algorithm 4.4 (subspace iteration), then a Rayleigh-Ritz step
// (Algorithm 5.1 with the small problem solved as a symmetric eigenproblem in double). Bases are
// made orthonormal through their Gram matrix (stathopoulos2002svqb), which leaves the work to
// matrix products.

namespace burnish {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kColumnBlock = 512;
constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();

template <class Body>
void for_column_blocks(Index columns, const Body& body) {
  tbb::parallel_for(Index{0}, (columns + kColumnBlock - 1) / kColumnBlock, [&](Index i) {
    body(i * kColumnBlock, std::min(kColumnBlock, columns - i * kColumnBlock));
  });
}

// Columns of +1 and -1: as good a start as Gaussian ones, and the same with every standard library.
RowMatrixf random_start(Index rows, Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RowMatrixf start(rows, columns);
  for (Index i = 0; i < start.size(); ++i) start.data()[i] = random() >> 63 ? 1.0f : -1.0f;
  return start;
}

// Orthonormal columns that span those of `matrix`; fewer where these depend on each other. Twice:
// rounding in the first pass grows with the ratio of the largest to the smallest column.
RowMatrixf orthonormal_columns(RowMatrixf matrix) {
  for (int pass = 0; pass < 2 && matrix.cols() > 0; ++pass) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram_matrix(matrix));
    const Eigen::VectorXd values = eigen.eigenvalues().reverse();
    const double least = std::pow(4 * kFloatEpsilon, 2) * values[0];
    Index count = 0;
    while (count < values.size() && values[count] > least) ++count;
    const MatrixXd columns = eigen.eigenvectors().rowwise().reverse().leftCols(count) *
                             values.head(count).cwiseSqrt().cwiseInverse().asDiagonal();
    matrix = multiply({matrix}, PackedFactor(columns.cast<float>()));
  }
  return matrix;
}

// The element of largest magnitude of each column (the first of equals) becomes positive.
void fix_signs(RowMatrixf& columns) {
  for (Index k = 0; k < columns.cols(); ++k) {
    Index largest = 0;
    columns.col(k).cwiseAbs().maxCoeff(&largest);
    if (columns(largest, k) < 0) columns.col(k) = -columns.col(k);
  }
}

// The best directions within the span of orthonormal columns: eigenvectors of the data's covariance
// in that span.
PrincipalSubspace rayleigh_ritz(const CentredRows& rows, const RowMatrixf& span, Index terms) {
  const RowMatrixf inside = multiply(rows, PackedFactor(span));
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram_matrix(inside));
  const Eigen::VectorXd values = eigen.eigenvalues().reverse().cwiseMax(0.0);
  MatrixXd columns =
      eigen.eigenvectors().rowwise().reverse().leftCols(std::min(terms, values.size()));
  PrincipalSubspace result;
  for (Index k = 0; k < columns.cols(); ++k)
    result.deviations.push_back(std::sqrt(values[k] / static_cast<double>(rows.rows())));
  const PackedFactor rotation(columns.cast<float>());
  result.directions = multiply({span}, rotation);
  result.coordinates = multiply({inside}, rotation);
  return result;
}

}  // namespace

Eigen::RowVectorXf mean_row(const CentredRows& rows) {
  Eigen::RowVectorXf mean(rows.columns());
  for_column_blocks(rows.columns(), [&](Index first, Index count) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(count);
    for (Index i = 0; i < rows.rows(); ++i)
      sum += rows.data.row(rows.row(i)).segment(first, count).cast<double>();
    mean.segment(first, count) = (sum / static_cast<double>(rows.rows())).cast<float>();
  });
  return mean;
}

PrincipalSubspace find_principal_subspace(const CentredRows& rows, const PcaOptions& options,
                                          const PcaProgress& progress) {
  const int passes = options.iterations + 2;
  const auto report = [&](int done) {
    if (progress) progress(done, passes);
  };
  report(0);
  const Index smaller = std::min(rows.rows(), rows.columns());
  const Index terms = std::min<Index>(options.terms, smaller);
  const Index directions = std::min(terms + options.oversampling, smaller);
  RowMatrixf span = random_start(rows.columns(), directions, options.seed);
  for (int i = 0; i <= options.iterations; ++i) {
    const RowMatrixf image = orthonormal_columns(multiply(rows, PackedFactor(span)));
    span = orthonormal_columns(multiply_transposed(rows, PackedFactor(image)));
    report(i + 1);
  }
  PrincipalSubspace result;
  if (span.cols() > 0) result = rayleigh_ritz(rows, span, terms);
  report(passes);
  return result;
}

PcaBasis train_pca(const CentredRows& rows, const PcaOptions& options,
                   const PcaProgress& progress) {
  PcaBasis basis;
  basis.mean = Eigen::Map<const Eigen::RowVectorXf>(rows.centre.data(), rows.columns());
  PrincipalSubspace subspace = find_principal_subspace(rows, options, progress);

  // What rounding the data to float leaves along a direction that the data do not have.
  double squared = basis.mean.cast<double>().squaredNorm();
  for (const double deviation : subspace.deviations) squared += deviation * deviation;
  const double noise = 4 * kFloatEpsilon * std::sqrt(squared);
  const auto count = std::find_if(subspace.deviations.begin(), subspace.deviations.end(),
                                  [&](double deviation) { return deviation <= noise; }) -
                     subspace.deviations.begin();
  if (count == 0) {
    basis.components = RowMatrixf::Zero(rows.columns(), 1);
    basis.deviations = {0.0};
    return basis;
  }
  basis.components = subspace.directions.leftCols(count);
  fix_signs(basis.components);
  basis.deviations.assign(subspace.deviations.begin(), subspace.deviations.begin() + count);
  return basis;
}

PcaBasis train_pca(RowMatrixf& data, const PcaOptions& options, const PcaProgress& progress) {
  const Eigen::RowVectorXf mean = mean_row({data});
  PcaBasis basis =
      train_pca({data, {mean.data(), static_cast<std::size_t>(mean.size())}}, options, progress);
  for_column_blocks(data.cols(), [&](Index first, Index count) {
    data.middleCols(first, count).rowwise() -= mean.segment(first, count);
  });
  return basis;
}

}  // namespace burnish
