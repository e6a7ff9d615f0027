#pragma once

#include <span>

#include "burnish/formats/triangle_mesh.h"

/// Parametric shapes with exact normals. Each function appends to a mesh; triangles turn
/// counter-clockwise seen from the side the normals point to.
namespace burnish {

/// A point of a profile that turns about the y axis.
struct ProfilePoint {
  double radius;         ///< distance from the axis, >= 0; 0 at the first and last point closes it
  double height;         ///< along y
  double normal_radius;  ///< unit normal in the (radius, height) half-plane
  double normal_height;
};

/// Surface of revolution about the y axis. With the profile listed so that its normals lie on its
/// right (from the bottom pole to the top one for a body), triangles and normals agree. Tangents
/// run along the profile: across the grooves of a turned or brushed surface. A point on the axis
/// becomes one vertex a segment, each with the tangent of its own triangle, as there is no
/// direction they could share.
void append_revolution(TriangleMesh& mesh, std::span<const ProfilePoint> profile, int segments);

/// Parallelogram of cells_u x cells_v cells, normal edge_u x edge_v, tangent edge_u (the edges
/// orthogonal).
void append_rectangle(TriangleMesh& mesh, const Vector3f& corner, const Vector3f& edge_u,
                      const Vector3f& edge_v, int cells_u, int cells_v);

/// Horizontal square around the origin at y = 0, normal +y, tangent +x, of cells x cells cells,
/// finer toward its middle: the cells there are `center_scale` (0..1) of an even grid's.
void append_floor(TriangleMesh& mesh, double half_size, int cells, double center_scale);

/// Sphere as a surface of revolution about the vertical through `center`.
void append_sphere(TriangleMesh& mesh, const Vector3f& center, double radius, int segments,
                   int rings);

/// Rings of a cylinder: of each flat end but its edge, of each rounded edge, and of its side.
struct CylinderRings {
  int disc = 8, bevel = 6, side = 40;
};

/// Closed cylinder about the y axis that stands on y = 0, its edges rounded by `bevel`, which is
/// below radius and height / 2.
void append_cylinder(TriangleMesh& mesh, double radius, double height, double bevel,
                     const CylinderRings& rings, int segments);

/// Tube of round section along the (2, 3) torus knot about the y axis; tangents run along it.
void append_torus_knot(TriangleMesh& mesh, const Vector3f& center, double major_radius,
                       double minor_radius, double tube_radius, int steps, int segments);

/// Shallow plate with a flat, raised brim and a round rim, one closed surface about the y axis, of
/// outer radius 1 and thickness `thickness`; its underside is at y = `base`.
void append_dish(TriangleMesh& mesh, double base, double thickness, int segments);

}  // namespace burnish
