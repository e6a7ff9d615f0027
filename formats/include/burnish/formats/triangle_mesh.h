#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/shading/transfer.h"

namespace burnish {

/// The file_vertex of a vertex that is in no file: one that a subdivision made.
inline constexpr std::uint32_t kNoFileVertex = 0xffffffff;

/// A triangle soup ready to be baked: every vertex has one normal and one tangent. A file vertex
/// that has several normals or UVs (a hard edge, a seam) is several vertices here.
struct TriangleMesh {
  std::string name;                        ///< file name without its folder, or a scene's name
  std::vector<Vector3f> positions;         ///< #V
  std::vector<Vector3f> normals;           ///< #V, unit
  std::vector<Vector3f> tangents;          ///< #V, unit, orthogonal to the normal
  std::vector<Eigen::Vector2f> uvs;        ///< #V, or empty
  std::vector<std::uint32_t> file_vertex;  ///< #V, index in its mesh file, or kNoFileVertex
  std::vector<Triangle> triangles;         ///< #F
  std::vector<MeshPart> parts;  ///< in order, without gaps; none: all is one part named `name`
};

}  // namespace burnish
