#include <algorithm>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/coverage.h"
#include "burnish/precompute/visibility_ladder.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/visibility_ladder.h"

namespace burnish {
namespace {

using Eigen::Index;

constexpr int kTruthResolution = 128;  // at most

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::input, "ladder", what); }

// Uniform on the sphere, from the integers alone: equal with every standard library.
std::vector<Vector3f> random_directions(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const double u = uniform(), v = uniform();
    directions.push_back(octahedral_to_direction(u, v).cast<float>());
  }
  return directions;
}

// Normalised lobes around the directions, one a row, over the texels of the truth.
RowMatrixf lobe_rows(const std::vector<Vector3f>& directions, float bandwidth, int resolution) {
  Eigen::Matrix3Xf texels(3, Index{resolution} * resolution);
  for (Index i = 0; i < texels.cols(); ++i)
    texels.col(i) = octahedral_texel_direction<double>(static_cast<int>(i) % resolution,
                                                       static_cast<int>(i) / resolution, resolution)
                        .cast<float>();
  RowMatrixf rows(static_cast<Index>(directions.size()), texels.cols());
  tbb::parallel_for(Index{0}, rows.rows(), [&](Index i) {
    auto row = rows.row(i);
    const Eigen::RowVector3f axis = directions[static_cast<std::size_t>(i)].transpose();
    row = (2 * bandwidth * ((axis * texels).array() - 1)).exp();
    row /= static_cast<float>(row.cast<double>().sum()) * kFullCoverage;
  });
  return rows;
}

void check(const LadderSamples& vertices, int directions) {
  const std::size_t count = vertices.masks.size();
  if (vertices.bases.empty() || count == 0 || directions < 1)
    refuse(
        fmt::format("there are {} bases, {} vertices and {} directions to measure, expected one "
                    "or more of each",
                    vertices.bases.size(), count, directions));
  const auto terms = static_cast<std::size_t>(vertices.bases.front().terms);
  if (vertices.coefficients.size() != count * terms ||
      (vertices.bases.size() > 1 && vertices.basis_id.size() != count))
    refuse(
        fmt::format("{} coefficients and {} basis ids of {} vertices, expected {} and one a "
                    "vertex",
                    vertices.coefficients.size(), vertices.basis_id.size(), count, terms));
  if (vertices.bases.size() > 1)
    for (const std::uint8_t id : vertices.basis_id)
      if (id >= vertices.bases.size())
        refuse(fmt::format("a basis id is {}, expected one below {}", id, vertices.bases.size()));
}

struct Sums {
  double error = 0, truth = 0;
};

}  // namespace

std::vector<LobeError> measure_ladder(const LadderSamples& vertices,
                                      std::span<const float> bandwidths, int directions,
                                      std::uint64_t seed) {
  check(vertices, directions);
  const std::vector<Vector3f> axes = random_directions(directions, seed);
  const int mask_resolution = vertices.masks.front().resolution;
  for (const VisibilityMask& mask : vertices.masks)
    if (mask.resolution != mask_resolution)
      refuse(fmt::format("a mask has a resolution of {}, expected that of the first, {}",
                         mask.resolution, mask_resolution));
  const int resolution = std::min(mask_resolution, kTruthResolution);
  const Index texels = Index{resolution} * resolution;
  std::vector<RowMatrixf> lobes;
  for (const float bandwidth : bandwidths) lobes.push_back(lobe_rows(axes, bandwidth, resolution));
  const std::size_t count = vertices.masks.size();
  std::vector<Sums> sums(count * bandwidths.size());
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t vertex) {
    std::vector<std::uint8_t> coverage(static_cast<std::size_t>(texels));
    measure_coverage(vertices.masks[vertex], resolution, coverage);
    const Eigen::VectorXf share =
        Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>>(coverage.data(), texels)
            .cast<float>();
    const LadderBasis& basis =
        vertices.bases[vertices.bases.size() == 1 ? 0 : vertices.basis_id[vertex]];
    const VisibilityHarmonics visibility = reconstruct_harmonics(
        basis, vertices.coefficients.data() + vertex * static_cast<std::size_t>(basis.terms));
    for (std::size_t i = 0; i < bandwidths.size(); ++i) {
      const Eigen::VectorXf truth = lobes[i] * share;
      const LobeBands lobe = lobe_bands(bandwidths[i]);
      Sums& sum = sums[vertex * bandwidths.size() + i];
      for (std::size_t k = 0; k < axes.size(); ++k) {
        const double exact = truth[static_cast<Index>(k)];
        const double error = visible_fraction(visibility, axes[k], lobe) - exact;
        sum.error += error * error;
        sum.truth += exact * exact;
      }
    }
  });
  std::vector<LobeError> result;
  for (std::size_t i = 0; i < bandwidths.size(); ++i) {
    Sums total;
    for (std::size_t vertex = 0; vertex < count; ++vertex) {
      total.error += sums[vertex * bandwidths.size() + i].error;
      total.truth += sums[vertex * bandwidths.size() + i].truth;
    }
    // Where nothing is visible, an error counts as itself.
    result.push_back({bandwidths[i], std::sqrt(total.error / (total.truth > 0 ? total.truth : 1))});
  }
  return result;
}

float find_ladder_crossover(std::span<const LobeError> ssdf, std::span<const LobeError> ladder) {
  if (ssdf.size() != ladder.size())
    refuse(fmt::format("there are {} errors of the SSDF and {} of the ladder, expected as many",
                       ssdf.size(), ladder.size()));
  double last = 0, last_margin = 0, crossover = 0;
  for (std::size_t i = 0; i < ssdf.size(); ++i) {
    const double bandwidth = ssdf[i].bandwidth;
    if (ladder[i].bandwidth != bandwidth || !(bandwidth > last))
      refuse(fmt::format("error {} is of bandwidths {} and {}, expected equal ones that rise", i,
                         bandwidth, ladder[i].bandwidth));
    // Positive where the ladder is better. Errors of 0 count as the smallest that matters.
    constexpr double kLeast = 1e-9;
    const double margin = std::log(std::max(ssdf[i].relative_rms, kLeast)) -
                          std::log(std::max(ladder[i].relative_rms, kLeast));
    if (margin > 0) {
      crossover = bandwidth;
    } else if (last_margin > 0) {
      crossover = last * std::pow(bandwidth / last, last_margin / (last_margin - margin));
    }
    last = bandwidth;
    last_margin = margin;
  }
  return static_cast<float>(crossover);
}

}  // namespace burnish
