#pragma once

#include <span>
#include <vector>

#include "burnish/precompute/visibility_mask.h"

namespace burnish {

/// Turns a visibility mask into a spherical signed distance function (wang2009svbrdf): at every
/// texel centre of a smaller octahedral map the angle to the nearest change of visibility, positive
/// where visible.
///
/// The boundary is a set of points: the midpoint, on the sphere, of every two texels of the mask
/// that are neighbours (left-right or above-below, with the map's wrap) and differ. Over these
/// points the distance is exact (to float rounding). As for the boundary itself, with h the largest
/// angle between neighbours, boundary_pitch(): the true boundary passes within h/2 of every
/// boundary point, so a distance is never more than h/2 too small; and where the true boundary is
/// straight over the size of a texel, it is never more than h too large.
///
/// The sign at a texel centre is that of the mask's texel there; where the centre falls on the
/// common corner of four texels of the mask, that of the majority, and two against two is a
/// distance of zero: the boundary runs through the corner.
class SphericalDistanceTransform {
 public:
  /// `directions`: the mask's texel directions; `resolution`: of the result, 16..the mask's, a
  /// power of two as the mask's is. The table must outlive the transform.
  SphericalDistanceTransform(const DirectionTable& directions, int resolution);

  /// Memory to be reused from one call to the next; one a thread.
  struct Scratch {
    struct Points {
      std::vector<float> x, y, z;  // more than `size` of each
      std::size_t size = 0;
    };
    std::vector<Points> levels;
    std::vector<float> distance;
  };

  /// Writes resolution^2 texels, radians in [-pi, pi]; +-pi when nothing or everything is occluded.
  /// Thread-safe with a scratch for each thread.
  void transform(const VisibilityMask& mask, std::span<float> ssdf, Scratch& scratch) const;

  int resolution() const { return resolution_; }

  /// Largest angle between the centres of neighbouring texels of the mask.
  float boundary_pitch() const { return boundary_pitch_; }

 private:
  // A square of texels of the result, inside a ball around the mean of their directions.
  struct Node {
    Vector3f center;
    float radius;
  };

  void collect_boundary(const VisibilityMask& mask, Scratch::Points& points) const;
  void search(std::size_t level, int x, int y, const VisibilityMask& mask, std::span<float> ssdf,
              Scratch& scratch) const;
  void search_leaf(int x, int y, const Scratch::Points& points, const VisibilityMask& mask,
                   std::span<float> ssdf) const;
  int sign(int x, int y, const VisibilityMask& mask) const;

  const DirectionTable& directions_;
  int resolution_;
  float boundary_pitch_ = 0;
  std::vector<Vector3f> texels_;           // of the result, row-major
  std::vector<std::vector<Node>> levels_;  // [level][2^level x 2^level], the finest of kLeaf texels
};

}  // namespace burnish
