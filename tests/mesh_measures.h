#pragma once

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

}  // namespace burnish::test
