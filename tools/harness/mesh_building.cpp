#include "harness/mesh_building.h"

#include <limits>
#include <vector>

namespace burnish {
namespace {

void append_triangle(TriangleMesh& mesh, const Triangle& t) {
  for (size_t i = 0; i < 3; ++i)
    if (mesh.positions[t[i]] == mesh.positions[t[(i + 1) % 3]]) return;
  mesh.triangles.push_back(t);
}

}  // namespace

void append_vertex(TriangleMesh& mesh, const Vector3d& position, const Vector3d& normal,
                   const Vector3d& tangent) {
  const Vector3f n = normal.cast<float>().normalized();
  const Vector3f t = tangent.cast<float>();
  mesh.file_vertex.push_back(next_vertex(mesh));
  mesh.positions.push_back(position.cast<float>());
  mesh.normals.push_back(n);
  mesh.tangents.push_back((t - t.dot(n) * n).normalized());
}

void append_cell(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                 std::uint32_t d) {
  append_triangle(mesh, {a, b, d});
  append_triangle(mesh, {a, d, c});
}

void append_cells(TriangleMesh& mesh, std::uint32_t first, int columns, int rows, bool wrap_columns,
                  bool wrap_rows) {
  const auto index = [=](int column, int row) {
    return first + static_cast<std::uint32_t>((row % rows) * columns + column % columns);
  };
  for (int row = 0; row < (wrap_rows ? rows : rows - 1); ++row)
    for (int column = 0; column < (wrap_columns ? columns : columns - 1); ++column)
      append_cell(mesh, index(column, row), index(column + 1, row), index(column, row + 1),
                  index(column + 1, row + 1));
}

void drop_unused_vertices(TriangleMesh& mesh, std::uint32_t first) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(mesh.positions.size(), kUnused);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) place[v] = v;
  std::uint32_t next = first;
  for (std::uint32_t v = first; v < place.size(); ++v) {
    if (place[v] == kUnused) continue;
    mesh.positions[next] = mesh.positions[v];
    mesh.normals[next] = mesh.normals[v];
    mesh.tangents[next] = mesh.tangents[v];
    mesh.file_vertex[next] = next;
    place[v] = next++;
  }
  mesh.positions.resize(next);
  mesh.normals.resize(next);
  mesh.tangents.resize(next);
  mesh.file_vertex.resize(next);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t)
      if (v >= first) v = place[v];
}

void move_vertices(TriangleMesh& mesh, std::uint32_t first, const Eigen::Quaterniond& rotation,
                   const Vector3d& translation) {
  for (size_t v = first; v < mesh.positions.size(); ++v) {
    mesh.positions[v] = (rotation * mesh.positions[v].cast<double>() + translation).cast<float>();
    mesh.normals[v] = (rotation * mesh.normals[v].cast<double>()).normalized().cast<float>();
    mesh.tangents[v] = (rotation * mesh.tangents[v].cast<double>()).normalized().cast<float>();
  }
}

}  // namespace burnish
