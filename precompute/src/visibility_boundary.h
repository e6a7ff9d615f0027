#pragma once

#include "burnish/precompute/spherical_distance_transform.h"

namespace burnish {

/// Collects the boundary points of a mask into `places` (x + 2^16 y, in halves of a texel of the
/// mask) and `cell_begin`: a cell is a square of 8 x 8 texels with a boundary, or eight pairs of
/// texels that the map's wrap joins.
void collect_boundary(const VisibilityMask& mask, SphericalDistanceTransform::Scratch& scratch);

/// Writes 1 (visible), -1 (occluded) or 0 (as much of both) for each texel of a map of
/// `resolution`, a divisor of the mask's: what the mask has at the texel's centre.
void boundary_signs(const VisibilityMask& mask, int resolution, float* signs);

}  // namespace burnish
