#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/precompute/pca.h"
#include "burnish/precompute/visibility_mask.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// Dials of the visibility ladder.
struct LadderOptions {
  int terms = 48;  ///< at least 1; fewer come back where the data do not span as many
  int bands = 13;  ///< of spherical harmonics, 1..kMaxLadderBands
  /// The decomposition minimises <e, G e> of the visibility's error e, G the convolution with a
  /// lobe of this bandwidth: the squared error of what lobes of about twice the bandwidth see.
  float metric_bandwidth = 8;
};

/// Texels along an edge of the coverage maps that the ladder is made from.
inline constexpr int kLadderCoverageResolution = 64;
inline constexpr std::size_t kLadderTexels =
    std::size_t{kLadderCoverageResolution} * kLadderCoverageResolution;

/// A trained ladder: what the runtime reads, and how a vertex gets its coefficients. Harmonics and
/// PCA are both linear, so the coefficients are one product with the vertex's coverage.
struct VisibilityLadder {
  LadderBasis basis;
  RowMatrixf projection;      ///< [kLadderTexels][terms], of coverage / kFullCoverage
  Eigen::RowVectorXf offset;  ///< [terms], subtracted
};

/// Trains on the coverage (measure_coverage) of vertices, [vertices][kLadderTexels]: one ladder, or
/// one for each of `bases` groups of them, `basis_id` [vertices] telling which. All ladders have
/// equally many terms (a group that spans fewer has zeros for the last). A group without vertices
/// gets the ladder of all. Same bytes at any number of threads. Memory beyond the coverage: 4
/// bands^2 bytes a vertex, and as much again in double for the largest group. Throws Error for
/// options out of range, sizes that do not match, no vertex, or an id >= bases.
std::vector<VisibilityLadder> train_ladders(std::span<const std::uint8_t> coverage,
                                            const LadderOptions& options,
                                            std::span<const std::uint8_t> basis_id = {},
                                            int bases = 1);

/// Coefficients of vertices, [vertices][terms], from their coverage, [vertices][kLadderTexels]. One
/// thread. The last bits of a vertex's coefficients may depend on how many vertices there are: call
/// it with blocks of a fixed size. Throws Error for sizes that do not match.
void project_ladder(const VisibilityLadder& ladder, std::span<const std::uint8_t> coverage,
                    std::span<float> coefficients);

/// Vertices whose ladder is measured.
struct LadderSamples {
  std::span<const LadderBasis> bases;      ///< one, or as many as there are ids
  std::span<const std::uint8_t> basis_id;  ///< [vertices]; not read with one basis
  std::span<const float> coefficients;     ///< [vertices][terms]
  std::span<const VisibilityMask> masks;   ///< [vertices]: what is true
};

/// Relative RMS errors, sqrt(sum (fraction - truth)^2 / sum truth^2), of the visible fraction of
/// isotropic lobes of each bandwidth (>= 0), over all vertices and `directions` random directions,
/// the same for all vertices. Truth: the lobe's sum over the mask, taken in at most 128^2 texels
/// (.1 % off at bandwidth 32). Same result at any number of threads. Throws Error for sizes that do
/// not match, no vertex, no direction or masks of different resolutions.
std::vector<LobeError> measure_ladder(const LadderSamples& vertices,
                                      std::span<const float> bandwidths, int directions = 64,
                                      std::uint64_t seed = 20160229);

/// The bandwidth at which the ladder's error overtakes the SSDF's: between the last bandwidth up to
/// which the ladder errs less and the next, where their lines in log-log cross; the largest one
/// given where the ladder is better throughout, 0 where it is nowhere. The errors are of the same
/// bandwidths, rising, in both; throws Error where they are not.
float find_ladder_crossover(std::span<const LobeError> ssdf, std::span<const LobeError> ladder);

}  // namespace burnish
