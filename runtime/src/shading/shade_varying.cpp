#include "burnish/shading/shade_varying.h"

#include <algorithm>
#include <array>

#include "shading/fill_block.h"

namespace burnish {

void shade_vertices(const PreparedTransfer& transfer, const Lighting& lighting,
                    const Material& base, const MaterialVariation& variation, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept {
  std::array<ShadingPoint, kBlock> points;
  std::array<Vector3f, kBlock> outgoing;
  std::array<Material, kBlock> materials;
  for (size_t start = 0; start < radiance.size(); start += kBlock) {
    const size_t count = std::min(kBlock, radiance.size() - start);
    for (size_t i = 0; i < count; ++i) {
      const size_t vertex = first + start + i;
      points[i] = vertex_shading_point(transfer, vertex);
      SurfaceMaterial at = material_at(base, variation, vertex, points[i].frame);
      points[i].frame = at.frame;
      materials[i] = std::move(at.material);
      outgoing[i] = toward(eye, points[i].position, points[i].frame.z);
    }
    shade_points(transfer, std::span(points).first(count), std::span(outgoing).first(count),
                 std::span(materials).first(count), lighting, options,
                 radiance.subspan(start, count));
  }
}

}  // namespace burnish
