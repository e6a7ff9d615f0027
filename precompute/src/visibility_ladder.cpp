#include "burnish/precompute/visibility_ladder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/coverage.h"
#include "visibility_ladder_convolution.h"

// Based on: halko2011randomized, Algorithm 4.4. The decomposition is of coverage C
// [vertices][texels], in the inner product <a, G b> of a convolution G, so that images convolved
// with the lobes of all levels never exist for all vertices at once. With U, s the left singular
// vectors and values of C G^(1/2):
//   D = C^T U / s         the coverage that goes with a unit of each coefficient (least squares)
//   coefficients = C G D  since G^(1/2) D are the right singular vectors
//   eigenimages = K D     of a level with the convolution K

namespace burnish {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Bytes = std::span<const std::uint8_t>;

constexpr Index kRowBlock = 128, kColumnBlock = 512;

void check_options(const LadderOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::input, "ladder", what);
  };
  if (options.terms < 1) refuse(fmt::format("terms is {}, expected at least 1", options.terms));
  if (options.resolution < 8 || options.resolution > 256 ||
      !std::has_single_bit(static_cast<unsigned>(options.resolution)))
    refuse(fmt::format("resolution is {}, expected a power of two in 8..256", options.resolution));
  if (options.bandwidths.empty()) refuse("has no bandwidth, expected at least one");
  float last = 0;
  for (const float bandwidth : options.bandwidths) {
    if (!(bandwidth > last) || !std::isfinite(bandwidth))
      refuse(fmt::format("bandwidth {} follows {}, expected positive, rising numbers", bandwidth,
                         last));
    last = bandwidth;
  }
  if (!(options.metric_bandwidth > 0) || !std::isfinite(options.metric_bandwidth))
    refuse(fmt::format("metric_bandwidth is {}, expected a positive number",
                       options.metric_bandwidth));
  if (options.oversampling < 0 || options.iterations < 0)
    refuse(fmt::format("oversampling is {} and iterations {}, expected none negative",
                       options.oversampling, options.iterations));
}

// The coverage of some vertices as a matrix of centred rows, of which only blocks exist at a time.
class CentredCoverage {
 public:
  CentredCoverage(Bytes coverage, std::vector<std::uint32_t> rows, Index texels)
      : coverage_(coverage), rows_(std::move(rows)), mean_(texels) {
    for_blocks(texels, kColumnBlock, [&](Index first, Index count) {
      Eigen::Array<std::uint64_t, 1, Eigen::Dynamic> sum(count);
      sum.setZero();
      for (Index row = 0; row < this->rows(); ++row)
        sum += bytes(row, first, count).cast<std::uint64_t>();
      mean_.segment(first, count) =
          (sum.cast<double>() / (kFullCoverage * static_cast<double>(rows_.size()))).cast<float>();
    });
  }

  Index rows() const { return static_cast<Index>(rows_.size()); }
  const Eigen::RowVectorXf& mean() const { return mean_; }

  RowMatrixf times(const RowMatrixf& right) const {
    RowMatrixf product(rows(), right.cols());
    for_blocks(rows(), kRowBlock, [&](Index first, Index count) {
      product.middleRows(first, count).noalias() = block(first, count, 0, mean_.size()) * right;
    });
    return product;
  }

  RowMatrixf transposed_times(const RowMatrixf& right) const {
    RowMatrixf product = RowMatrixf::Zero(mean_.size(), right.cols());
    for_blocks(mean_.size(), kColumnBlock, [&](Index column, Index columns) {
      for (Index first = 0; first < rows(); first += kRowBlock) {
        const Index count = std::min(kRowBlock, rows() - first);
        product.middleRows(column, columns).noalias() +=
            block(first, count, column, columns).transpose() * right.middleRows(first, count);
      }
    });
    return product;
  }

 private:
  template <class Body>
  static void for_blocks(Index size, Index block, const Body& body) {
    tbb::parallel_for(Index{0}, (size + block - 1) / block,
                      [&](Index i) { body(i * block, std::min(block, size - i * block)); });
  }

  Eigen::Map<const Eigen::Array<std::uint8_t, 1, Eigen::Dynamic>> bytes(Index row, Index first,
                                                                        Index count) const {
    const auto vertex = static_cast<Index>(rows_[static_cast<std::size_t>(row)]);
    return {coverage_.data() + vertex * mean_.size() + first, count};
  }

  RowMatrixf block(Index first, Index count, Index column, Index columns) const {
    RowMatrixf result(count, columns);
    for (Index i = 0; i < count; ++i)
      result.row(i) = bytes(first + i, column, columns).cast<float>().matrix() / kFullCoverage -
                      mean_.segment(column, columns);
    return result;
  }

  Bytes coverage_;
  std::vector<std::uint32_t> rows_;
  Eigen::RowVectorXf mean_;
};

// Columns of +1 and -1: as good a start as Gaussian ones, and the same with every standard library.
RowMatrixf random_start(Index rows, Index columns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RowMatrixf start(rows, columns);
  for (Index i = 0; i < start.size(); ++i) start.data()[i] = random() >> 63 ? 1.0f : -1.0f;
  return start;
}

RowMatrixf orthonormal_columns(const RowMatrixf& m) {
  const Eigen::HouseholderQR<MatrixXd> qr(m.cast<double>());
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(m.rows(), m.cols());
  return q.cast<float>();
}

// D of the comment at the top; no column where no vertex deviates from the mean.
RowMatrixf principal_coverage(const CentredCoverage& data, const SphericalConvolution& metric,
                              const LadderOptions& options) {
  const Index texels = data.mean().size(), smaller = std::min(data.rows(), texels);
  const Index terms = std::min<Index>(options.terms, smaller);
  const Index directions = std::min(terms + options.oversampling, smaller);
  RowMatrixf left = random_start(data.rows(), directions, options.seed);
  for (int i = 0; i <= options.iterations; ++i)
    left = orthonormal_columns(data.times(metric.apply(data.transposed_times(left))));

  const RowMatrixf image = data.transposed_times(left);
  const MatrixXd inner = image.cast<double>().transpose() * metric.apply(image).cast<double>();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen((inner + inner.transpose()) / 2);
  const Eigen::VectorXd values = eigen.eigenvalues().reverse().cwiseMax(0.0);
  // What rounding to float and to a byte leaves along a direction that the data do not have.
  const double noise = 4 * double(std::numeric_limits<float>::epsilon()) *
                       std::sqrt(values.sum() + static_cast<double>(data.rows()) *
                                                    data.mean().cast<double>().squaredNorm());
  Index count = 0;
  while (count < terms && std::sqrt(values[count]) > noise) ++count;
  MatrixXd columns =
      image.cast<double>() * eigen.eigenvectors().rowwise().reverse().leftCols(count);
  for (Index k = 0; k < count; ++k) {
    Index largest = 0;
    columns.col(k).cwiseAbs().maxCoeff(&largest);
    columns.col(k) *= (columns(largest, k) < 0 ? -1 : 1) / std::sqrt(values[k]);
  }
  return columns.cast<float>();
}

// What one ladder is made of: the mean coverage, D and G D.
struct Decomposition {
  Eigen::RowVectorXf mean;
  RowMatrixf principal;
  RowMatrixf projection;
};

RowMatrixf with_columns(const RowMatrixf& matrix, Index columns) {
  RowMatrixf result = RowMatrixf::Zero(matrix.rows(), columns);
  result.leftCols(matrix.cols()) = matrix;
  return result;
}

VisibilityLadder assemble(const Decomposition& decomposition,
                          std::span<const SphericalConvolution> levels,
                          const LadderOptions& options, Index terms) {
  VisibilityLadder ladder;
  ladder.projection = with_columns(decomposition.projection, terms);
  ladder.offset = decomposition.mean * ladder.projection;
  LadderBasis& basis = ladder.basis;
  basis.resolution = options.resolution;
  basis.terms = static_cast<int>(terms);
  basis.bandwidths = options.bandwidths;
  const Index texels = decomposition.mean.size();
  RowMatrixf images(texels, terms + 1);
  images << decomposition.mean.transpose(), with_columns(decomposition.principal, terms);
  for (const SphericalConvolution& level : levels) {
    const RowMatrixf convolved = level.apply(images);
    const Eigen::VectorXf mean = convolved.col(0);
    const RowMatrixf eigen = convolved.rightCols(terms);
    basis.mean.insert(basis.mean.end(), mean.data(), mean.data() + mean.size());
    basis.eigen.insert(basis.eigen.end(), eigen.data(), eigen.data() + eigen.size());
  }
  return ladder;
}

std::vector<std::vector<std::uint32_t>> group_vertices(std::size_t vertices, Bytes basis_id,
                                                       int bases) {
  std::vector<std::uint32_t> all(vertices);
  std::iota(all.begin(), all.end(), 0u);
  if (basis_id.empty()) return {all};
  std::vector<std::vector<std::uint32_t>> groups(static_cast<std::size_t>(bases));
  for (const std::uint32_t vertex : all) {
    if (basis_id[vertex] >= bases)
      throw Error(ErrorKind::input, "ladder",
                  fmt::format("vertex {} has basis {}, expected one below {}", vertex,
                              basis_id[vertex], bases));
    groups[basis_id[vertex]].push_back(vertex);
  }
  for (auto& group : groups)
    if (group.empty()) group = all;
  return groups;
}

}  // namespace

std::vector<VisibilityLadder> train_ladders(Bytes coverage, const LadderOptions& options,
                                            Bytes basis_id, int bases) {
  check_options(options);
  const Index texels = Index{options.resolution} * options.resolution;
  const std::size_t vertices = coverage.size() / static_cast<std::size_t>(texels);
  if (vertices == 0 || coverage.size() % static_cast<std::size_t>(texels) != 0)
    throw Error(ErrorKind::input, "ladder",
                fmt::format("coverage has {} texels, expected {} for each of one or more vertices",
                            coverage.size(), texels));
  if (bases < 1 || (basis_id.empty() ? bases != 1 : basis_id.size() != vertices))
    throw Error(ErrorKind::input, "ladder",
                fmt::format("there are {} basis ids of {} bases for {} vertices, expected one a "
                            "vertex, or none of one basis",
                            basis_id.size(), bases, vertices));

  std::vector<Decomposition> decompositions;
  Index terms = 1;
  {
    const SphericalConvolution metric(options.resolution, double(options.metric_bandwidth));
    for (auto& group : group_vertices(vertices, basis_id, bases)) {
      const CentredCoverage data(coverage, std::move(group), texels);
      const RowMatrixf principal = principal_coverage(data, metric, options);
      terms = std::max(terms, principal.cols());
      decompositions.push_back({data.mean(), principal, metric.apply(principal)});
    }
  }
  std::vector<SphericalConvolution> levels;
  for (const float bandwidth : options.bandwidths)
    levels.emplace_back(options.resolution, double(bandwidth));
  std::vector<VisibilityLadder> ladders;
  for (const Decomposition& decomposition : decompositions)
    ladders.push_back(assemble(decomposition, levels, options, terms));
  return ladders;
}

void project_ladder(const VisibilityLadder& ladder, Bytes coverage, std::span<float> coefficients) {
  const Index texels = ladder.projection.rows(), terms = ladder.projection.cols();
  const Index vertices = static_cast<Index>(coverage.size()) / texels;
  if (static_cast<Index>(coverage.size()) != vertices * texels ||
      static_cast<Index>(coefficients.size()) != vertices * terms)
    throw Error(ErrorKind::input, "ladder",
                fmt::format("coverage has {} texels and there is room for {} coefficients, "
                            "expected {} and {} a vertex",
                            coverage.size(), coefficients.size(), texels, terms));
  using ByteMatrix = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const ByteMatrix> bytes(coverage.data(), vertices, texels);
  const RowMatrixf share = bytes.cast<float>() / kFullCoverage;
  Eigen::Map<RowMatrixf> result(coefficients.data(), vertices, terms);
  result.noalias() = share * ladder.projection;
  result.rowwise() -= ladder.offset;
}

}  // namespace burnish
