#pragma once

#include "burnish/shading/transfer.h"

namespace burnish {

/// A spherical signed distance function at one direction.
struct SsdfSample {
  float distance;  ///< radians, positive where visible; +-pi without any boundary
  Vector3f
      gradient;  ///< unit, tangent to the sphere, toward rising distance; zero where it has none
};

/// Bilinear lookup of an uncompressed SSDF: `texels` is [resolution^2], radians.
SsdfSample lookup_ssdf(const float* texels, int resolution, const Vector3f& direction) noexcept;

/// The same of a compressed one: mean + eigen * coefficients, from the first `terms` terms
/// (1..basis.terms).
SsdfSample lookup_ssdf(const SsdfBasis& basis, const float* coefficients, int terms,
                       const Vector3f& direction) noexcept;

}  // namespace burnish
