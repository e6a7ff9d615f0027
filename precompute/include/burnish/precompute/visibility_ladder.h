#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/precompute/pca.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// Dials of the visibility ladder.
struct LadderOptions {
  int terms = 48;       ///< at least 1; fewer come back where the data do not span as many
  int resolution = 64;  ///< of coverage and of the eigenimages, 8..256, a power of two
  std::vector<float> bandwidths = {1, 2, 4, 8, 16, 32};  ///< of the levels, > 0, rising
  /// The decomposition minimises <e, G e> of the visibility's error e, G the convolution with a
  /// lobe of this bandwidth: the squared error of what lobes of about twice the bandwidth see.
  float metric_bandwidth = 8;
  int oversampling = 16;          ///< further directions that are followed and then dropped
  int iterations = 1;             ///< power iterations
  std::uint64_t seed = 20240229;  ///< of the random start
};

/// A trained ladder: what the runtime reads, and how a vertex gets its coefficients. Convolution
/// and PCA are both linear, so the coefficients are one product with the vertex's coverage.
struct VisibilityLadder {
  LadderBasis basis;
  RowMatrixf projection;      ///< [resolution^2][terms], of coverage / kFullCoverage
  Eigen::RowVectorXf offset;  ///< [terms], subtracted
};

/// Trains on the coverage (measure_coverage) of vertices, [vertices][resolution^2]: one ladder, or
/// one for each of `bases` groups of them, `basis_id` [vertices] telling which. All ladders have
/// equally many terms (a group that spans fewer has zeros for the last). A group without vertices
/// gets the ladder of all. Same bytes at any number of threads. Memory beyond the coverage: 4
/// resolution^4 bytes, and 24 resolution^2 terms for each ladder of six levels.
/// Throws Error for options out of range, sizes that do not match, no vertex, or an id >= bases.
std::vector<VisibilityLadder> train_ladders(std::span<const std::uint8_t> coverage,
                                            const LadderOptions& options,
                                            std::span<const std::uint8_t> basis_id = {},
                                            int bases = 1);

/// Coefficients of vertices, [vertices][terms], from their coverage, [vertices][resolution^2]. One
/// thread; a vertex's coefficients do not depend on the others but for the number of them: call it
/// with blocks of a fixed size. Throws Error for sizes that do not match.
void project_ladder(const VisibilityLadder& ladder, std::span<const std::uint8_t> coverage,
                    std::span<float> coefficients);

}  // namespace burnish
