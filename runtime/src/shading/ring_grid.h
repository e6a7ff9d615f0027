#pragma once

#include <array>
#include <span>
#include <vector>

#include "burnish/visibility/visibility_ladder.h"

/// Directions on rings of equal height, by which products of smooth functions are integrated, and
/// the spherical harmonics of functions on them.
namespace burnish {

/// Degrees of the clamped cosine that matter: it lets nothing pass of other odd degrees, and hardly
/// anything of higher ones.
inline constexpr std::array<int, 5> kCosineDegrees = {0, 1, 2, 4, 6};
inline constexpr int kCosineBands = 7;
/// Of a light, what matters to its product with a ladder and with the cosine.
inline constexpr int kLightBands = kMaxLadderBands + kCosineBands - 1;
inline constexpr int kLightHarmonics = kLightBands * kLightBands;

/// Functions of the azimuth that harmonics of so many bands have: of orders 0, 1 (cosine), 1
/// (sine), 2 (cosine), ... In that order are harmonics within a band here; the ladder's order is
/// another.
inline constexpr int azimuth_functions(int bands) { return 2 * bands - 1; }
inline constexpr int order_of(int function) { return (function + 1) / 2; }

/// All of a unit direction: [kLightHarmonics].
void eval_light_harmonics(const Vector3d& direction, std::span<float> values);

/// Harmonics are a function of the height times one of the azimuth.
struct RingGrid {
  int rings = 0, azimuths = 0;
  std::vector<float> x, y, z;      ///< [rings][azimuths]
  std::vector<float> solid_angle;  ///< of a direction, [rings]
  std::vector<float> by_height;    ///< [rings][kLightHarmonics]
  /// [azimuths][panel_width(azimuth_functions(kLightBands))], and the same transposed,
  /// [azimuth_functions(kLightBands)][panel_width(azimuths)] (dense_product.h).
  std::vector<float> by_azimuth, azimuth_rows;

  size_t directions() const { return static_cast<size_t>(rings * azimuths); }
};

/// Fine enough for lobes of bandwidth 250. Made at the first call, as the next.
const RingGrid& light_grid();

/// Of as many directions as are needed to integrate products of light, ladder and cosine exactly.
const RingGrid& product_grid();

}  // namespace burnish
