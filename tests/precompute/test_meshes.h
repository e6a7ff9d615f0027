#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/sphere/frame.h"

/// Small meshes whose visibility is known in closed form.
namespace burnish::test {

/// Fills in what a baker needs beside positions, normals and triangles.
inline void complete(TriangleMesh& mesh) {
  mesh.tangents.clear();
  mesh.file_vertex.clear();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.tangents.push_back(frame_from_axis<float>(mesh.normals[i]).x);
    mesh.file_vertex.push_back(static_cast<std::uint32_t>(i));
  }
}

/// Adds a quad p, p + a, p + a + b, p + b whose normal is a x b.
inline void add_quad(TriangleMesh& mesh, const Vector3f& p, const Vector3f& a, const Vector3f& b) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const Vector3f normal = a.cross(b).normalized();
  for (const Vector3f& q : {p, Vector3f(p + a), Vector3f(p + a + b), Vector3f(p + b)}) {
    mesh.positions.push_back(q);
    mesh.normals.push_back(normal);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A sphere of `rings` x 2 rings quads with its corners on the sphere of the given radius.
inline TriangleMesh make_sphere(const Vector3f& center, float radius, int rings) {
  TriangleMesh mesh;
  mesh.name = "sphere";
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const double theta = kPi<double> * i / rings, phi = 2 * kPi<double> * j / columns;
      const Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
      mesh.normals.push_back(n.cast<float>());
      mesh.positions.push_back(center + radius * n.cast<float>());
    }
  const auto index = [&](int i, int j) {
    return static_cast<std::uint32_t>(i * columns + j % columns);
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  complete(mesh);
  return mesh;
}

/// A horizontal disc (a fan of `corners` triangles) around `center`.
inline TriangleMesh make_disc(const Vector3f& center, float radius, int corners) {
  TriangleMesh mesh;
  mesh.name = "disc";
  mesh.positions.push_back(center);
  for (int i = 0; i < corners; ++i) {
    const double phi = 2 * kPi<double> * i / corners;
    mesh.positions.push_back(center + radius * Vector3f(static_cast<float>(std::cos(phi)),
                                                        static_cast<float>(std::sin(phi)), 0.0f));
    mesh.triangles.push_back(
        {0, static_cast<std::uint32_t>(1 + i), static_cast<std::uint32_t>(1 + (i + 1) % corners)});
  }
  mesh.normals.assign(mesh.positions.size(), Vector3f::UnitZ());
  complete(mesh);
  return mesh;
}

}  // namespace burnish::test
