#include "burnish/precompute/visibility_ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/coverage.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/visibility_ladder.h"

// PCA of visibility in spherical harmonics. With h a vertex's harmonics, less their mean, and G the
// metric, diagonal: G^(1/2) h has the covariance G^(1/2) C G^(1/2) = V L V^T, and
//   coefficients = V^T G^(1/2) h,   h = G^(-1/2) V coefficients.
// Harmonics are sums over coverage, so that a product with coverage gives the coefficients.

namespace burnish {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Bytes = std::span<const std::uint8_t>;

constexpr Index kTexels = static_cast<Index>(kLadderTexels);
constexpr Index kRowBlock = 128;  // fixed, so that the number of threads changes nothing

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::input, "ladder", what); }

void check_options(const LadderOptions& options) {
  if (options.terms < 1) refuse(fmt::format("terms is {}, expected at least 1", options.terms));
  if (options.bands < 1 || options.bands > kMaxLadderBands)
    refuse(fmt::format("bands is {}, expected 1..{}", options.bands, kMaxLadderBands));
  if (!(options.metric_bandwidth > 0) || !std::isfinite(options.metric_bandwidth))
    refuse(fmt::format("metric_bandwidth is {}, expected a positive number",
                       options.metric_bandwidth));
}

// What turns coverage / kFullCoverage into harmonics: [texels][bands^2], the harmonics at the
// texels' centres times a texel's solid angle.
RowMatrixf harmonics_of_texels(int bands) {
  RowMatrixf result(kTexels, Index{bands} * bands);
  constexpr float kTexel_sr = 4 * kPi<float> / static_cast<float>(kTexels);
  for (Index i = 0; i < kTexels; ++i) {
    const auto texel = static_cast<int>(i);
    const Vector3f direction = octahedral_texel_direction<double>(texel % kLadderCoverageResolution,
                                                                  texel / kLadderCoverageResolution,
                                                                  kLadderCoverageResolution)
                                   .cast<float>();
    eval_harmonics(bands, direction,
                   {result.row(i).data(), static_cast<std::size_t>(result.cols())});
    result.row(i) *= kTexel_sr;
  }
  return result;
}

RowMatrixf shares(Bytes coverage) {
  using ByteMatrix = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index vertices = static_cast<Index>(coverage.size()) / kTexels;
  return Eigen::Map<const ByteMatrix>(coverage.data(), vertices, kTexels).cast<float>() /
         kFullCoverage;
}

RowMatrixf harmonics_of_vertices(Bytes coverage, const RowMatrixf& texels) {
  const Index vertices = static_cast<Index>(coverage.size()) / kTexels;
  RowMatrixf result(vertices, texels.cols());
  tbb::parallel_for(Index{0}, (vertices + kRowBlock - 1) / kRowBlock, [&](Index block) {
    const Index first = block * kRowBlock, count = std::min(kRowBlock, vertices - first);
    result.middleRows(first, count).noalias() =
        shares(coverage.subspan(static_cast<std::size_t>(first * kTexels),
                                static_cast<std::size_t>(count * kTexels))) *
        texels;
  });
  return result;
}

// Square root of the metric, harmonic by harmonic.
Eigen::VectorXd metric_root(const LadderOptions& options) {
  const LobeBands lobe = lobe_bands(options.metric_bandwidth);
  Eigen::VectorXd root(Index{options.bands} * options.bands);
  for (int l = 0; l < options.bands; ++l)
    // Bands that the metric's lobe does not see keep a weight, so that it can be divided by.
    root.segment(l * l, 2 * l + 1)
        .setConstant(std::sqrt(std::max(double(lobe.factor[static_cast<std::size_t>(l)]), 1e-4)));
  return root;
}

struct Decomposition {
  Eigen::VectorXd mean;   // [harmonics]
  MatrixXd eigenvectors;  // [harmonics][terms], the one of largest variance first
};

Decomposition decompose(const MatrixXd& harmonics, const Eigen::VectorXd& root, int terms) {
  Decomposition result;
  result.mean = harmonics.colwise().mean();
  const MatrixXd centred = (harmonics.rowwise() - result.mean.transpose()) * root.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(centred.transpose() * centred);
  const Eigen::VectorXd values = eigen.eigenvalues().reverse().cwiseMax(0.0);
  // What rounding to float leaves along a direction that the data do not have.
  const double noise =
      4 * double(std::numeric_limits<float>::epsilon()) *
      std::sqrt(values.sum() + static_cast<double>(harmonics.rows()) * result.mean.squaredNorm());
  const Index most = std::min<Index>(terms, values.size());
  Index count = 0;
  while (count < most && std::sqrt(values[count]) > noise) ++count;
  result.eigenvectors = eigen.eigenvectors().rowwise().reverse().leftCols(count);
  for (Index k = 0; k < count; ++k) {
    Index largest = 0;
    result.eigenvectors.col(k).cwiseAbs().maxCoeff(&largest);
    if (result.eigenvectors(largest, k) < 0) result.eigenvectors.col(k) *= -1;
  }
  return result;
}

// The vertices of each basis, as rows of double; all of them for a basis without any.
std::vector<MatrixXd> group_rows(const RowMatrixf& harmonics, Bytes basis_id, int bases) {
  std::vector<std::vector<Index>> rows(static_cast<std::size_t>(bases));
  for (std::size_t vertex = 0; vertex < basis_id.size(); ++vertex) {
    if (basis_id[vertex] >= bases)
      refuse(fmt::format("vertex {} has basis {}, expected one below {}", vertex, basis_id[vertex],
                         bases));
    rows[basis_id[vertex]].push_back(static_cast<Index>(vertex));
  }
  std::vector<MatrixXd> groups;
  for (const std::vector<Index>& group : rows) {
    if (group.empty())
      groups.push_back(harmonics.cast<double>());
    else
      groups.push_back(harmonics(group, Eigen::all).cast<double>());
  }
  return groups;
}

VisibilityLadder assemble(const Decomposition& decomposition, const Eigen::VectorXd& root,
                          const RowMatrixf& texels, Index terms, int bands) {
  const Index given = decomposition.eigenvectors.cols();
  MatrixXd forward = MatrixXd::Zero(root.size(), terms), back = forward;
  forward.leftCols(given) = root.asDiagonal() * decomposition.eigenvectors;
  back.leftCols(given) = root.cwiseInverse().asDiagonal() * decomposition.eigenvectors;

  VisibilityLadder ladder;
  ladder.projection = texels * forward.cast<float>();
  ladder.offset = (decomposition.mean.transpose() * forward).cast<float>();
  ladder.basis.bands = bands;
  ladder.basis.terms = static_cast<int>(terms);
  const Eigen::VectorXf mean = decomposition.mean.cast<float>();
  const RowMatrixf eigen = back.cast<float>();
  ladder.basis.mean.assign(mean.data(), mean.data() + mean.size());
  ladder.basis.eigen.assign(eigen.data(), eigen.data() + eigen.size());
  return ladder;
}

}  // namespace

std::vector<VisibilityLadder> train_ladders(Bytes coverage, const LadderOptions& options,
                                            Bytes basis_id, int bases) {
  check_options(options);
  const std::size_t vertices = coverage.size() / kLadderTexels;
  if (vertices == 0 || coverage.size() % kLadderTexels != 0)
    refuse(fmt::format("coverage has {} texels, expected {} for each of one or more vertices",
                       coverage.size(), kLadderTexels));
  if (bases < 1 || (basis_id.empty() ? bases != 1 : basis_id.size() != vertices))
    refuse(
        fmt::format("there are {} basis ids of {} bases for {} vertices, expected one a vertex, "
                    "or none of one basis",
                    basis_id.size(), bases, vertices));

  const RowMatrixf texels = harmonics_of_texels(options.bands);
  const Eigen::VectorXd root = metric_root(options);
  const std::vector<MatrixXd> groups =
      group_rows(harmonics_of_vertices(coverage, texels), basis_id, bases);
  std::vector<Decomposition> decompositions(groups.size());
  tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t i) {
    decompositions[i] = decompose(groups[i], root, options.terms);
  });
  Index terms = 1;
  for (const Decomposition& one : decompositions) terms = std::max(terms, one.eigenvectors.cols());
  std::vector<VisibilityLadder> ladders;
  for (const Decomposition& one : decompositions)
    ladders.push_back(assemble(one, root, texels, terms, options.bands));
  return ladders;
}

void project_ladder(const VisibilityLadder& ladder, Bytes coverage, std::span<float> coefficients) {
  const std::size_t vertices = coverage.size() / kLadderTexels;
  const Index terms = ladder.projection.cols();
  if (coverage.size() % kLadderTexels != 0 ||
      coefficients.size() != vertices * static_cast<std::size_t>(terms))
    refuse(
        fmt::format("coverage has {} texels and there is room for {} coefficients, expected {} "
                    "and {} a vertex",
                    coverage.size(), coefficients.size(), kLadderTexels, terms));
  Eigen::Map<RowMatrixf> result(coefficients.data(), static_cast<Index>(vertices), terms);
  result.noalias() = shares(coverage) * ladder.projection;
  result.rowwise() -= ladder.offset;
}

}  // namespace burnish
