#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "burnish/precompute/visibility_mask.h"

namespace burnish {

/// Finds what a vertex sees with a small part of the rays that sample_visibility casts: it samples
/// coarsely and refines, level by level, where the visibility changes.
///
///     const VisibilitySampler sampler(scene, DirectionTable(512), 64);
///     VisibilitySampler::Scratch scratch;  // one a thread
///     VisibilityMask mask(512);
///     sampler.sample(position + scene.origin_offset() * normal, normal, mask, scratch);
///
/// - At each level a cell is cast unless the coarser samples around it agree; and then, until none
///   is left, every cell that was not cast and has another visibility than one of its four
///   neighbours. So both sides of each edge of the result have been cast, and an edge that was
///   found is followed to its end, however thin it gets.
/// - What can be missed is what lies wholly between the coarsest samples: a feature narrower than
///   sqrt(4 pi) / coarsest rad, which no coarser sample met.
/// - Below the horizon everything is occluded and nothing is cast. Each block of 8 x 8 texels that
///   the horizon touches costs one ray, just above the horizon; where nothing occludes there, the
///   horizon causes no refinement.
/// - A vertex with nothing above its tangent plane costs no ray (RayScene::hemisphere_is_empty).
class VisibilitySampler {
 public:
  static constexpr int kDefaultCoarsest = 64;

  /// Memory to be reused from one call to the next.
  class Scratch {
   public:
    Scratch();
    ~Scratch();
    Scratch(Scratch&&) noexcept;
    Scratch& operator=(Scratch&&) noexcept;

   private:
    friend class VisibilitySampler;
    struct State;
    std::unique_ptr<State> state_;
  };

  /// `coarsest`: resolution of the first samples, a power of two in 16..finest.resolution(); with
  /// finest.resolution() everything above the horizon is cast. The table's resolution is a power of
  /// two, 64 at least. Throws Error otherwise. Scene and table must outlive the sampler.
  VisibilitySampler(const RayScene& scene, const DirectionTable& finest, int coarsest);

  /// Rays leave from `origin`, a point just above the surface, into the directions strictly above
  /// the horizon of the unit `normal`. Fills `mask`, of the table's resolution. Returns the number
  /// of rays cast. Thread-safe with a scratch for each thread; the result depends on nothing else.
  std::uint64_t sample(const Vector3f& origin, const Vector3f& normal, VisibilityMask& mask,
                       Scratch& scratch) const;

  int coarsest() const { return coarsest_; }

 private:
  // Eight by eight texels of the finest map: their mean direction, and the cosine to `normal`
  // beyond which all of them are on one side of the horizon.
  struct Blocks {
    std::vector<float> x, y, z, margin;
  };

  class Pass;  // of one vertex

  const RayScene& scene_;
  const DirectionTable& finest_;
  int coarsest_;
  Blocks blocks_;
  float pitch_ = 0;  // largest distance of neighbouring directions
};

/// How a sampler's result compares with casting every ray.
struct VisibilityCheck {
  std::uint64_t directions = 0;  ///< compared: the texels of the map
  std::uint64_t differing = 0;   ///< of them, with another visibility
  std::uint64_t sampler_rays = 0;
  std::uint64_t all_rays = 0;  ///< that casting everything takes

  VisibilityCheck& operator+=(const VisibilityCheck& other);
};

/// Samples one vertex both ways. `sampled` and `truth` receive the two masks, of the table's
/// resolution.
VisibilityCheck check_visibility(const RayScene& scene, const DirectionTable& finest,
                                 const VisibilitySampler& sampler, const Vector3f& origin,
                                 const Vector3f& normal, VisibilityMask& sampled,
                                 VisibilityMask& truth, VisibilitySampler::Scratch& scratch);

}  // namespace burnish
