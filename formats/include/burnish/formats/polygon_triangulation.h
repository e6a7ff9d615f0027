#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/sphere/direction.h"

namespace burnish {

/// Corners of a polygon that read_mesh accepts: ear clipping of a comb takes quadratic time.
inline constexpr size_t kMaxPolygonCorners = 16384;

/// Splits a simple polygon, convex or concave, into n - 2 triangles by ear clipping in the plane of
/// its area vector (Newell). Corner indices, in the polygon's own orientation; corners may lie on a
/// line or repeat (the bridge to a hole); a polygon that crosses itself, or has no area, still
/// gives n - 2 triangles. `triangles` is cleared first. Fewer than three corners give none.
void triangulate_polygon(std::span<const Vector3f> corners,
                         std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace burnish
