#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/precompute/ray_scene.h"

namespace burnish {

/// Vertices that are not where a vertex can see from. Each is counted once, as the first that fits:
///
/// - covered: another surface, facing the same way, lies above the ray's origin and within 8
///   offsets of the vertex (a decal under its wall). A larger offset takes the origin past it.
/// - pierced: within an offset of the vertex, above or below, lies another surface that faces the
///   other way (a box that stands in a floor): rays start on its wrong side. A gap helps, or a
///   smaller offset. Of surfaces that coincide exactly, one can hide the other from us.
/// - inside: of 64 rays over its hemisphere at least 56 meet the back of a triangle first. No
///   offset helps. A vertex in a body with a wide opening, or beside a single sheet that it should
///   be on the other side of, is not found.
///
/// A triangle's front is the side its normals point to; one that shares its corners' positions with
/// a triangle that faces the other way has two.
enum class Burial { none, covered, pierced, inside };

struct BuriedVertices {
  static constexpr std::size_t kExamples = 8;

  struct Kind {
    std::uint64_t count = 0;
    std::vector<std::uint32_t> first;  ///< the first kExamples vertices
    std::vector<std::uint64_t>
        per_part;  ///< in the order of the receiver's parts; one if it has none
  };
  Kind covered, pierced, inside;

  std::uint64_t count() const { return covered.count + pierced.count + inside.count; }
};

/// Looks for vertices of `receiver` that lie inside or on other geometry. `scene` holds the
/// receiver and then the occluders, in this order; rays leave `origin_offset` (world units; 0:
/// scene.origin_offset()) from the surface. A vertex that cannot be baked (bake.h) or is in no
/// triangle is not counted. 20 rays or so a vertex; same result at any number of threads.
BuriedVertices find_buried_vertices(const RayScene& scene, const TriangleMesh& receiver,
                                    std::span<const TriangleMesh> occluders,
                                    double origin_offset = 0);

}  // namespace burnish
