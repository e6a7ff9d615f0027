#pragma once

#include <span>
#include <vector>

#include "burnish/precompute/clustered_pca.h"

namespace burnish {

/// What is asked of a compression.
struct CompressionTarget {
  double error = 0.1;     ///< relative RMS of the visible fraction, through compression alone
  float bandwidth = 128;  ///< of the isotropic lobes
  int strata = 16;        ///< of the directions: see LobeVisibilityOptions
  std::uint64_t seed = 20090101;  ///< of the directions
};

/// The error of held-out vertices with the first 1, 2, ... of the bases' terms, [terms], each
/// vertex in the basis that reconstructs it best from so many. `held_out`: SSDFs in radians,
/// [vertices][resolution^2]; the bases are of what encode_ssdf makes of such at `amplitude_rad`.
/// Same result at any number of threads. Throws Error for sizes that do not match.
std::vector<double> compression_errors(std::span<const PcaBasis> bases, float amplitude_rad,
                                       const RowMatrixf& held_out,
                                       const CompressionTarget& target = {});

/// Bases that were cut to the terms that a target needs.
struct TargetedPca {
  std::vector<PcaBasis> bases;
  double error = 0;  ///< of the held-out vertices
  bool met =
      false;  ///< whether that is what was asked; else `bases` are the best of what was tried
};

/// Trains as many terms as `target` needs, at most limits.terms. The rule: bases as limits.bases
/// says; of their first k terms the least k whose error is no more than the target's. Trained are
/// 48 terms, then twice as many while that is not enough. Where limits.bases = 0 chose fewer than
/// 16 bases and all terms are not enough, 16 bases are tried, too. `data` is encoded, `held_out` in
/// radians (compression_errors). `progress` starts anew for each training.
TargetedPca train_to_target(const RowMatrixf& data, const RowMatrixf& held_out, float amplitude_rad,
                            const CompressionTarget& target, const ClusteredPcaOptions& limits,
                            const PcaProgress& progress = {});

}  // namespace burnish
