#pragma once

#include <cstdint>
#include <span>

#include "burnish/precompute/visibility_mask.h"

namespace burnish {

/// Coverage that stands for a texel all of whose directions are visible.
inline constexpr int kFullCoverage = 255;

/// The visible share of each texel of a coarser octahedral map, `coverage` [resolution^2], rows of
/// texels: 0..kFullCoverage, rounded to nearest. Texels of an equal-area map count alike, so this
/// is the share of the solid angle, too.
/// Throws Error unless `resolution` divides the mask's and is a power of two, and `coverage` is of
/// that size.
void measure_coverage(const VisibilityMask& mask, int resolution, std::span<std::uint8_t> coverage);

}  // namespace burnish
