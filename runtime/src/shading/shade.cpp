#include "burnish/shading/shade.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "burnish/shading/shade_varying.h"
#include "shading/fill_block.h"
#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/shade.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shading/frame-inl.h"
#include "shading/vertex_block-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

void shade_block_of_floats(const PreparedTransfer& transfer, const PreparedMaterial& material,
                           const Lighting& lighting, const ShadingOptions& options,
                           ShadingBlock<float>& block, BlockRgb<float>& radiance) {
  shade_block(hn::ScalableTag<float>(), transfer, SharedMaterial{material}, lighting, options,
              block, radiance);
}

void shade_varied_block(const PreparedTransfer& transfer, std::span<const Material> materials,
                        const Lighting& lighting, const ShadingOptions& options,
                        ShadingBlock<float>& block, BlockRgb<float>& radiance) {
  shade_block(hn::ScalableTag<float>(), transfer, OwnMaterials{materials, options.specular},
              lighting, options, block, radiance);
}

void shade_vertex_block(const PreparedTransfer& transfer, const PreparedMaterial& material,
                        const Lighting& lighting, const ShadingOptions& options,
                        const Vector3f& eye, ShadingBlock<float>& block,
                        BlockRgb<float>& radiance) {
  const hn::ScalableTag<float> d;
  pad_block(block);
  find_vertex_views(d, eye, block);
  shade_block(d, transfer, SharedMaterial{material}, lighting, options, block, radiance);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {
namespace {

HWY_EXPORT(shade_block_of_floats);
HWY_EXPORT(shade_varied_block);
HWY_EXPORT(shade_vertex_block);

Rgb rgb_of(const BlockRgb<float>& rgb, size_t i) { return {rgb[0][i], rgb[1][i], rgb[2][i]}; }

/// A normal that is none is the z axis: a vertex without triangles may have it.
Vector3f valid_normal(const Vector3f& normal) {
  const float square = normal.squaredNorm();
  if (!(square > 1e-30f) || !std::isfinite(square)) return Vector3f::UnitZ();
  return std::abs(square - 1) < 1e-5f ? normal : Vector3f(normal / std::sqrt(square));
}

constexpr size_t kTogether = 16 * kBlock;  ///< vertices that are grouped

/// Stable, in a pass over the indices, of which there are at most kTogether.
template <class Key>
void sort_by(std::span<size_t> index, const Key& key) {
  std::array<std::uint16_t, 257> start = {};
  for (const size_t i : index) ++start[key(i) + 1u];
  for (size_t k = 1; k < start.size(); ++k) start[k] = start[k] + start[k - 1];
  std::array<size_t, kTogether> sorted;
  for (const size_t i : index) sorted[start[key(i)]++] = i;
  std::copy_n(sorted.begin(), index.size(), index.begin());
}

void fetch_row(const PreparedTransfer& transfer, size_t vertex, Fetcher& fetcher) {
  const size_t size = transfer.row_size();
  if (size == 0) return;
  if (transfer.format == RowFormat::float16)
    fetcher.add(transfer.rows16.data() + vertex * size, size * sizeof(std::uint16_t));
  else
    fetcher.add(transfer.rows32.data() + vertex * size, size * sizeof(float));
}

/// Shades the vertices first + index[..] of one material.
void shade_group(const PreparedTransfer& transfer, const Lighting& lighting,
                 const PreparedMaterial& material, const Vector3f& eye,
                 const ShadingOptions& options, size_t first, std::span<const size_t> index,
                 std::span<Rgb> radiance) noexcept {
  ShadingBlock<float> block;
  BlockRgb<float> result;
  for (size_t done = 0; done < index.size();) {
    start_block(block);
    const size_t start = done;
    for (; done < index.size() && has_room(transfer, block); ++done)
      add_vertex(transfer, first + index[done], block);
    for (size_t next = done; next < std::min(done + kBlock, index.size()); ++next)
      fetch_row(transfer, first + index[next], block.fetcher);
    HWY_DYNAMIC_DISPATCH(shade_vertex_block)
    (transfer, material, lighting, options, eye, block, result);
    for (size_t i = 0; i < block.count; ++i) radiance[index[start + i]] = rgb_of(result, i);
  }
}

/// Calls shade(first, block, result) for the points in blocks, each starting at point `first`.
template <class Shade>
void shade_in_blocks(const PreparedTransfer& transfer, std::span<const ShadingPoint> points,
                     std::span<const Vector3f> outgoing, std::span<Rgb> radiance,
                     const Shade& shade) {
  ShadingBlock<float> block;
  BlockRgb<float> result;
  for (size_t done = 0; done < points.size();) {
    start_block(block);
    const size_t start = done;
    for (; done < points.size() && has_room(transfer, block); ++done)
      add_point(transfer, points[done], points[done].frame.to_local(outgoing[done]), block);
    shade(start, block, result);
    for (size_t i = 0; i < block.count; ++i) radiance[start + i] = rgb_of(result, i);
  }
}

}  // namespace

std::vector<PreparedMaterial> prepare_materials(std::span<const Material> materials,
                                                const ShadingOptions& options) {
  std::vector<PreparedMaterial> prepared;
  prepared.reserve(materials.size());
  for (size_t i = 0; i < materials.size(); ++i) {
    const std::string error = domain_error(materials[i]);
    if (!error.empty()) throw std::invalid_argument("material " + std::to_string(i) + ": " + error);
    prepared.push_back(prepare_material(materials[i], options.specular));
  }
  return prepared;
}

ShadingPoint vertex_shading_point(const PreparedTransfer& transfer, size_t vertex) noexcept {
  ShadingPoint point;
  point.position = transfer.positions[vertex];
  point.frame =
      frame_from_normal_tangent(valid_normal(transfer.normals[vertex]), transfer.tangents[vertex]);
  point.vertices[0] = static_cast<std::uint32_t>(vertex);
  return point;
}

void shade_points(const PreparedTransfer& transfer, std::span<const ShadingPoint> points,
                  std::span<const Vector3f> outgoing, const PreparedMaterial& material,
                  const Lighting& lighting, const ShadingOptions& options,
                  std::span<Rgb> radiance) noexcept {
  shade_in_blocks(transfer, points, outgoing, radiance,
                  [&](size_t, ShadingBlock<float>& block, BlockRgb<float>& result) {
                    HWY_DYNAMIC_DISPATCH(shade_block_of_floats)
                    (transfer, material, lighting, options, block, result);
                  });
}

void shade_points(const PreparedTransfer& transfer, std::span<const ShadingPoint> points,
                  std::span<const Vector3f> outgoing, std::span<const Material> materials,
                  const Lighting& lighting, const ShadingOptions& options,
                  std::span<Rgb> radiance) noexcept {
  shade_in_blocks(transfer, points, outgoing, radiance,
                  [&](size_t first, ShadingBlock<float>& block, BlockRgb<float>& result) {
                    HWY_DYNAMIC_DISPATCH(shade_varied_block)
                    (transfer, materials.subspan(first), lighting, options, block, result);
                  });
}

Rgb shade_point(const PreparedTransfer& transfer, const ShadingPoint& point,
                const Vector3f& outgoing, const PreparedMaterial& material,
                const Lighting& lighting, const ShadingOptions& options) noexcept {
  Rgb radiance;
  shade_points(transfer, {&point, 1}, {&outgoing, 1}, material, lighting, options, {&radiance, 1});
  return radiance;
}

void shade_vertices(const PreparedTransfer& transfer, const Lighting& lighting,
                    std::span<const PreparedMaterial> materials,
                    std::span<const std::uint8_t> material_id, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept {
  // Some blocks' vertices at a time, grouped by material, and those by basis: a block reads what
  // it shares once.
  size_t index[kTogether];
  for (size_t start = 0; start < radiance.size(); start += kTogether) {
    const size_t count = std::min(kTogether, radiance.size() - start);
    const auto material_of = [&](size_t i) -> size_t {
      return material_id.empty() ? 0 : material_id[first + i];
    };
    for (size_t i = 0; i < count; ++i) index[i] = start + i;
    if (transfer.bases.size() > 1)
      sort_by({index, count}, [&](size_t i) { return transfer.basis_id[first + i]; });
    if (!material_id.empty())
      sort_by({index, count}, [&](size_t i) { return material_id[first + i]; });
    for (size_t done = 0; done < count;) {
      const size_t id = material_of(index[done]);
      size_t end = done;
      while (end < count && material_of(index[end]) == id) ++end;
      shade_group(transfer, lighting, materials[id], eye, options, first,
                  {index + done, end - done}, radiance);
      done = end;
    }
  }
}

}  // namespace burnish
#endif
