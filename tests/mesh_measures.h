#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "burnish/formats/triangle_mesh.h"

namespace burnish::test {

/// Volume enclosed by a mesh, by the divergence theorem: positive when normals point outward.
inline double signed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d a = mesh.positions[t[0]].cast<double>();
    const Vector3d b = mesh.positions[t[1]].cast<double>();
    const Vector3d c = mesh.positions[t[2]].cast<double>();
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

inline double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d a = mesh.positions[t[0]].cast<double>();
    area += (mesh.positions[t[1]].cast<double>() - a)
                .cross(mesh.positions[t[2]].cast<double>() - a)
                .norm() /
            2;
  }
  return area;
}

/// Edges that do not have exactly one triangle on either side, after welding equal positions.
inline size_t open_edges(const TriangleMesh& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> welded;
  std::vector<std::uint32_t> id;
  for (const Vector3f& p : mesh.positions)
    id.push_back(welded
                     .try_emplace({p.x() + 0.0f, p.y() + 0.0f, p.z() + 0.0f},
                                  static_cast<std::uint32_t>(welded.size()))
                     .first->second);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (const Triangle& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++directed[{id[t[i]], id[t[(i + 1) % 3]]}];
  size_t open = 0;
  for (const auto& [edge, count] : directed) {
    const auto other = directed.find({edge.second, edge.first});
    open += count != 1 || other == directed.end() || other->second != 1;
  }
  return open;
}

}  // namespace burnish::test
