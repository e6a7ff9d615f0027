#pragma once

#include "burnish/material/varying_material.h"
#include "burnish/shading/shade.h"

namespace burnish {

/// As shade_points of shade.h, with a material for each point, one that domain_error accepts. It is
/// prepared anew, at its cost.
void shade_points(const PreparedTransfer& transfer, std::span<const ShadingPoint> points,
                  std::span<const Vector3f> outgoing, std::span<const Material> materials,
                  const Lighting& lighting, const ShadingOptions& options,
                  std::span<Rgb> radiance) noexcept;

/// As shade_vertices, with a material that varies by vertex: `variation` has entries per vertex of
/// the transfer (not of the range). Each vertex' material is prepared anew, at its cost: what
/// varies may change from call to call.
void shade_vertices(const PreparedTransfer& transfer, const Lighting& lighting,
                    const Material& base, const MaterialVariation& variation, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept;

}  // namespace burnish
