#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/formats/mesh_statistics.h"
#include "burnish/precompute/subdivision.h"
#include "precompute/refinement_support.h"

namespace burnish::test {
namespace {

TEST(Subdivision, KeepsSurfaceTopologyAndTightness) {
  const TriangleMesh box = make_box({-1, -1, -1}, {2, 1, 0.5f});
  for (const TriangleMesh& before : {box, make_octahedron()})
    for (const double max_edge : {0.7, 0.3}) {
      SCOPED_TRACE(before.name);
      TriangleMesh mesh = before;
      const SubdivisionReport report = subdivide_long_edges(mesh, max_edge);
      EXPECT_EQ(mesh.positions.size(), before.positions.size() + report.added_vertices);
      EXPECT_EQ(mesh.triangles.size(), before.triangles.size() + report.added_triangles);
      EXPECT_LE(longest_edge(mesh), max_edge * (1 + 1e-6));  // measured in float
      // 1e-6: corners rounded to float.
      EXPECT_NEAR(surface_area(mesh) / surface_area(before), 1, 1e-6);
      EXPECT_NEAR(signed_volume(mesh) / signed_volume(before), 1, 1e-6);
      EXPECT_FALSE(has_t_junction(mesh));
      expect_frames(mesh);
      const MeshStatistics statistics = analyse_mesh(mesh);
      EXPECT_EQ(statistics.boundary_edges, 0u);
      EXPECT_EQ(statistics.non_manifold_edges, 0u);
      EXPECT_EQ(statistics.inconsistent_edges, 0u);
      EXPECT_EQ(statistics.unused_vertices, 0u);
      EXPECT_EQ(statistics.degenerate_triangles, 0u);
      EXPECT_EQ(euler_characteristic(mesh), 2);
    }
}

TEST(Subdivision, LeavesAFineMeshAlone) {
  TriangleMesh mesh = make_sphere({0, 0, 0}, 1, 8);
  const TriangleMesh before = mesh;
  EXPECT_EQ(subdivide_long_edges(mesh, 10).rounds, 0);
  EXPECT_EQ(mesh.positions, before.positions);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(Subdivision, NewVerticesAreMeansAndHaveNoFileVertex) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  mesh.normals = {Vector3f::UnitZ(), Vector3f::UnitX(), -Vector3f::UnitZ()};
  mesh.tangents = {Vector3f::UnitX(), Vector3f::UnitY(), -Vector3f::UnitX()};
  mesh.uvs = {{0, 0}, {1, 0.5f}, {0, 1}};
  mesh.file_vertex = {7, 8, 9};
  mesh.triangles = {{0, 1, 2}};
  subdivide_long_edges(mesh, 1.5);  // halves 0-1 and 1-2
  ASSERT_EQ(mesh.positions.size(), 5u);
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.file_vertex, (std::vector<std::uint32_t>{7, 8, 9, kNoFileVertex, kNoFileVertex}));
  EXPECT_EQ(mesh.positions[3], Vector3f(1, 0, 0));
  EXPECT_EQ(mesh.positions[4], Vector3f(1, 0.5f, 0));
  EXPECT_EQ(mesh.uvs[3], Eigen::Vector2f(0.5f, 0.25f));
  EXPECT_NEAR((mesh.normals[3] - Vector3f(1, 0, 1).normalized()).norm(), 0, 1e-6);
  expect_frames(mesh);

  subdivide_long_edges(mesh, 0.9);  // halves 0-2, whose normals cancel: that of 0
  bool found = false;
  for (size_t v = 5; v < mesh.positions.size(); ++v)
    if (mesh.positions[v] == Vector3f(0, 0.5f, 0)) {
      found = true;
      EXPECT_EQ(mesh.normals[v], Vector3f::UnitZ());
      EXPECT_EQ(mesh.tangents[v].cwiseAbs(), Vector3f::UnitX());  // an axis has no sign
    }
  EXPECT_TRUE(found);
}

TEST(Subdivision, PartsStayTogether) {
  TriangleMesh mesh = make_box({0, 0, 0}, {1, 1, 1});
  const TriangleMesh second = make_box({3, 0, 0}, {2, 2, 2});
  const auto first_vertex = static_cast<std::uint32_t>(mesh.positions.size());
  const auto first_triangle = static_cast<std::uint32_t>(mesh.triangles.size());
  mesh.parts = {{"small", 0, first_vertex, 0, first_triangle},
                {"empty", first_vertex, 0, first_triangle, 0},
                {"large", first_vertex, first_vertex, first_triangle, first_triangle}};
  mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
  mesh.normals.insert(mesh.normals.end(), second.normals.begin(), second.normals.end());
  for (Triangle t : second.triangles) {
    for (std::uint32_t& v : t) v += first_vertex;
    mesh.triangles.push_back(t);
  }
  complete(mesh);
  const TriangleMesh before = mesh;
  subdivide_long_edges(mesh, 0.8);
  ASSERT_EQ(mesh.parts.size(), 3u);
  std::uint32_t vertex = 0, triangle = 0;
  for (size_t p = 0; p < 3; ++p) {
    const MeshPart& part = mesh.parts[p];
    EXPECT_EQ(part.name, before.parts[p].name);
    EXPECT_EQ(part.first_vertex, vertex);
    EXPECT_EQ(part.first_triangle, triangle);
    for (std::uint32_t v = 0; v < before.parts[p].vertices; ++v)
      EXPECT_EQ(mesh.positions[vertex + v], before.positions[before.parts[p].first_vertex + v]);
    vertex += part.vertices;
    double area = 0;
    for (std::uint32_t t = triangle; t < triangle + part.triangles; ++t) {
      for (const std::uint32_t v : mesh.triangles[t]) {
        EXPECT_GE(v, part.first_vertex);
        EXPECT_LT(v, vertex);
      }
      TriangleMesh one;
      one.positions = mesh.positions;
      one.triangles = {mesh.triangles[t]};
      area += surface_area(one);
    }
    EXPECT_NEAR(area, p == 0 ? 6 : p == 1 ? 0 : 24, 1e-4);
    triangle += part.triangles;
  }
  EXPECT_EQ(vertex, mesh.positions.size());
  EXPECT_EQ(triangle, mesh.triangles.size());
}

TEST(Subdivision, RefusesWhatItCannotDo) {
  const TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  const auto refuse = [&](double max_edge, std::uint64_t max_vertices, auto spoil) {
    TriangleMesh mesh = box;
    spoil(mesh);
    const TriangleMesh before = mesh;
    const std::string error = error_of([&] { subdivide_long_edges(mesh, max_edge, max_vertices); });
    EXPECT_EQ(mesh.positions.size(), before.positions.size());
    EXPECT_EQ(mesh.triangles, before.triangles);
    return error;
  };
  const auto nothing = [](TriangleMesh&) {};
  EXPECT_NE(refuse(0, 1000, nothing).find("box: the longest edge is 0"), std::string::npos);
  EXPECT_NE(refuse(kNan, 1000, nothing), "");
  const std::string error = refuse(1e-3, 5000, nothing);
  EXPECT_NE(error.find("edges of at most 0.001 take more than 5000 vertices"), std::string::npos)
      << error;
  EXPECT_NE(refuse(0.1, 10000, [](TriangleMesh& m) { m.triangles[3][1] = 24; })
                .find("triangle 3 uses vertex 24, expected below 24"),
            std::string::npos);
  EXPECT_NE(refuse(0.1, 10000, [](TriangleMesh& m) { m.tangents.pop_back(); }), "");
  EXPECT_NE(refuse(0.1, 10000, [](TriangleMesh& m) { m.parts = {{"a", 0, 23, 0, 12}}; }), "");
  EXPECT_NE(refuse(0.1, 10000, [](TriangleMesh& m) { m.parts = {{"a", 1, 24, 0, 12}}; }), "");
}

TEST(Subdivision, DegenerateInputEnds) {
  TriangleMesh mesh = make_floor(1);
  mesh.positions.push_back({kNan, 0, 0});
  mesh.positions.push_back({std::numeric_limits<float>::infinity(), 0, 0});
  mesh.normals.insert(mesh.normals.end(), 2, Vector3f::Zero());
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0, 1, 5});
  mesh.triangles.push_back({2, 2, 3});
  mesh.triangles.push_back({0, 0, 0});
  complete(mesh);
  subdivide_long_edges(mesh, 0.5);
  EXPECT_NEAR(mesh.positions[4].y(), 0, 0);
  EXPECT_GT(mesh.triangles.size(), 20u);

  // Neighbours among the floats: there is nothing between them along an axis.
  TriangleMesh tiny;
  const float next = std::nextafter(1.0f, 2.0f);
  tiny.positions = {{1, 1, 1}, {next, 1, 1}, {1, next, 1}};
  tiny.normals.assign(3, Vector3f::UnitZ());
  tiny.triangles = {{0, 1, 2}};
  complete(tiny);
  EXPECT_LE(subdivide_long_edges(tiny, 1e-9).added_vertices, 1u);  // between the last two
}

}  // namespace
}  // namespace burnish::test
