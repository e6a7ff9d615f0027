#include "harness/surface_grid.h"

#include "harness/mesh_building.h"

namespace burnish {
namespace {

struct Place {
  Vector3d position, du, dv, normal;
};

Place place_at(const Surface& surface, double u, double v) {
  // The error of a central difference, step^2, and that of its roundings, 1e-16 / step, are equal.
  constexpr double kStep = 5e-6;
  Place place;
  place.position = surface(u, v);
  place.du = (surface(u + kStep, v) - surface(u - kStep, v)) / (2 * kStep);
  place.dv = (surface(u, v + kStep) - surface(u, v - kStep)) / (2 * kStep);
  place.normal = place.du.cross(place.dv).normalized();
  return place;
}

/// One edge of a sheet, from `from` to `to` in the parameters, the sheet on its left.
void append_edge(TriangleMesh& mesh, const Surface& middle, double thickness,
                 const Vector2<double>& from, const Vector2<double>& to, int cells) {
  const std::uint32_t first = next_vertex(mesh);
  const Vector2<double> along = to - from;
  for (const double side : {-0.5, 0.5})
    for (int i = 0; i <= cells; ++i) {
      const Vector2<double> at = (from * double(cells - i) + to * double(i)) / double(cells);
      const Place place = place_at(middle, at.x(), at.y());
      const Vector3d tangent = along.x() * place.du + along.y() * place.dv;
      append_vertex(mesh, place.position + side * thickness * place.normal,
                    tangent.cross(place.normal), tangent);
    }
  append_cells(mesh, first, cells + 1, 2);
}

}  // namespace

void append_surface(TriangleMesh& mesh, const Surface& surface, const SurfaceCells& cells) {
  const std::uint32_t first = next_vertex(mesh);
  const int columns = cells.u + (cells.wrap_u ? 0 : 1), rows = cells.v + (cells.wrap_v ? 0 : 1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Place place = place_at(surface, double(column) / cells.u, double(row) / cells.v);
      append_vertex(mesh, place.position, place.normal, place.du);
    }
  append_cells(mesh, first, columns, rows, cells.wrap_u, cells.wrap_v);
}

void append_sheet(TriangleMesh& mesh, const Surface& middle, double thickness,
                  const SurfaceCells& cells) {
  for (const double side : {0.5, -0.5}) {
    const std::uint32_t first = next_vertex(mesh);
    for (int row = 0; row <= cells.v; ++row)
      for (int i = 0; i <= cells.u; ++i) {
        const int column = side > 0 ? i : cells.u - i;  // the other side turns the other way
        const Place place = place_at(middle, double(column) / cells.u, double(row) / cells.v);
        append_vertex(mesh, place.position + side * thickness * place.normal, side * place.normal,
                      place.du);
      }
    append_cells(mesh, first, cells.u + 1, cells.v + 1);
  }
  append_edge(mesh, middle, thickness, {0, 0}, {1, 0}, cells.u);
  append_edge(mesh, middle, thickness, {1, 0}, {1, 1}, cells.v);
  append_edge(mesh, middle, thickness, {1, 1}, {0, 1}, cells.u);
  append_edge(mesh, middle, thickness, {0, 1}, {0, 0}, cells.v);
}

}  // namespace burnish
