#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/shading/prepared_lights.h"
#include "burnish/shading/prepared_transfer.h"
#include "burnish/shading/shading_options.h"

/// The frame: radiance of points from what was prepared. No noexcept function here allocates,
/// throws, locks or starts threads; call them from as many threads as you like, on ranges of
/// radiance that do not overlap. A vertex' radiance does not depend on the range it is in. Results
/// are overwritten, finite and, of lights and materials that are not negative, >= 0. Sizes and
/// indices are the caller's to keep: they are not checked.
namespace burnish {

/// As prepare_material, of each. Throws std::invalid_argument for a material that domain_error
/// (material.h) objects to.
std::vector<PreparedMaterial> prepare_materials(std::span<const Material> materials,
                                                const ShadingOptions& options);

/// One point to shade: a vertex, or a point of a triangle, which sees the weighted mean of what its
/// corners see.
struct ShadingPoint {
  Vector3f position = Vector3f::Zero();
  Frame<float> frame;  ///< x tangent, z shading normal
  std::array<std::uint32_t, 3> vertices = {};
  std::array<float, 3> weight = {1, 0, 0};  ///< of the vertices, >= 0; they sum to 1
};

/// The shading point of a vertex.
ShadingPoint vertex_shading_point(const PreparedTransfer& transfer, size_t vertex) noexcept;

/// Radiance of points, each toward a unit direction, W sr^-1 m^-2 up to the lights' own scale: zero
/// where `outgoing` is below the horizon. The lights are prepared for this transfer. Spans of equal
/// length.
void shade_points(const PreparedTransfer& transfer, std::span<const ShadingPoint> points,
                  std::span<const Vector3f> outgoing, const PreparedMaterial& material,
                  const Lighting& lighting, const ShadingOptions& options,
                  std::span<Rgb> radiance) noexcept;

/// The same of one point. It costs as much as a vector of them.
Rgb shade_point(const PreparedTransfer& transfer, const ShadingPoint& point,
                const Vector3f& outgoing, const PreparedMaterial& material,
                const Lighting& lighting, const ShadingOptions& options) noexcept;

/// A view from below a normal's horizon, or less than kMinViewCosine above it, lifted to just above
/// it; any other view unchanged. The BRDFs have poles at the horizon, and smooth normals face away
/// at silhouettes.
inline constexpr float kMinViewCosine = 0.02f;
inline Vector3f lift_above_horizon(const Vector3f& outgoing, const Vector3f& normal) {
  const float cosine = outgoing.dot(normal);
  if (cosine >= kMinViewCosine) return outgoing;
  return (outgoing + (kMinViewCosine - cosine) * normal).normalized();
}

/// Radiance of the vertices [first, first + radiance.size()), which are vertices of the transfer,
/// toward `eye`, a place in the world. `material_id` has an entry per vertex of the transfer (not
/// of the range), an index into `materials`, or is empty: then all have materials[0]. Vertices that
/// face away from the eye are shaded by lift_above_horizon, so that interpolation across a
/// silhouette does not darken.
void shade_vertices(const PreparedTransfer& transfer, const Lighting& lighting,
                    std::span<const PreparedMaterial> materials,
                    std::span<const std::uint8_t> material_id, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept;

}  // namespace burnish
