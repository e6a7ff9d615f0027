#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burnish/material/material.h"
#include "burnish/material/texture.h"
#include "burnish/shading/transfer.h"
#include "burnish/sphere/frame.h"

/// Materials that differ from place to place: by vertex, or by textures over UV. All of it may
/// change from frame to frame; what is read is what the spans and textures hold then.
///
///     const MaterialMaps maps = make_material_maps(material, pictures, wrap);  // once a change
///     const VertexTaps taps = vertex_taps(transfer);                           // once a mesh
///     MaterialArrays arrays;
///     resize(arrays, maps, transfer.vertex_count());
///     sample_vertices(maps, taps, 0, transfer.vertex_count(), arrays);
///     const SurfaceMaterial at = material_at(material, variation_of(arrays), vertex, frame);
namespace burnish {

/// What of a material varies, by vertex. Each span has an entry per vertex, or is empty: then the
/// base material's value holds everywhere.
struct MaterialVariation {
  std::span<const Rgb> diffuse = {}, specular = {};   ///< in the ranges of Material
  std::span<const float> alpha_x = {}, alpha_y = {};  ///< the same
  std::span<const float> tangent_rotation_rad =
      {};                                 ///< about the normal, from tangent to bitangent
  std::span<const Vector3f> normal = {};  ///< unit, z > 0, in the vertex's frame
};

/// What is wrong with it, naming the field and the vertex, or nothing.
std::string domain_error(const MaterialVariation& variation, std::size_t vertices);

/// A material at a place: shade with this frame, in place of the surface's own.
struct SurfaceMaterial {
  Material material;
  Frame<float> frame;
};

/// Of a vertex with a frame of its own, x tangent and z normal.
SurfaceMaterial material_at(const Material& base, const MaterialVariation& variation,
                            std::size_t vertex, const Frame<float>& frame) noexcept;

/// Pictures over UV, linear; each may be missing. Values are clamped to their ranges; they must be
/// finite. Scalars are taken from the first channel.
struct MaterialPictures {
  std::optional<Image> diffuse, specular;
  std::optional<Image> alpha_x, alpha_y;
  std::optional<Image> tangent_rotation_rad;
  std::optional<Image> normal;  ///< of any length > 0, in the surface's frame
};

/// The same, ready to be looked up. Roughness, rotation and normals are filtered as one (LEAN
/// mapping, olano2010lean): what is averaged are the first and second moments of the microfacets'
/// slopes, to which alpha adds the variance alpha^2 / 2 along its axis. So detail of the normals or
/// of the rotation that a lookup averages away widens the lobe. Exact for Beckmann's distribution.
struct MaterialMaps {
  std::optional<Texture> diffuse, specular;
  std::optional<Texture> slope;    ///< of the normal: x / z, y / z
  std::optional<Texture> moments;  ///< of microfacets: mean of x x, x y, y y
};

/// `base` has the values of what there is no picture of. The moments have the size of the largest
/// picture they are of.
MaterialMaps make_material_maps(const Material& base, const MaterialPictures& pictures,
                                TextureWrap wrap = TextureWrap::repeat);

/// Where to look textures up, and how they lie on the surface there.
struct TexturePlace {
  Vector2<float> uv = Vector2<float>::Zero();
  float width = 0;  ///< as eval_texture takes it
  /// 1, or -1 where u grows against the frame's x, and v against its y: on mirrored textures, and
  /// because a tangent is an axis. Turns normals and rotations.
  float u_sign = 1, v_sign = 1;
};

/// Whether u and v grow along the axes of a frame on a triangle; 1 where the UVs do not say.
struct TextureSigns {
  float u = 1, v = 1;
};
TextureSigns texture_signs(const Transfer& transfer, const Triangle& triangle,
                           const Frame<float>& frame) noexcept;

/// A place, and how much of a vertex's neighbourhood it stands for.
struct TextureTap {
  TexturePlace place;
  float weight = 0;  ///< of a vertex's, they sum to 1
};

/// Where to look textures up for each vertex: one tap for each of its triangles, over the third of
/// it that is nearest, weighted by that area of the surface.
struct VertexTaps {
  std::vector<TextureTap> taps;
  std::vector<std::uint32_t> first;  ///< [#V + 1]: vertex v has first[v] to first[v + 1]
};

/// Throws std::invalid_argument for a transfer without texture coordinates.
VertexTaps vertex_taps(const Transfer& transfer);

/// MaterialVariation with memory of its own.
struct MaterialArrays {
  std::vector<Rgb> diffuse, specular;
  std::vector<float> alpha_x, alpha_y, tangent_rotation_rad;
  std::vector<Vector3f> normal;
};
MaterialVariation variation_of(const MaterialArrays& arrays);

/// Makes room for what the maps have.
void resize(MaterialArrays& arrays, const MaterialMaps& maps, std::size_t vertices);

/// Looks up the vertices [first, last). Call it from as many threads as you like, on ranges that do
/// not overlap; `arrays` as resized.
void sample_vertices(const MaterialMaps& maps, const VertexTaps& taps, std::size_t first,
                     std::size_t last, MaterialArrays& arrays) noexcept;

/// At any place, as wide as a pixel sees it; `frame` is the surface's own.
SurfaceMaterial material_at(const Material& base, const MaterialMaps& maps,
                            const TexturePlace& place, const Frame<float>& frame) noexcept;

}  // namespace burnish
