#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "burnish/formats/triangle_mesh.h"

namespace burnish {

/// What a mesh is like. Topology is by position: vertices at exactly the same point are one, so
/// that hard edges, UV seams and the unwelded triangles of an exporter do not count as boundary.
struct MeshStatistics {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t points = 0;                ///< distinct positions
  std::uint64_t duplicate_vertices = 0;    ///< file vertices at the position of another one
  std::uint64_t split_vertices = 0;        ///< vertices beyond the first of their file vertex
  std::uint64_t unused_vertices = 0;       ///< in no triangle
  std::uint64_t components = 0;            ///< of triangles that share a point; degenerate excluded
  std::uint64_t boundary_edges = 0;        ///< in one triangle
  std::uint64_t non_manifold_edges = 0;    ///< in three or more triangles
  std::uint64_t inconsistent_edges = 0;    ///< in two triangles that disagree about the front side
  std::uint64_t degenerate_triangles = 0;  ///< without area (is_degenerate); not part of the above
  Eigen::AlignedBox3f bounds;              ///< of all vertices; isEmpty() without any
};

/// Throws nothing: any TriangleMesh whose indices are in range. An empty `file_vertex` stands for
/// 0, 1, 2, ...
MeshStatistics analyse_mesh(const TriangleMesh& mesh);

}  // namespace burnish
