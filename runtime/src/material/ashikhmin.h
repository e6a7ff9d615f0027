#pragma once

#include "material/half_vector.h"

/// Based on: ashikhmin2000phong, with exponents n = 2 / alpha^2: near its axis the lobe is then
/// Ward's of the same alpha.
namespace burnish::internal {

/// sqrt((n_x + 1) (n_y + 1))
float ashikhmin_normalisation(const Material& material);
/// (h.z)^((n_x h.x^2 + n_y h.y^2) / (1 - h.z^2)), h.z > 0.
float eval_ashikhmin_lobe(const Material& material, const Vector3f& half);
/// All the rest of the specular part.
Rgb ashikhmin_smooth_factor(const Material& material, const Vector3f& outgoing,
                            const Vector3f& incoming, float cos_difference);

/// A half vector by D, exactly, and its density per sr of half vectors.
/// @{
Vector3f sample_ashikhmin_half(const Material& material, float u, float v);
float pdf_ashikhmin_half(const Material& material, const Vector3f& half);
/// @}

}  // namespace burnish::internal
