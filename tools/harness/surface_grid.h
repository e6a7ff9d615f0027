#pragma once

#include <functional>

#include "burnish/formats/triangle_mesh.h"

namespace burnish {

/// A smooth surface over parameters 0..1; it goes on a little beyond them.
using Surface = std::function<Vector3d(double u, double v)>;

/// Cells along each parameter. A wrapped one ends where it begins.
struct SurfaceCells {
  int u = 1, v = 1;
  bool wrap_u = false, wrap_v = false;
};

/// Appends a grid of a surface. Normals are along du x dv and tangents along du, by central
/// differences: exact to 1e-7 rad for a surface of about unit size without details below 1e-2.
void append_surface(TriangleMesh& mesh, const Surface& surface, const SurfaceCells& cells);

/// Appends a sheet: a surface that is given a thickness to both of its sides, and edges that are
/// flat across it. A closed body. Nothing wraps; `thickness` is below twice the least radius of
/// curvature.
void append_sheet(TriangleMesh& mesh, const Surface& middle, double thickness,
                  const SurfaceCells& cells);

}  // namespace burnish
