#pragma once

#include <cstdint>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/precompute/progress.h"
#include "burnish/precompute/ray_scene.h"
#include "burnish/precompute/subdivision.h"

namespace burnish {

/// How differently the corners of a mesh's triangles see: the share, 0..1, of the directions above
/// both horizons in which one of two neighbours sees and the other does not. 32^2 directions over
/// the sphere, so a step of about 1/512.
struct DensityReport {
  struct Triangle {
    std::uint32_t triangle = 0;
    float difference = 0;  ///< the largest of its edges
  };
  double threshold = 0;
  std::uint64_t triangles = 0;  ///< looked at: with area and three usable corners
  std::uint64_t exceeding = 0;  ///< whose difference is above the threshold
  double exceeding_area = 0;    ///< their share of the area looked at
  double mean_difference = 0;   ///< over the area
  std::vector<Triangle> worst;  ///< by falling difference, then rising number
};

/// Triangles whose corners differ by more than this are worth a note: none of a mesh whose shadow
/// boundaries are resolved, a quarter of the area of one of large polygons in a building.
inline constexpr double kDensityThreshold = 0.2;

/// Looks at every triangle of `mesh`, whose rays leave `origin_offset` (world units; 0:
/// scene.origin_offset()) from the surface. 512 rays or so a vertex; same result at any number of
/// threads. `progress`: stage "density", in vertices. Throws Cancelled.
DensityReport check_density(const TriangleMesh& mesh, const RayScene& scene,
                            double threshold = kDensityThreshold, double origin_offset = 0,
                            std::size_t worst = 5, const Progress& progress = {});

/// The shortest edge a refinement makes by default, as a share of the mesh's largest extent.
inline constexpr double kDefaultMinEdge = 1.0 / 512;

/// Dials of a refinement.
struct RefinementOptions {
  double max_difference = 0.1;  ///< > 0; edges whose ends, or end and middle, differ more: halved
  double min_edge = 0;  ///< world units: no edge is halved into shorter ones; 0: kDefaultMinEdge
  std::uint64_t max_vertices = 10'000'000;  ///< of the refined mesh
  double origin_offset = 0;                 ///< world units; 0: scene.origin_offset()
};

struct RefinementReport : SubdivisionReport {
  std::uint64_t rays = 0;
  std::uint64_t left = 0;        ///< edges that still differ: too short, or no vertices left
  bool out_of_vertices = false;  ///< max_vertices did not suffice: what differs most went first
};

/// Halves the edges across which visibility changes, again and again: shadow boundaries need
/// vertices. An edge of at least 2 min_edge is also looked at in its middle, so that a small
/// occluder between two open ends is found. Where an edge of a triangle is halved, so is its
/// longest (rivara1984), which keeps angles above half of what they were. The surface does not
/// change (subdivide_long_edges says how vertices come about). `scene` holds the mesh and its
/// occluders.
///
/// Same result at any number of threads. `progress`: stage "refine", in vertices and middles of the
/// round; Cancelled leaves the mesh as it was. Throws Error for options out of range.
RefinementReport refine_by_visibility(TriangleMesh& mesh, const RayScene& scene,
                                      const RefinementOptions& options,
                                      const Progress& progress = {});

}  // namespace burnish
