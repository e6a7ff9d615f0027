#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/precompute/ray_scene.h"

namespace burnish {

/// Vertices that are not where a vertex can see from.
struct BuriedVertices {
  static constexpr std::size_t kExamples = 8;

  struct Part {
    std::uint64_t inside = 0, touching = 0;
  };
  std::uint64_t inside = 0;    ///< within a body, or behind a surface that covers them
  std::uint64_t touching = 0;  ///< on or just under another surface, and not inside
  std::vector<std::uint32_t> first_inside, first_touching;  ///< the first kExamples of each
  std::vector<Part> parts;  ///< in the order of the receiver's parts; one if it has none
};

/// Looks for vertices of `receiver` that lie inside or on other geometry. `scene` holds the
/// receiver and then the occluders, in this order; rays leave `origin_offset` (world units; 0:
/// scene.origin_offset()) from the surface. Same result at any number of threads.
///
/// - Inside: of 64 rays over the vertex's hemisphere at least 56 meet the back of a triangle first.
///   The front is the side its normals point to. A vertex below a single sheet that does not fill
///   its view, or sunk beside one, is not found; nor is one in a body with several openings.
/// - Touching: another triangle crosses the normal within 8 offsets above the vertex or one below.
///   Of surfaces that coincide exactly, one can hide the other.
///
/// A vertex that cannot be baked (bake.h) is neither.
BuriedVertices find_buried_vertices(const RayScene& scene, const TriangleMesh& receiver,
                                    std::span<const TriangleMesh> occluders,
                                    double origin_offset = 0);

}  // namespace burnish
