#pragma once

#include <vector>

#include "burnish/visibility/visibility_ladder.h"

/// Directions of equal solid angles by which products of smooth functions are integrated, with
/// their spherical harmonics.
namespace burnish {

inline constexpr int kGridResolution = 64;  ///< texels along an edge of the octahedral map
inline constexpr size_t kLadderDirections = size_t{kGridResolution} * kGridResolution;
inline constexpr size_t kGridHarmonics = size_t{kMaxLadderBands} * kMaxLadderBands;

struct HarmonicGrid {
  std::vector<float> x, y, z;    ///< [kLadderDirections]
  std::vector<float> harmonics;  ///< [kLadderDirections][kGridHarmonics]
  static constexpr float kSolidAngle = 4 * kPi<float> / kLadderDirections;  ///< of a direction
};

/// Made at the first call.
const HarmonicGrid& harmonic_grid();

}  // namespace burnish
