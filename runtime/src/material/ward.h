#pragma once

#include "material/half_vector.h"

/// Based on: ward1992, with D = exp(-2 e / (1 + h.z)), e the ellipse: Eq. 5b, which is Ward's own
/// approximation of his Gaussian of slopes.
namespace burnish::internal {

/// D(h), h.z > 0.
float eval_ward_lobe(const Material& material, const Vector3f& half);
/// All the rest of the specular part.
Rgb ward_smooth_factor(const Material& material, const Vector3f& outgoing,
                       const Vector3f& incoming);

/// A half vector by D, exactly, and its density per sr of half vectors.
/// @{
Vector3f sample_ward_half(const Material& material, float u, float v);
float pdf_ward_half(const Material& material, const Vector3f& half);
/// @}

}  // namespace burnish::internal
