#pragma once

#include "burnish/precompute/progress.h"
#include "harness/rivals/rival.h"

/// Based on: sloan2002prt (transfer vectors and matrices), kautz2002brdf (glossy BRDFs of any kind
/// by coefficients of their slices). A vertex keeps, exact from rays: the harmonics of visibility
/// times cosine, whose product with those of the light is the irradiance; and, for glossy
/// materials, the matrix that takes the light to what arrives unblocked, in the vertex's own frame.
/// A view's slice of the BRDF, f cos, is a table of coefficients.
namespace burnish {

struct ShOptions {
  int order = 5;         ///< bands, 1..6
  bool window = false;   ///< Hann's, over the light
  bool glossy = true;    ///< transfer matrices; without, glossy materials show their diffuse part
  int directions = 128;  ///< visibility by directions^2 rays, 64..1024, a power of two
};

/// Distant light only: throws std::invalid_argument for a scene with local or directional lights,
/// or an order out of range; Cancelled when `progress` (stage "harmonics", in vertices) says so.
Rival sh_rival(const RivalScene& scene, const ShOptions& options, const Progress& progress = {});

}  // namespace burnish
