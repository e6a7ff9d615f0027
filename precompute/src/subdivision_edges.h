#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/formats/triangle_mesh.h"

/// The edges of a mesh, and how they are halved. Private to precompute.
namespace burnish {

/// Every pair of vertices that a triangle joins, once. Pairs between the same two positions are one
/// segment: what halves one of them halves all.
struct MeshEdges {
  struct Edge {
    std::uint32_t a = 0, b = 0;  ///< vertices, a <= b
    std::uint32_t segment = 0;

    std::uint64_t key() const { return std::uint64_t{a} << 32 | b; }
  };
  std::vector<Edge> edges;                                ///< by rising key
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< of corners 0-1, 1-2, 2-0
  std::uint32_t segments = 0;
};

/// Throws Error for an index out of range, and for parts that do not cover the mesh in order.
void check_subdivision_input(const TriangleMesh& mesh);

MeshEdges find_edges(const TriangleMesh& mesh);

/// World units; NaN or infinite where an end is.
double edge_length(const TriangleMesh& mesh, const MeshEdges::Edge& edge);

/// The vertex in the middle.
struct Midpoint {
  Vector3f position, normal, tangent;
  Eigen::Vector2f uv;
};
Midpoint midpoint_of(const TriangleMesh& mesh, const MeshEdges::Edge& edge);

/// Whether an edge has finite ends and a float between them.
bool can_halve(const TriangleMesh& mesh, const MeshEdges::Edge& edge);

/// A mesh whose edges are being halved: vertices keep their numbers until gather_parts().
class Subdivider {
 public:
  explicit Subdivider(const TriangleMesh& mesh);

  const TriangleMesh& mesh() const { return mesh_; }

  /// Halves the edges of the segments that are marked, by one new vertex each, in the order of the
  /// edges. Throws Error when 32-bit indices do not suffice.
  void halve(const MeshEdges& edges, const std::vector<char>& marked);

  /// The mesh with the vertices of each part together again.
  TriangleMesh gather_parts() &&;

 private:
  TriangleMesh mesh_;
  std::vector<std::uint32_t> part_of_;  ///< of each vertex; empty with fewer than two parts
};

}  // namespace burnish
