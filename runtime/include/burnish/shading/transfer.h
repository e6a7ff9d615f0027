#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/sphere/direction.h"

namespace burnish {

using Triangle = std::array<std::uint32_t, 3>;

/// A mesh of a scene: what of the transfer's vertices and triangles came from it.
struct MeshPart {
  std::string name;  ///< file name without its folder, or a scene's name; an instance's own
  std::uint32_t first_vertex = 0, vertices = 0;
  std::uint32_t first_triangle = 0, triangles = 0;
};

/// Mean and eigen-SSDFs of one PCA basis, on the equal-area octahedral map (world frame).
/// `eigen` is texel-major so that a lookup is four contiguous dot products.
struct SsdfBasis {
  int resolution = 0;  ///< texels along an edge of the map
  int terms = 0;       ///< number of eigen-SSDFs
  /// s > 0: what is compressed is tanh(distance / s), in -1..1; 0: the distance itself, in radians.
  float amplitude_rad = 0;
  std::vector<float> mean;   ///< [resolution^2]
  std::vector<float> eigen;  ///< [resolution^2][terms]
};

/// Mean and eigenvectors of one basis of the visibility ladder, as spherical harmonics of the
/// visibility (world frame; their order: visibility_ladder.h). A lobe's bandwidth is a factor a
/// band, so that all lobes share a vertex's coefficients.
struct LadderBasis {
  int bands = 0;             ///< of harmonics, degrees 0..bands - 1
  int terms = 0;             ///< number of eigenvectors
  std::vector<float> mean;   ///< [bands^2]
  std::vector<float> eigen;  ///< [bands^2][terms]
};

/// Relative RMS error of the visible fraction of isotropic lobes of one bandwidth.
struct LobeError {
  double bandwidth = 0;
  double relative_rms = 0;
};

/// How a transfer was made. Holds only what is the same on every run with equal inputs.
struct Provenance {
  std::string version;    ///< of burnish
  std::string mesh_name;  ///< file name without its folder, or the name of the procedural scene
  std::string
      mesh_hash;  ///< 64-bit FNV-1a of positions, normals, tangents and triangles, 16 hex digits
  std::string occluder_hash;             ///< likewise of all occluders; empty without any
  int directions = 0;                    ///< visibility was sampled on directions^2 texels
  int coarsest = 0;                      ///< ... on coarsest^2 first, then where it changes
  double origin_offset = 0;              ///< by which rays left the surface, world units
  int training_vertices = 0;             ///< vertices the basis was trained on
  std::uint64_t rays = 0;                ///< cast in all
  int residual_vertices = 0;             ///< vertices the residuals below are of
  bool residual_held_out = false;        ///< the basis was not trained on them
  double residual_rms_rad = 0;           ///< of SSDF values held to +-pi/2, after compression
  double wrong_sign_fraction = 0;        ///< of SSDF texels, after compression; as above
  std::vector<LobeError> ssdf_errors;    ///< of lobes' visibility through the compressed SSDF
  std::vector<LobeError> ladder_errors;  ///< ... and through the ladder
};

/// What a bake produces: the receiver mesh and the compressed visibility of each of its vertices.
/// Immutable while shading, and may be shared between threads.
struct Transfer {
  std::vector<Vector3f> positions;  ///< #V, world units of the mesh file
  std::vector<Vector3f> normals;    ///< #V, unit
  std::vector<Vector3f> tangents;   ///< #V, unit, orthogonal to the normal
  std::vector<std::uint32_t>
      file_vertex;                  ///< #V, index of the vertex in its mesh file; 2^32 - 1: in none
  std::vector<Triangle> triangles;  ///< #F
  /// #V, or empty: UV coordinates, u to the right and v up in a texture.
  std::vector<Vector2<float>> texcoords;

  std::vector<MeshPart> parts;  ///< in order, without gaps; none: one nameless part

  /// Equal resolution, terms and amplitude. None: nothing occludes but each vertex's horizon; then
  /// there are no ids, coefficients or ladder either.
  std::vector<SsdfBasis> bases;
  std::vector<std::uint8_t> basis_id;  ///< #V
  std::vector<float> coefficients;     ///< [#V][terms]

  /// None (no ladder), one, or one for each of `bases` (then basis_id tells which). Equal
  /// bands and terms.
  std::vector<LadderBasis> ladder_bases;
  std::vector<float> ladder_coefficients;  ///< [#V][ladder terms]
  /// Lobes below this bandwidth are better served by the ladder than by the SSDF; 0 without one.
  float ladder_crossover = 0;

  std::vector<Vector3f> occluder_positions;  ///< geometry that casts shadows and is not shaded
  std::vector<Triangle> occluder_triangles;

  Provenance provenance;

  size_t vertex_count() const { return positions.size(); }
  int terms() const { return bases.empty() ? 0 : bases.front().terms; }
  const float* vertex_coefficients(size_t vertex) const {
    return coefficients.data() + vertex * static_cast<size_t>(terms());
  }
  int ladder_terms() const { return ladder_bases.empty() ? 0 : ladder_bases.front().terms; }
  /// Null without a ladder.
  const LadderBasis* vertex_ladder_basis(size_t vertex) const {
    if (ladder_bases.empty()) return nullptr;
    return &ladder_bases[ladder_bases.size() == 1 ? 0 : basis_id[vertex]];
  }
  const float* vertex_ladder_coefficients(size_t vertex) const {
    return ladder_coefficients.data() + vertex * static_cast<size_t>(ladder_terms());
  }
};

}  // namespace burnish
