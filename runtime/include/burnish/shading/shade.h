#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/light/light_rig.h"
#include "burnish/light/local_lights.h"
#include "burnish/light/prefiltered_environment.h"
#include "burnish/material/specular_slice.h"
#include "burnish/shading/transfer.h"
#include "burnish/sphere/half_space.h"
#include "burnish/sphere/lobe_moments.h"

namespace burnish {

/// How the cosine of the diffuse term is taken.
enum class CosineModel {
  constant,            ///< at the lobe's axis, out of the integral (xu2013asg, Eq. 29)
  horizon_normalised,  ///< unshadowed cosine integral times visible fraction over horizon fraction
};

/// Speed for accuracy. The defaults are ours; VisibilityModel::hemisphere, CosineModel::constant
/// and one tap of SpecularForm::peak are the paper's method.
struct ShadingOptions {
  VisibilityModel visibility = VisibilityModel::directional;
  CosineModel cosine = CosineModel::horizon_normalised;
  AsgIntegral integral = AsgIntegral::exact;
  int terms = 0;                  ///< PCA terms used, 1..baked; 0: all that were baked
  SpecularOptions specular = {};  ///< how materials are prepared: see prepare_material
  int environment_taps = 32;      ///< at most, along the long axis of a specular lobe, 1..64
  /// The horizon-normalised diffuse term of lobes wider than the transfer's crossover sees through
  /// the visibility ladder, where one was baked. False: through the SSDF, as the papers do.
  bool ladder = true;
  /// prepare_lights splits an environment's lobes wider than this into narrower ones
  /// (lobe_split.h), each with a boundary of its own; 0: none. Costs as many times the lobes; buys
  /// accuracy where there is no ladder (docs/lights.md, "Lobe width").
  float split_bandwidth = 0;
};

/// A lobe of light with what shading needs of its shape: prepared once per change of the lights.
struct PreparedLobe {
  AnisotropicGaussian<float> lobe;  ///< unit amplitude
  Rgb color = Rgb::Zero();          ///< radiance at the axis
  float integral = 0;               ///< of the unit-amplitude lobe
  LobeMoments<float> moments;       ///< of the normalised lobe, in its own frame
};

/// Lights ready for shading. Immutable while shading, and may be shared between threads.
struct PreparedLights {
  std::vector<PreparedLobe> lobes;
  std::vector<DirectionalLight> directionals;
  std::vector<SphereLight> spheres;
  std::vector<RectangleLight> rectangles;
};

/// Leaves out black lights. Throws std::invalid_argument for a light that domain_error
/// (lobe_domain.h, local_lights.h) objects to.
PreparedLights prepare_lights(const LightRig& rig, const ShadingOptions& options);

/// What lights a frame, in the world's frame. Without an environment the specular term sees the
/// lights' lobes instead of the map.
struct Lighting {
  const PreparedLights* lights = nullptr;               ///< never null
  const PrefilteredEnvironment* environment = nullptr;  ///< may be null
};

/// One point to shade.
struct ShadingPoint {
  Vector3f position;
  Frame<float> frame;                   ///< x tangent, z shading normal
  const SsdfBasis* basis = nullptr;     ///< null: nothing occludes but the horizon
  const float* coefficients = nullptr;  ///< [basis->terms]
  const LadderBasis* ladder = nullptr;  ///< null: none; read only where there is a basis, too
  const float* ladder_coefficients = nullptr;  ///< [ladder->terms]
  float ladder_crossover = 0;                  ///< as in Transfer
};

/// As prepare_material, of each. Throws std::invalid_argument for a material that domain_error
/// (material.h) objects to.
std::vector<PreparedMaterial> prepare_materials(std::span<const Material> materials,
                                                const ShadingOptions& options);

/// Outgoing radiance of a point toward a unit direction, W sr^-1 m^-2 up to the lights' own scale.
/// Zero where `outgoing` is below the horizon.
Rgb shade_point(const ShadingPoint& point, const Vector3f& outgoing,
                const PreparedMaterial& material, const Lighting& lighting,
                const ShadingOptions& options) noexcept;

/// The shading point of a vertex of a transfer.
ShadingPoint vertex_shading_point(const Transfer& transfer, size_t vertex) noexcept;

/// A view from below a normal's horizon, or less than kMinViewCosine above it, lifted to just above
/// it; any other view unchanged. The BRDFs have poles at the horizon, and smooth normals face away
/// at silhouettes.
inline constexpr float kMinViewCosine = 0.02f;
inline Vector3f lift_above_horizon(const Vector3f& outgoing, const Vector3f& normal) {
  const float cosine = outgoing.dot(normal);
  if (cosine >= kMinViewCosine) return outgoing;
  return (outgoing + (kMinViewCosine - cosine) * normal).normalized();
}

/// Radiance of the vertices [first, first + radiance.size()) toward `eye`. `material_id` has an
/// entry per vertex of the transfer, or is empty: then all have materials[0]. Call it from as many
/// threads as you like, on ranges that do not overlap. Vertices that face away from the eye are
/// shaded by lift_above_horizon, so that interpolation across a silhouette does not darken.
void shade_vertices(const Transfer& transfer, const Lighting& lighting,
                    std::span<const PreparedMaterial> materials,
                    std::span<const std::uint8_t> material_id, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept;

}  // namespace burnish
