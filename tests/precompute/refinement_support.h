#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/ray_scene.h"
#include "mesh_measures.h"
#include "precompute/test_meshes.h"

/// Meshes to refine, and what must hold of any refined mesh.
namespace burnish::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A box with a normal for each face: 24 vertices at 8 points.
inline TriangleMesh make_box(const Vector3f& low, const Vector3f& size) {
  TriangleMesh mesh;
  mesh.name = "box";
  const Vector3f x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  add_quad(mesh, low, y, x);
  add_quad(mesh, low, z, y);
  add_quad(mesh, low, x, z);
  add_quad(mesh, low + z, x, y);
  add_quad(mesh, low + x, y, z);
  add_quad(mesh, low + y, z, x);
  complete(mesh);
  return mesh;
}

/// Vertices that all their triangles share.
inline TriangleMesh make_octahedron() {
  TriangleMesh mesh;
  mesh.name = "octahedron";
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {1.0f, -1.0f}) mesh.positions.push_back(side * Vector3f::Unit(axis));
  mesh.normals = mesh.positions;
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  complete(mesh);
  return mesh;
}

inline TriangleMesh make_floor(float half, const Vector3f& center = Vector3f::Zero()) {
  TriangleMesh mesh;
  mesh.name = "floor";
  add_quad(mesh, center - Vector3f(half, half, 0), {2 * half, 0, 0}, {0, 2 * half, 0});
  complete(mesh);
  return mesh;
}

inline RayScene scene_of(std::initializer_list<TriangleMesh> meshes) {
  RayScene scene;
  for (const TriangleMesh& mesh : meshes) scene.add_mesh(mesh.positions, mesh.triangles);
  scene.commit();
  return scene;
}

inline double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k)
      longest =
          std::max<double>(longest, (mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]).norm());
  return longest;
}

inline double smallest_angle(const TriangleMesh& mesh) {
  double smallest = kPi<double>;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d a = mesh.positions[t[k]].cast<double>();
      smallest = std::min(smallest,
                          angle_between<double>(mesh.positions[t[(k + 1) % 3]].cast<double>() - a,
                                                mesh.positions[t[(k + 2) % 3]].cast<double>() - a));
    }
  return smallest;
}

/// Points - edges + triangles, vertices at one position being one point.
inline long euler_characteristic(const TriangleMesh& mesh) {
  using Point = std::array<float, 3>;
  const auto point = [&](std::uint32_t v) {
    return Point{mesh.positions[v].x() + 0.f, mesh.positions[v].y() + 0.f,
                 mesh.positions[v].z() + 0.f};
  };
  std::set<Point> points;
  std::set<std::pair<Point, Point>> edges;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      points.insert(point(t[k]));
      edges.insert(std::minmax(point(t[k]), point(t[(k + 1) % 3])));
    }
  return static_cast<long>(points.size()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.triangles.size());
}

/// By brute force: a vertex of one triangle within an edge of another.
inline bool has_t_junction(const TriangleMesh& mesh) {
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d a = mesh.positions[t[k]].cast<double>();
      const Vector3d ab = mesh.positions[t[(k + 1) % 3]].cast<double>() - a;
      for (const Vector3f& p : mesh.positions) {
        const Vector3d ap = p.cast<double>() - a;
        const double along = ap.dot(ab) / ab.squaredNorm();
        // 1e-6: far below any edge here, far above a float's rounding.
        if (along > 1e-6 && along < 1 - 1e-6 && (ap - along * ab).norm() < 1e-6) return true;
      }
    }
  return false;
}

inline void expect_frames(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  ASSERT_EQ(mesh.file_vertex.size(), mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    // 1e-6: a unit vector rounded to float.
    ASSERT_NEAR(mesh.normals[v].norm(), 1, 1e-6) << v;
    ASSERT_NEAR(mesh.tangents[v].norm(), 1, 1e-6) << v;
    ASSERT_NEAR(mesh.normals[v].dot(mesh.tangents[v]), 0, 1e-6) << v;
  }
}

inline std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace burnish::test
