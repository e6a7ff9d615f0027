#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/sphere/direction.h"

namespace burnish {

using Triangle = std::array<std::uint32_t, 3>;

/// Mean and eigen-SSDFs of one PCA basis, on the equal-area octahedral map (world frame), in
/// radians. `eigen` is texel-major so that a lookup is four contiguous dot products.
struct SsdfBasis {
  int resolution = 0;        ///< texels along an edge of the map
  int terms = 0;             ///< number of eigen-SSDFs
  std::vector<float> mean;   ///< [resolution^2]
  std::vector<float> eigen;  ///< [resolution^2][terms]
};

/// How a transfer was made. Holds only what is the same on every run with equal inputs.
struct Provenance {
  std::string version;    ///< of burnish
  std::string mesh_name;  ///< file name without its folder, or the name of the procedural scene
  std::string
      mesh_hash;  ///< 64-bit FNV-1a of positions, normals, tangents and triangles, 16 hex digits
  std::string occluder_hash;       ///< likewise of all occluders; empty without any
  int directions = 0;              ///< visibility was sampled on directions^2 texels
  int training_vertices = 0;       ///< vertices the basis was trained on
  std::uint64_t rays = 0;          ///< cast in all
  double residual_rms_rad = 0;     ///< of SSDF values over all vertices, after compression
  double wrong_sign_fraction = 0;  ///< of SSDF texels over all vertices, after compression
};

/// What a bake produces: the receiver mesh and the compressed visibility of each of its vertices.
/// Immutable while shading, and may be shared between threads.
struct Transfer {
  std::vector<Vector3f> positions;         ///< #V, world units of the mesh file
  std::vector<Vector3f> normals;           ///< #V, unit
  std::vector<Vector3f> tangents;          ///< #V, unit, orthogonal to the normal
  std::vector<std::uint32_t> file_vertex;  ///< #V, index of the vertex in the mesh file
  std::vector<Triangle> triangles;         ///< #F

  std::vector<SsdfBasis> bases;        ///< one or more; equal resolution and terms
  std::vector<std::uint8_t> basis_id;  ///< #V
  std::vector<float> coefficients;     ///< [#V][terms]

  std::vector<Vector3f> occluder_positions;  ///< geometry that casts shadows and is not shaded
  std::vector<Triangle> occluder_triangles;

  Provenance provenance;

  size_t vertex_count() const { return positions.size(); }
  int terms() const { return bases.empty() ? 0 : bases.front().terms; }
  const float* vertex_coefficients(size_t vertex) const {
    return coefficients.data() + vertex * static_cast<size_t>(terms());
  }
};

}  // namespace burnish
