#include "burnish/precompute/pca.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <tbb/parallel_for.h>

// Based on: halko2011randomized, Algorithm 4.4 (subspace iteration) on the rows' space, then a
// Rayleigh-Ritz step (Algorithm 5.1 with the small problem solved as a symmetric eigenproblem in
// double). Products are cut into blocks of fixed size, each computed by one thread, so that the
// number of threads cannot change a bit.

namespace burnish {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

constexpr Index kRowBlock = 128, kColumnBlock = 512;

template <class Body>
void for_blocks(Index size, Index block, const Body& body) {
  tbb::parallel_for(Index{0}, (size + block - 1) / block,
                    [&](Index i) { body(i * block, std::min(block, size - i * block)); });
}

Eigen::RowVectorXf subtract_mean(RowMatrixf& data) {
  Eigen::RowVectorXf mean(data.cols());
  for_blocks(data.cols(), kColumnBlock, [&](Index first, Index count) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(count);
    for (Index row = 0; row < data.rows(); ++row)
      sum += data.row(row).segment(first, count).cast<double>();
    mean.segment(first, count) = (sum / static_cast<double>(data.rows())).cast<float>();
    data.middleCols(first, count).rowwise() -= mean.segment(first, count);
  });
  return mean;
}

RowMatrixf multiply(const RowMatrixf& data, const RowMatrixf& directions) {
  RowMatrixf product(data.rows(), directions.cols());
  for_blocks(data.rows(), kRowBlock, [&](Index first, Index count) {
    product.middleRows(first, count).noalias() = data.middleRows(first, count) * directions;
  });
  return product;
}

RowMatrixf multiply_transposed(const RowMatrixf& data, const RowMatrixf& weights) {
  RowMatrixf product(data.cols(), weights.cols());
  for_blocks(data.cols(), kColumnBlock, [&](Index first, Index count) {
    product.middleRows(first, count).noalias() =
        data.middleCols(first, count).transpose() * weights;
  });
  return product;
}

// Columns of +1 and -1: as good a start as Gaussian ones, and the same with every standard library.
RowMatrixf random_start(Index rows, Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RowMatrixf start(rows, columns);
  for (Index i = 0; i < start.size(); ++i) start.data()[i] = random() >> 63 ? 1.0f : -1.0f;
  return start;
}

MatrixXd orthonormal_columns(const RowMatrixf& m) {
  const Eigen::HouseholderQR<MatrixXd> qr(m.cast<double>());
  return qr.householderQ() * MatrixXd::Identity(m.rows(), m.cols());
}

// The component of largest magnitude (the first of equals) becomes positive.
void fix_signs(MatrixXd& columns) {
  for (Index k = 0; k < columns.cols(); ++k) {
    Index largest = 0;
    columns.col(k).cwiseAbs().maxCoeff(&largest);
    if (columns(largest, k) < 0) columns.col(k) = -columns.col(k);
  }
}

// The best directions within the span of the orthonormal columns of `span`: eigenvectors of the
// data's covariance in that span, the largest first.
void rayleigh_ritz(const RowMatrixf& data, const MatrixXd& span, Index terms, PcaBasis& basis) {
  const MatrixXd inside = multiply(data, span.cast<float>()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(inside.transpose() * inside);
  const Eigen::VectorXd values = eigen.eigenvalues().reverse().cwiseMax(0.0);
  // What rounding the data to float leaves along a direction that the data do not have.
  const double noise = 4 * double(std::numeric_limits<float>::epsilon()) *
                       std::sqrt(values.sum() + static_cast<double>(data.rows()) *
                                                    basis.mean.cast<double>().squaredNorm());
  Index count = 0;
  while (count < std::min(terms, values.size()) && std::sqrt(values[count]) > noise) ++count;
  if (count == 0) {
    basis.components = RowMatrixf::Zero(data.cols(), 1);
    basis.deviations = {0.0};
    return;
  }
  MatrixXd columns = span * eigen.eigenvectors().rowwise().reverse().leftCols(count);
  fix_signs(columns);
  basis.components = columns.cast<float>();
  for (Index k = 0; k < count; ++k)
    basis.deviations.push_back(std::sqrt(values[k] / static_cast<double>(data.rows())));
}

}  // namespace

PcaBasis train_pca(RowMatrixf& data, const PcaOptions& options, const PcaProgress& progress) {
  const int passes = options.iterations + 2;
  const auto report = [&](int done) {
    if (progress) progress(done, passes);
  };
  report(0);
  PcaBasis basis;
  basis.mean = subtract_mean(data);
  const Index smaller = std::min(data.rows(), data.cols());
  const Index terms = std::min<Index>(options.terms, smaller);
  const Index directions = std::min(terms + options.oversampling, smaller);

  RowMatrixf span = random_start(data.cols(), directions, options.seed);
  for (int i = 0; i <= options.iterations; ++i) {
    const RowMatrixf image = multiply_transposed(data, multiply(data, span));
    span = orthonormal_columns(image).cast<float>();
    report(i + 1);
  }
  rayleigh_ritz(data, orthonormal_columns(span), terms, basis);
  report(passes);
  return basis;
}

PcaResidual project_pca(const PcaBasis& basis, const Eigen::Ref<const RowMatrixf>& centred,
                        std::span<float> coefficients) {
  Eigen::Map<RowMatrixf> weights(coefficients.data(), centred.rows(), basis.terms());
  weights.noalias() = centred * basis.components;
  const RowMatrixf rebuilt = weights * basis.components.transpose();
  PcaResidual residual;
  for (Index i = 0; i < centred.rows(); ++i) {
    residual.squared += (centred.row(i) - rebuilt.row(i)).squaredNorm();
    residual.wrong_signs += static_cast<std::uint64_t>(
        ((centred.row(i) + basis.mean).array() * (rebuilt.row(i) + basis.mean).array() < 0)
            .count());
  }
  return residual;
}

}  // namespace burnish
