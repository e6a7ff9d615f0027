#pragma once

#include <cstdint>

#include "burnish/formats/triangle_mesh.h"

namespace burnish {

/// What a subdivision did.
struct SubdivisionReport {
  std::uint64_t added_vertices = 0;
  std::uint64_t added_triangles = 0;
  int rounds = 0;  ///< in which edges were halved
};

/// Halves edges until none is longer than `max_edge` (world units, > 0).
///
/// - An edge is the segment between two positions: where vertices are split for a normal or a UV,
///   all sides halve together, so that no crack and no T-junction opens; the surface stays the
///   same to float rounding. An edge too short for a float between its ends stays.
/// - A new vertex lies at the middle; its normal is the mean, renormalised (that of the lower
///   numbered end where the two cancel); its tangent the mean, as axes, made orthogonal; its UV
///   the mean; its file_vertex kNoFileVertex.
/// - Old vertices keep their order, and come first in their part; triangles take their parent's
///   place. Parts stay contiguous. Edges with an end that is not finite stay.
///
/// Throws Error when more than `max_vertices` would be needed (before it allocates them), when
/// `max_edge` is not > 0, and for an index out of range; the mesh is then as it was.
SubdivisionReport subdivide_long_edges(TriangleMesh& mesh, double max_edge,
                                       std::uint64_t max_vertices = 50'000'000);

}  // namespace burnish
