#pragma once

#include "material/half_vector.h"

namespace burnish::internal {

/// A half vector by a mixture's lobes over the whole sphere, and its density per sr of half
/// vectors above the horizon.
/// @{
Vector3f sample_fitted_half(const FittedSpecular& fitted, float u, float v);
float pdf_fitted_half(const FittedSpecular& fitted, const Vector3f& half);
/// @}

}  // namespace burnish::internal
