#pragma once

#include <array>
#include <cmath>
#include <span>

#include "burnish/shading/transfer.h"

/// What wide lobes see. A point's visibility is kept as real spherical harmonics of low degree, in
/// which a lobe of any bandwidth is a factor for each band: the ladder has no rungs, and a lobe's
/// bandwidth is continuous (docs/maths.md, "Visibility ladder").
///
/// Harmonics are orthonormal, without the Condon-Shortley phase: band l holds first the l + 1
/// proportional to cos(m azimuth), m = 0..l, then the l proportional to sin(m azimuth), m = 1..l;
/// it starts at number l^2. Polar axis z.
namespace burnish {

/// The most bands of a ladder.
inline constexpr int kMaxLadderBands = 16;

/// Values at a unit direction of the harmonics of bands 0..bands - 1, `bands` 1..kMaxLadderBands:
/// [bands^2].
void eval_harmonics(int bands, const Vector3f& direction, std::span<float> values) noexcept;

/// The factors by which a normalised lobe exp(2 bandwidth (cos - 1)) dampens each band: ratios of
/// modified spherical Bessel functions, 1 for band 0.
struct LobeBands {
  std::array<float, kMaxLadderBands> factor = {};
  int bands = 0;  ///< from which on they are below 1e-4, or kMaxLadderBands
};
LobeBands lobe_bands(float bandwidth) noexcept;

/// A point's visibility, ready for many lobes; each band's rows padded with zeros.
struct VisibilityHarmonics {
  using Rows = std::array<std::array<float, kMaxLadderBands>, kMaxLadderBands>;
  alignas(16) Rows cosine = {}, sine = {};  ///< [band][m]
  int bands = 0;
};

/// mean + eigen * coefficients.
VisibilityHarmonics reconstruct_harmonics(const LadderBasis& basis,
                                          const float* coefficients) noexcept;

/// The fraction, 0..1, of a lobe around a unit direction that is visible.
float visible_fraction(const VisibilityHarmonics& visibility, const Vector3f& direction,
                       const LobeBands& lobe) noexcept;

}  // namespace burnish
