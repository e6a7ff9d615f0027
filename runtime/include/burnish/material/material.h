#pragma once

#include "burnish/light/rgb.h"
#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/frame.h"

namespace burnish {

enum class SpecularModel { none, ward, ashikhmin_shirley };

/// A diffuse part and one microfacet lobe: f = diffuse / pi + specular part. Every field may change
/// from frame to frame.
/// - ward: specular * exp(-2 ((h.x / alpha_x)^2 + (h.y / alpha_y)^2) / (1 + h.z))
///         / (4 pi alpha_x alpha_y sqrt(i.z o.z))                                      (ward1992,
///         Eq. 5b)
/// - ashikhmin_shirley: exponents 2 / alpha^2, Schlick Fresnel with `specular` at normal incidence
///                                                                                 (ashikhmin2000phong)
struct Material {
  Rgb diffuse = Rgb::Constant(0.5f);  ///< albedo, 0..1
  Rgb specular = Rgb::Zero();         ///< ward: scale; ashikhmin_shirley: F0; 0..1
  SpecularModel model = SpecularModel::none;
  float alpha_x = 0.3f;  ///< roughness (microfacet slope) along the tangent, 1e-4..1
  float alpha_y = 0.3f;  ///< along the bitangent, 1e-4..1

  bool has_specular() const { return model != SpecularModel::none && (specular > 0.0f).any(); }
};

/// Bounds of alpha_x and alpha_y.
inline constexpr float kMinAlpha = 1e-4f;
inline constexpr float kMaxAlpha = 1.0f;

/// Exact BRDF value, sr^-1, without the cosine; zero where either direction is below the frame's
/// horizon. Both directions in the local frame (z the normal), unit.
/// @{
Rgb eval_brdf(const Material& material, const Vector3f& outgoing, const Vector3f& incoming);
Rgb eval_specular_brdf(const Material& material, const Vector3f& outgoing,
                       const Vector3f& incoming);
/// @}

/// Importance sampling of the specular part (the half vector exactly by its distribution). `u`, `v`
/// in [0, 1). Returns an incoming direction in the local frame, possibly below the horizon (then
/// its BRDF is zero). Requires material.has_specular() and outgoing.z > 0.
Vector3f sample_specular_brdf(const Material& material, const Vector3f& outgoing, float u, float v);
/// Density, per sr, with which sample_specular_brdf returns `incoming`.
float pdf_specular_brdf(const Material& material, const Vector3f& outgoing,
                        const Vector3f& incoming);

/// D(h) as one unit-amplitude ASG over half vectors, in the local frame (xu2013asg, section 5.2).
AnisotropicGaussian<float> specular_lobe(const Material& material);
/// The smooth factor M(i, o) that multiplies D(h) (xu2013asg, Eq. 22). Directions in the local
/// frame, both above the horizon.
Rgb specular_smooth_factor(const Material& material, const Vector3f& outgoing,
                           const Vector3f& incoming);

}  // namespace burnish
