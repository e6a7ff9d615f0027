#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/sphere/direction.h"
#include "mesh_transcript.h"

namespace burnish::detail {

/// Polygons as a file lists them: no connectivity to be kept, so nothing to be dropped.
struct PolygonSoup {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Corner {
    std::uint32_t vertex = 0;
    std::uint32_t normal = kNone;
    std::uint32_t uv = kNone;
  };

  std::vector<Vector3f> positions;  ///< of the file's vertices
  std::vector<Vector3f> normals;    ///< as the file has them: any length, not always finite
  std::vector<Eigen::Vector2f> uvs;
  std::vector<Corner> corners;
  std::vector<std::uint32_t> face_begin = {0};  ///< #F + 1, into corners

  /// PLY and OFF: normal and UV of vertex i, if there are any, are normals[i] and uvs[i], also for
  /// vertices that are in no face.
  bool per_vertex_normals = false;
  bool per_vertex_uvs = false;

  size_t face_count() const { return face_begin.size() - 1; }
  std::span<const Corner> face(size_t index) const {
    return {corners.data() + face_begin[index], face_begin[index + 1] - face_begin[index]};
  }
};

/// Has OpenMesh read the transcript. Throws Error when what arrives is not what the transcript
/// holds. One caller at a time gets through: OpenMesh's readers are shared objects with state.
PolygonSoup read_soup(const std::string& path, MeshTranscript& transcript);

}  // namespace burnish::detail
