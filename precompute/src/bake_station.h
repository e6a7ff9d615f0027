#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "bake_model.h"
#include "burnish/precompute/bake.h"
#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/precompute/visibility_mask.h"
#include "burnish/precompute/visibility_sampler.h"

namespace burnish {

/// What one thread needs for a vertex, and what it has counted.
struct BakeWorker {
  VisibilityMask mask, other_mask;
  VisibilitySampler::Scratch sampler;
  SphericalDistanceTransform::Scratch distance;
  VisibilityRows rows;  ///< of a block
  BakeModel::Scratch projection;
  std::uint64_t rays = 0;
  double rays_s = 0, distance_s = 0, project_s = 0;
};
using BakeWorkers = tbb::enumerable_thread_specific<BakeWorker>;

/// How the sampled visibility of a vertex compares with that of all rays.
struct VertexVerification {
  std::uint64_t directions = 0, differing = 0;
  double worst_ssdf_error_rad = 0;
};

/// From a vertex to its visibility and what is compressed of it: what is the same for all vertices.
class BakeStation {
 public:
  /// Refers to all three.
  BakeStation(const TriangleMesh& receiver, const RayScene& scene, const BakeOptions& options);

  const std::vector<Vector3f>& normals() const { return normals_; }  ///< unit; 0: unusable vertex
  double origin_offset() const { return offset_; }                   ///< world units

  /// Fills worker.mask; returns the number of rays cast.
  std::uint64_t trace(std::uint32_t vertex, BakeWorker& worker) const;

  /// Row `row` of `rows` from a mask, its SSDF as it is.
  void derive(const VisibilityMask& mask, std::size_t row, VisibilityRows& rows,
              BakeWorker& worker) const;

  /// The same, its SSDF encoded for compression.
  void derive_encoded(const VisibilityMask& mask, std::size_t row, VisibilityRows& rows,
                      BakeWorker& worker) const;

  /// Whether a vertex sees all above its horizon, known without a ray.
  bool sees_all(std::uint32_t vertex) const;
  /// Whether the mask has an occluded direction above the vertex's horizon.
  bool is_occluded(std::uint32_t vertex, const VisibilityMask& mask) const;

  VertexVerification verify(std::uint32_t vertex, BakeWorker& worker) const;

 private:
  Vector3f origin(std::uint32_t vertex) const;

  const TriangleMesh& mesh_;
  const RayScene& scene_;
  std::vector<Vector3f> normals_;
  double offset_;
  float amplitude_rad_;
  DirectionTable directions_;
  VisibilitySampler sampler_;
  SphericalDistanceTransform transform_;
};

}  // namespace burnish
