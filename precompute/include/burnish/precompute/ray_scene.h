#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "burnish/shading/transfer.h"

namespace burnish {

/// The nearest hit of a ray.
struct RayHit {
  std::uint32_t mesh;      ///< index in the order of add_mesh
  std::uint32_t triangle;  ///< index in that mesh
  float u, v;              ///< barycentric: position = (1 - u - v) p0 + u p1 + v p2
  float distance;          ///< world units
};

/// Triangle meshes to cast rays at. Coordinates are world units at every call; inside, the scene is
/// moved and scaled to unit size (by a power of two), so that a mesh of size 1e-6 and one of size
/// 1e6 behave alike. Triangles are hit from both sides.
///
/// - A triangle with a corner that is not finite, or beyond 1e30 on some axis, is never hit; nor is
///   one without area. Both keep their number.
/// - A ray whose origin is not finite (in scene units) hits nothing; nor does any ray in a scene
/// that has no
///   triangles or was not committed.
/// - No ray passes between two triangles that share an edge; one aimed at a shared corner to within
///   float rounding may (Embree's robust mode leaves that crack).
///
/// Building throws burnish::Error; the queries are thread-safe and do not throw.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Copies the mesh. Call before commit(). Throws Error when an index is not below
  /// positions.size().
  void add_mesh(std::span<const Vector3f> positions, std::span<const Triangle> triangles);

  /// Builds the scene; call once.
  void commit();

  /// Distance, in world units, by which a ray's origin should leave a surface: 2^-16 of the scene's
  /// size, and never less than what a coordinate of the scene can resolve. 0 before commit().
  float origin_offset() const;

  /// First hit along a unit direction. Returns false, and leaves `hit`, if there is none.
  bool intersect(const Vector3f& origin, const Vector3f& direction, RayHit& hit) const;

  /// Whether anything lies along a unit direction nearer than `max_distance` (infinity for distant
  /// lights).
  bool occluded(const Vector3f& origin, const Vector3f& direction, float max_distance) const;

  /// Sixteen coherent rays from one origin; `x`, `y`, `z` hold the unit directions' components,
  /// 64-byte aligned. Bit i of the result is set where direction i is occluded; bits not in
  /// `active` are 0.
  std::uint32_t occluded16(const Vector3f& origin, const float* x, const float* y, const float* z,
                           std::uint32_t active) const;

  /// Whether it is certain that no ray from `origin` into a direction above the horizon of the unit
  /// `normal` hits anything: no triangle reaches above the plane through the origin.
  bool hemisphere_is_empty(const Vector3f& origin, const Vector3f& normal) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace burnish
