#pragma once

#include <cstddef>
#include <vector>

#include "burnish/precompute/spherical_distance_transform.h"

namespace burnish {

/// Squares of texels that the search for the nearest points goes down through.
struct TexelTree {
  const DirectionTable& texels;
  std::size_t root_across;  ///< squares along an edge on the coarsest level; doubles with each
  const std::vector<std::vector<SphericalDistanceTransform::Square>>& levels;
};

/// Writes the angle from each texel to the nearest of the points that collect_boundary() left in
/// the scratch (at least one), with the texel's sign of scratch.signs.
void find_nearest_boundary(const TexelTree& tree, int mask_resolution,
                           SphericalDistanceTransform::Scratch& scratch, float* ssdf);

}  // namespace burnish
