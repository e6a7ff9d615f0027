#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "burnish/material/varying_material.h"
#include "burnish/precompute/ray_scene.h"
#include "burnish/shading/prepared_transfer.h"
#include "burnish/sphere/frame.h"
#include "harness/camera.h"

/// What every picture of a transfer shares, so that a baked one and its reference differ in the
/// shading only: the primary rays, the surface points they meet, and the rules for normals that
/// face away from the viewer.
namespace burnish {

/// The geometry of a transfer, ready for rays. Move-only.
class SceneRays {
 public:
  /// Copies the geometry; throws Error.
  explicit SceneRays(const Transfer& transfer);
  /// What a camera sees: the receiver.
  const RayScene& visible() const { return visible_; }
  /// What casts shadows: the receiver and the occluders.
  const RayScene& shadowing() const { return shadowing_ ? *shadowing_ : visible_; }

 private:
  RayScene visible_;
  std::optional<RayScene> shadowing_;  // absent when it would equal visible_
};

/// A material that varies over UV, and the same by vertex.
struct VaryingSubject {
  MaterialMaps maps;
  MaterialArrays vertices;
};

/// Samples the maps at the transfer's vertices, in parallel. Throws std::invalid_argument for a
/// transfer without texture coordinates.
VaryingSubject varying_subject(const Transfer& transfer, MaterialMaps maps);

/// What is to be shaded.
struct Subject {
  const Transfer* transfer = nullptr;         ///< never null
  std::span<const Material> materials;        ///< one or more
  std::span<const std::uint8_t> material_id;  ///< #V, or empty: all vertices have materials[0]

  /// Over materials[0]; null: nothing varies. Then there are no ids.
  const VaryingSubject* varying = nullptr;
  /// Of `transfer`: what the runtime shades. The truth does without.
  const PreparedTransfer* prepared = nullptr;

  size_t material_of(size_t vertex) const { return material_id.empty() ? 0 : material_id[vertex]; }
  const Material& vertex_material(size_t vertex) const { return materials[material_of(vertex)]; }
};

/// A camera, the pixels and the antialiasing: samples_per_axis^2 samples on a regular grid in each
/// pixel, box filtered.
struct View {
  Camera camera;
  int width = 720;
  int height = 480;
  int samples_per_axis = 2;  ///< 1..16
};

/// Where a primary ray met the receiver. Barycentric as in RayHit.
struct PrimaryHit {
  static constexpr std::uint32_t kMiss = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t triangle = kMiss;
  float u = 0, v = 0;
};

/// All primary rays of a view, 12 bytes each.
struct PrimaryHits {
  View view;
  std::vector<PrimaryHit> hits;  ///< [height][width][samples_per_axis^2]
  double trace_ms = 0;           ///< wall clock

  size_t samples_per_pixel() const {
    return static_cast<size_t>(view.samples_per_axis) * static_cast<size_t>(view.samples_per_axis);
  }
  /// The samples of a pixel, `pixel` = y * width + x.
  std::span<const PrimaryHit> pixel_hits(size_t pixel) const {
    return std::span(hits).subspan(pixel * samples_per_pixel(), samples_per_pixel());
  }
  /// Direction of a sample's ray.
  Vector3f direction(const PrimaryRays& rays, size_t pixel, size_t sample) const;
};

/// In parallel.
PrimaryHits trace_primary_rays(const SceneRays& rays, const View& view);

/// A point of the receiver, interpolated over a triangle. The tangents' signs are made to agree
/// first: a BRDF does not see them, and opposite ones would cancel.
struct SurfacePoint {
  Vector3f position;
  Frame<float> frame;             ///< x tangent, z shading normal
  Triangle vertices{};            ///< of the triangle
  std::array<float, 3> weight{};  ///< barycentric
  bool front = true;  ///< the viewer is on the side of the triangle that the shading normal is on
};

/// The point of a hit, as seen from `eye`.
SurfacePoint surface_point(const Transfer& transfer, const PrimaryHit& hit, const Vector3f& eye);

/// The material at a point, averaged over what a sample sees of the surface, and the frame to shade
/// it with; `sample_angle_rad` is between the rays of neighbouring samples.
SurfaceMaterial surface_material(const Subject& subject, const SurfacePoint& point,
                                 const Vector3f& eye, float sample_angle_rad);
SurfaceMaterial vertex_material(const Subject& subject, size_t vertex);

/// Of a view, in the middle of its picture.
float sample_angle_rad(const View& view);

/// Toward the eye from a point, by lift_above_horizon as in shade_vertices: a smooth normal may
/// face away where the surface does not. A surface seen from behind (`front` false) is black
/// instead, in every picture.
Vector3f outgoing_toward(const Vector3f& eye, const Vector3f& position, const Vector3f& normal);

}  // namespace burnish
