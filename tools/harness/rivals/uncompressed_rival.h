#pragma once

#include "burnish/precompute/progress.h"
#include "burnish/shading/shading_options.h"
#include "harness/rivals/rival.h"

/// Ours without compression: each vertex has its own SSDF as the distance transform gave it, and,
/// if it is asked for, its own visibility in spherical harmonics, the ladder's, in place of sums of
/// a basis' terms. What remains of an error is of the method, not of the PCA.
namespace burnish {

struct UncompressedOptions {
  ShadingOptions shading = {};
  int directions = 512;  ///< as BakeOptions, 64..1024, a power of two
  int resolution = 128;  ///< of an SSDF, 16..directions, a power of two
  bool ladder = true;    ///< where shading.ladder and the scene's transfer have one
};

/// About 4 resolution^2 bytes a vertex, and 1 MB with the ladder: for subsets. Preparing its lights
/// takes milliseconds a vertex, which says nothing. Throws Cancelled when `progress` (stage
/// "distances", in vertices) says so.
Rival uncompressed_rival(const RivalScene& scene, const UncompressedOptions& options,
                         const Progress& progress = {});

/// The SSDF of each vertex of a scene, [#V][resolution^2], radians.
std::vector<float> vertex_ssdfs(const RivalScene& scene, int directions, int resolution,
                                const Progress& progress = {});

}  // namespace burnish
