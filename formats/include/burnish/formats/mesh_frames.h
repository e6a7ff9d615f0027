#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/shading/transfer.h"

namespace burnish {

/// The axis of a mesh file that points up.
enum class UpAxis { x, y, z };

Vector3f up_direction(UpAxis axis);

/// Unit vertex normals: the sum over a vertex's triangles of the triangle's normal, times its area,
/// times its angle at the vertex.
///
/// - `shared`, #V or empty: vertices with equal values (TriangleMesh::file_vertex) are one vertex
///   to the sum, so that a UV seam does not show.
/// - Where the sum cancels (a sheet with two sides), the vertex takes the normal of its largest
///   triangle.
/// - Where there is no triangle of non-zero area, it takes `fallback` (unit); `fallbacks`, if
///   given, receives how often.
std::vector<Vector3f> compute_normals(std::span<const Vector3f> positions,
                                      std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> shared = {},
                                      const Vector3f& fallback = Vector3f::UnitY(),
                                      std::uint64_t* fallbacks = nullptr);

/// A tangent that follows the normal without any UVs: a fixed horizontal axis (x; for `up` x: y),
/// carried by the smallest rotation that takes `up` to `normal`. Unit, orthogonal to the normal,
/// and continuous but for one point, normal = -up (hairy ball: no rule does better than one
/// singular point), where it is that axis.
Vector3f tangent_from_up(const Vector3f& normal, UpAxis up);

/// Unit tangents, orthogonal to the unit `normals`: the direction on the surface in which u grows,
/// averaged over a vertex's triangles by the angle at the vertex. Where there are no UVs (`uvs`
/// empty), or they are not finite, or they say nothing about the direction, tangent_from_up.
///
/// - `uvs`: #V or empty.
/// - Contributions are averaged as axes, i.e. up to sign: where UVs are mirrored the two sides'
///   directions are opposite and would cancel, and a brushed surface has no sign.
/// - `fallbacks`, if given, receives how many vertices took tangent_from_up.
std::vector<Vector3f> compute_tangents(std::span<const Vector3f> positions,
                                       std::span<const Vector3f> normals,
                                       std::span<const Eigen::Vector2f> uvs,
                                       std::span<const Triangle> triangles, UpAxis up = UpAxis::y,
                                       std::uint64_t* fallbacks = nullptr);

/// Whether a triangle has no area: twice the area is within the rounding of double arithmetic of
/// zero, or a corner is not finite.
bool is_degenerate(const Vector3f& a, const Vector3f& b, const Vector3f& c);

}  // namespace burnish
