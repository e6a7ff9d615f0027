#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/precompute/visibility_mask.h"

namespace burnish {

/// Turns a visibility mask into a spherical signed distance function (wang2009svbrdf): at every
/// texel centre of a smaller octahedral map the angle to the nearest change of visibility, positive
/// where visible.
///
/// The boundary is a set of points: on the octahedral map, the middle of the edge that two texels
/// of the mask share (left-right or above-below, with the map's wrap) where they differ. No point
/// is nearer than the one found, but for float rounding: a distance d is off by at most
/// 1e-6 / sin d, and never by more than 1e-3. As for the boundary itself,
/// with h the boundary_pitch(): the true boundary passes within h/2 of every boundary point, so a
/// distance is never more than h/2 too small; and where the true boundary is straight over the size
/// of a texel, it is never more than h too large.
///
/// The sign at a texel centre is that of the mask's texel there; where the centre falls on the
/// common corner of four texels of the mask, that of the majority, and two against two is a
/// distance of zero: the boundary runs through the corner.
class SphericalDistanceTransform {
 public:
  /// `directions`: of the mask; `resolution`: of the result, 16..the mask's, a power of two as the
  /// mask's is.
  SphericalDistanceTransform(const DirectionTable& directions, int resolution);

  /// Memory to be reused from one call to the next; one a thread. Arrays have room for more than
  /// what they hold, so that vectors can be loaded and stored beyond the end.
  struct Scratch {
    /// Boundary points near each other, in a ball around one of them.
    struct Cells {
      std::vector<float> x, y, z, radius;
      std::vector<std::uint32_t> index;
      std::size_t size = 0;
    };
    std::vector<std::uint32_t> places;      // of the boundary points, on the map
    std::vector<std::uint32_t> cell_begin;  // first point of each cell, and one past the last
    std::vector<float> x, y, z;             // of the boundary points
    std::vector<Cells> levels;
    std::vector<float> cosines;
    std::vector<float> local_x, local_y, local_z, local_square;
    std::vector<float> signs;
  };

  /// Writes resolution^2 texels, radians in [-pi, pi]; +-pi when nothing or everything is occluded.
  /// Thread-safe with a scratch for each thread.
  void transform(const VisibilityMask& mask, std::span<float> ssdf, Scratch& scratch) const;

  int resolution() const { return texels_.resolution(); }

  /// Twice the largest angle from a boundary point to the centres of the two texels it parts, over
  /// the whole map: about the largest angle between neighbours.
  float boundary_pitch() const { return boundary_pitch_; }

  /// A square of texels of the result, inside a ball around the mean of their directions.
  struct Square {
    Vector3f center;
    float radius;
  };

 private:
  DirectionTable texels_;
  float boundary_pitch_ = 0;
  std::vector<std::vector<Square>> levels_;  // [level], row-major; the finest of 8 x 8 texels
};

}  // namespace burnish
