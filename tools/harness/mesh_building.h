#pragma once

#include <cstdint>

#include "burnish/formats/triangle_mesh.h"

/// What shapes are put together from.
namespace burnish {

inline std::uint32_t next_vertex(const TriangleMesh& mesh) {
  return static_cast<std::uint32_t>(mesh.positions.size());
}

/// The normal and the tangent have any length above 0; the tangent is made orthogonal.
void append_vertex(TriangleMesh& mesh, const Vector3d& position, const Vector3d& normal,
                   const Vector3d& tangent);

/// Two triangles between the vertices a, b (next along the first parameter) and c, d (the same, one
/// step further along the second). Their normal is first x second parameter. What would have two
/// equal vertices or positions is left out.
void append_cell(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                 std::uint32_t d);

/// Cells of a grid of rows x columns vertices that begins at `first`.
void append_cells(TriangleMesh& mesh, std::uint32_t first, int columns, int rows,
                  bool wrap_columns = false, bool wrap_rows = false);

/// Removes the vertices from `first` on that no triangle has.
void drop_unused_vertices(TriangleMesh& mesh, std::uint32_t first);

/// Rotates about the origin, then moves, the vertices from `first` on.
void move_vertices(TriangleMesh& mesh, std::uint32_t first, const Eigen::Quaterniond& rotation,
                   const Vector3d& translation);

}  // namespace burnish
