#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/precompute/pca.h"
#include "burnish/precompute/visibility_mask.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// The fraction of an isotropic lobe, exp(2 bandwidth (cos - 1)) around `direction` (unit), that a
/// mask lets through: the sum over the mask's texels. Slow; the truth that others are measured
/// against.
double exact_visible_fraction(const VisibilityMask& mask, const Vector3f& direction,
                              double bandwidth);

/// Dials of measure_lobe_visibility.
struct LobeVisibilityOptions {
  std::vector<float> bandwidths = {8, 32, 128, 512};  ///< > 0
  /// Directions: a random one in each texel of a strata x strata octahedral map, of which each
  /// vertex takes every fourth.
  int strata = 16;
  std::uint64_t seed = 20090101;  ///< of the directions
};

/// How far visibility through compressed SSDFs is from the truth. Relative RMS errors are
/// sqrt(sum (fraction - truth)^2 / sum truth^2) over all vertices and directions.
struct LobeVisibilityErrors {
  std::vector<LobeError> compression;  ///< truth: the fraction through the uncompressed SSDF
  std::vector<LobeError> whole;        ///< truth: the integral of the lobe over the mask
  double rms_rad = 0;  ///< of SSDF texels, held to +-pi/2: lobes see no difference beyond
  double wrong_sign_fraction = 0;  ///< of SSDF texels; a distance of 0 has no sign
};

/// SSDFs of vertices, compressed and not, and what they were made from.
struct CompressedSsdfs {
  std::span<const SsdfBasis> bases;
  std::span<const std::uint8_t> basis_id;  ///< [vertices]
  std::span<const float> coefficients;     ///< [vertices][terms]
  const RowMatrixf& ssdfs;                 ///< [vertices][resolution^2], radians
  std::span<const VisibilityMask> masks;   ///< [vertices], or none: no whole errors then
};

/// Visible fractions of isotropic lobes as shading computes them (half_space.h, `directional`).
/// Same result at any number of threads. Throws Error for sizes that do not match, or no vertex.
LobeVisibilityErrors measure_lobe_visibility(const CompressedSsdfs& vertices,
                                             const LobeVisibilityOptions& options = {});

}  // namespace burnish
