#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/direction.h"

/// The six faces of a cube as charts of the sphere. Each is smooth beyond its own edges, so that a
/// filtered map can be sampled there and interpolated up to the edge; the octahedral map has folds.
///
/// A face is named 2 axis + (0: positive, 1: negative); its local frame is the two axes that follow
/// in cyclic order, then the outward one. A coordinate of a face is in [-1, 1]: the tangent u of
/// the angle, stretched toward even texels as (1 + k) u / (1 + k u^2).
namespace burnish {

inline constexpr float kCubeStretch = 0.2f;

inline float stretch_tangent(float u) {
  return (1 + kCubeStretch) * u / (1 + kCubeStretch * u * u);
}

/// The inverse, also beyond a face's edges, in [-1.34, 1.34]: there the stretch turns back.
inline double tangent_of_stretched(double x) {
  constexpr double k = kCubeStretch;
  return 2 * x / ((1 + k) + std::sqrt((1 + k) * (1 + k) - 4 * k * x * x));
}

struct CubePoint {
  int face;
  float x, y;  ///< in [-1, 1]
};

inline CubePoint cube_from_direction(const Vector3f& direction) {
  const Vector3f size = direction.cwiseAbs();
  const int axis =
      size.x() >= size.y() ? (size.x() >= size.z() ? 0 : 2) : (size.y() >= size.z() ? 1 : 2);
  const float outward = size[axis];
  const float s = direction[(axis + 1) % 3], t = direction[(axis + 2) % 3];
  const float square = outward * outward, scale = (1 + kCubeStretch) * outward;
  return {2 * axis + (direction[axis] < 0 ? 1 : 0), scale * s / (square + kCubeStretch * s * s),
          scale * t / (square + kCubeStretch * t * t)};
}

/// Unit direction in a face's local frame.
inline Vector3d face_direction(double x, double y) {
  return Vector3d(tangent_of_stretched(x), tangent_of_stretched(y), 1).normalized();
}

/// Solid angle per area of a face's coordinates.
inline double face_density(double x, double y) {
  constexpr double k = kCubeStretch;
  const double u = tangent_of_stretched(x), v = tangent_of_stretched(y);
  const auto slope = [](double tangent) {  // of the stretch
    const double root = 1 + k * tangent * tangent;
    return (1 + k) * (1 - k * tangent * tangent) / (root * root);
  };
  const double length = std::sqrt(1 + u * u + v * v);
  return 1 / (slope(u) * slope(v) * length * length * length);
}

inline Vector3f face_to_world(int face, const Vector3f& local) {
  const int axis = face / 2;
  Vector3f world;
  world[axis] = face % 2 == 0 ? local.z() : -local.z();
  world[(axis + 1) % 3] = local.x();
  world[(axis + 2) % 3] = local.y();
  return world;
}

inline Vector3f world_to_face(int face, const Vector3f& world) {
  const int axis = face / 2;
  return {world[(axis + 1) % 3], world[(axis + 2) % 3], face % 2 == 0 ? world[axis] : -world[axis]};
}

}  // namespace burnish
