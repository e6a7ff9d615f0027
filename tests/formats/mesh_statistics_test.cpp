#include "burnish/formats/mesh_statistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace burnish::test {
namespace {

TriangleMesh make_mesh(std::vector<Vector3f> positions, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return mesh;
}

const std::vector<Vector3f> kTetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kTetrahedronFaces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

TEST(MeshStatistics, ClosedTetrahedron) {
  const MeshStatistics s = analyse_mesh(make_mesh(kTetrahedron, kTetrahedronFaces));
  EXPECT_EQ(s.vertices, 4u);
  EXPECT_EQ(s.triangles, 4u);
  EXPECT_EQ(s.points, 4u);
  EXPECT_EQ(s.components, 1u);
  EXPECT_EQ(s.boundary_edges, 0u);
  EXPECT_EQ(s.non_manifold_edges, 0u);
  EXPECT_EQ(s.inconsistent_edges, 0u);
  EXPECT_EQ(s.duplicate_vertices, 0u);
  EXPECT_EQ(s.split_vertices, 0u);
  EXPECT_EQ(s.unused_vertices, 0u);
  EXPECT_EQ(s.bounds.min(), Vector3f(0, 0, 0));
  EXPECT_EQ(s.bounds.max(), Vector3f(1, 1, 1));
}

TEST(MeshStatistics, EachDefectIsCounted) {
  auto positions = kTetrahedron;
  auto triangles = kTetrahedronFaces;
  std::swap(triangles[0][1], triangles[0][2]);  // turned over: its three edges disagree
  EXPECT_EQ(analyse_mesh(make_mesh(positions, triangles)).inconsistent_edges, 3u);
  triangles.pop_back();  // open: that face's three edges, two of them were consistent
  const MeshStatistics open = analyse_mesh(make_mesh(positions, triangles));
  EXPECT_EQ(open.boundary_edges, 3u);
  EXPECT_EQ(open.inconsistent_edges, 2u);

  positions = kTetrahedron;
  triangles = kTetrahedronFaces;
  positions.push_back({5, 5, 5});  // a fin on the edge 0-1, and a vertex that nothing uses
  positions.push_back({9, 9, 9});
  triangles.push_back({0, 1, 4});
  const MeshStatistics fin = analyse_mesh(make_mesh(positions, triangles));
  EXPECT_EQ(fin.non_manifold_edges, 1u);
  EXPECT_EQ(fin.boundary_edges, 2u);
  EXPECT_EQ(fin.unused_vertices, 1u);
  EXPECT_EQ(fin.bounds.max(), Vector3f(9, 9, 9));

  triangles = kTetrahedronFaces;
  triangles.push_back({0, 1, 1});
  const MeshStatistics flat = analyse_mesh(make_mesh(kTetrahedron, triangles));
  EXPECT_EQ(flat.degenerate_triangles, 1u);
  EXPECT_EQ(flat.non_manifold_edges, 0u);
}

TEST(MeshStatistics, TopologyIsByPosition) {
  // The tetrahedron as four loose triangles; -0 is 0.
  std::vector<Vector3f> positions;
  std::vector<Triangle> triangles;
  for (const Triangle& face : kTetrahedronFaces) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const std::uint32_t v : face) positions.push_back(kTetrahedron[v]);
    triangles.push_back({first, first + 1, first + 2});
  }
  positions[0] = Vector3f(-0.f, 0, -0.f);
  TriangleMesh mesh = make_mesh(positions, triangles);
  const MeshStatistics loose = analyse_mesh(mesh);
  EXPECT_EQ(loose.points, 4u);
  EXPECT_EQ(loose.boundary_edges, 0u);
  EXPECT_EQ(loose.components, 1u);
  EXPECT_EQ(loose.duplicate_vertices, 8u);
  for (const Triangle& face : kTetrahedronFaces)
    for (const std::uint32_t v : face) mesh.file_vertex.push_back(v);
  const MeshStatistics split = analyse_mesh(mesh);  // the same, from four file vertices
  EXPECT_EQ(split.duplicate_vertices, 0u);
  EXPECT_EQ(split.split_vertices, 8u);
}

TEST(MeshStatistics, ComponentsShareAPoint) {
  auto positions = kTetrahedron;
  auto triangles = kTetrahedronFaces;
  for (int copy = 1; copy <= 3; ++copy)
    for (size_t v = 0; v < 4; ++v)
      positions.push_back(kTetrahedron[v] + Vector3f(static_cast<float>(copy) * 10, 0, 0));
  for (std::uint32_t copy = 1; copy <= 3; ++copy)
    for (const Triangle& face : kTetrahedronFaces)
      triangles.push_back({face[0] + 4 * copy, face[1] + 4 * copy, face[2] + 4 * copy});
  EXPECT_EQ(analyse_mesh(make_mesh(positions, triangles)).components, 4u);
  positions[4] = positions[0];  // now the second touches the first
  EXPECT_EQ(analyse_mesh(make_mesh(positions, triangles)).components, 3u);
}

TEST(MeshStatistics, EmptyMesh) {
  const MeshStatistics s = analyse_mesh({});
  EXPECT_EQ(s.components, 0u);
  EXPECT_TRUE(s.bounds.isEmpty());
}

}  // namespace
}  // namespace burnish::test
