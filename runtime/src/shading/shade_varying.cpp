#include "burnish/shading/shade_varying.h"

#include "shading/fill_block.h"

namespace burnish {

void shade_vertices(const PreparedTransfer& transfer, const Lighting& lighting,
                    const Material& base, const MaterialVariation& variation, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept {
  for (size_t i = 0; i < radiance.size(); ++i) {
    const size_t vertex = first + i;
    ShadingPoint point = vertex_shading_point(transfer, vertex);
    const SurfaceMaterial at = material_at(base, variation, vertex, point.frame);
    point.frame = at.frame;
    const Vector3f outgoing = toward(eye, point.position, point.frame.z);
    radiance[i] = shade_point(transfer, point, outgoing,
                              prepare_material(at.material, options.specular), lighting, options);
  }
}

}  // namespace burnish
