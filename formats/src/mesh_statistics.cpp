#include "burnish/formats/mesh_statistics.h"

#include <algorithm>
#include <numeric>

#include "burnish/formats/mesh_frames.h"
#include "mesh/weld.h"

namespace burnish {
namespace {

/// Union by the smaller number, with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// An edge of a triangle between points, the lower number first.
struct Edge {
  std::uint64_t ends = 0;
  bool reversed = false;  ///< the triangle runs from the higher number to the lower

  bool operator<(const Edge& other) const { return ends < other.ends; }
};

void count_edges(std::vector<Edge>& edges, MeshStatistics& statistics) {
  std::sort(edges.begin(), edges.end());
  for (size_t begin = 0; begin < edges.size();) {
    size_t end = begin;
    while (end < edges.size() && edges[end].ends == edges[begin].ends) ++end;
    const size_t uses = end - begin;
    if (uses == 1) ++statistics.boundary_edges;
    if (uses == 2 && edges[begin].reversed == edges[begin + 1].reversed)
      ++statistics.inconsistent_edges;
    if (uses > 2) ++statistics.non_manifold_edges;
    begin = end;
  }
}

std::uint64_t count_file_vertices(const TriangleMesh& mesh) {
  if (mesh.file_vertex.empty()) return mesh.positions.size();
  std::vector<std::uint32_t> ids = mesh.file_vertex;
  std::sort(ids.begin(), ids.end());
  return static_cast<std::uint64_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
}

}  // namespace

MeshStatistics analyse_mesh(const TriangleMesh& mesh) {
  MeshStatistics statistics;
  statistics.vertices = mesh.positions.size();
  statistics.triangles = mesh.triangles.size();
  for (const Vector3f& position : mesh.positions) statistics.bounds.extend(position);

  std::uint32_t points = 0;
  const std::vector<std::uint32_t> point = detail::weld_positions(mesh.positions, points);
  const std::uint64_t file_vertices = count_file_vertices(mesh);
  statistics.points = points;
  statistics.duplicate_vertices = file_vertices > points ? file_vertices - points : 0;
  statistics.split_vertices = statistics.vertices - file_vertices;

  std::vector<char> vertex_used(mesh.positions.size(), 0);
  std::vector<char> point_used(points, 0);
  DisjointSets components(points);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) vertex_used[v] = 1;
    if (is_degenerate(mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                      mesh.positions[triangle[2]])) {
      ++statistics.degenerate_triangles;
      continue;
    }
    for (size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = point[triangle[k]];
      const std::uint32_t b = point[triangle[(k + 1) % 3]];
      edges.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), a > b});
      components.unite(a, b);
      point_used[a] = 1;
    }
  }
  count_edges(edges, statistics);
  statistics.unused_vertices =
      static_cast<std::uint64_t>(std::count(vertex_used.begin(), vertex_used.end(), 0));
  for (std::uint32_t i = 0; i < points; ++i)
    if (point_used[i] && components.find(i) == i) ++statistics.components;
  return statistics;
}

}  // namespace burnish
