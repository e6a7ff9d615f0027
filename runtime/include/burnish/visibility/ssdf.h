#pragma once

#include <span>

#include "burnish/shading/transfer.h"

namespace burnish {

/// Turns distances, radians in [-pi, pi], into what a basis of this amplitude compresses (see
/// SsdfBasis::amplitude_rad): tanh(distance / amplitude_rad), to 2e-7; nothing changes at 0. A lobe
/// is nearly all visible or hidden where the boundary is far: what is far need not be exact.
void encode_ssdf(std::span<float> distances, float amplitude_rad) noexcept;

/// The distance, within [-pi, pi] (for an amplitude > 0), that a value of encode_ssdf or one near
/// it stands for. At distance d it is exact to 2e-7 cosh^2(d / amplitude_rad) amplitude_rad.
float decode_ssdf(float value, float amplitude_rad) noexcept;

/// A spherical signed distance function at one direction.
struct SsdfSample {
  float distance;  ///< radians, positive where visible; +-pi without any boundary
  Vector3f
      gradient;  ///< unit, tangent to the sphere, toward rising distance; zero where it has none
};

/// Bilinear lookup of an uncompressed SSDF: `texels` is [resolution^2], radians.
SsdfSample lookup_ssdf(const float* texels, int resolution, const Vector3f& direction) noexcept;

/// The same of a compressed one: mean + eigen * coefficients, from the first `terms` terms
/// (1..basis.terms), decoded after the interpolation.
SsdfSample lookup_ssdf(const SsdfBasis& basis, const float* coefficients, int terms,
                       const Vector3f& direction) noexcept;

}  // namespace burnish
