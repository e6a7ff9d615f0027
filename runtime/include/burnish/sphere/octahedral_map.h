#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/direction.h"

/// Based on: the equal-area octahedral map (clarberg2008equalarea). The unit square covers the
/// sphere, equal areas to equal solid angles: a texel of an N x N map covers exactly 4 pi / N^2 sr.
/// The centre of the square is +z, its four corners are -z, and u and v grow with x and y.
namespace burnish {

/// Direction of a point of the square. `u`, `v` in [0, 1].
template <class T>
Vector3<T> octahedral_to_direction(T u, T v) {
  const T s = 2 * u - 1, t = 2 * v - 1;
  const T up = std::abs(s), vp = std::abs(t);
  const T signed_distance = 1 - (up + vp);
  const T r = 1 - std::abs(signed_distance);
  const T phi = (r == 0 ? T(1) : (vp - up) / r + 1) * kPi<T> / 4;
  const T radius = r * std::sqrt(2 - r * r);
  return {std::copysign(std::cos(phi) * radius, s), std::copysign(std::sin(phi) * radius, t),
          std::copysign(1 - r * r, signed_distance)};
}

/// Point of the square, in [0, 1]^2, of a unit direction.
template <class T>
Vector2<T> direction_to_octahedral(const Vector3<T>& d) {
  const T x = std::abs(d.x()), y = std::abs(d.y()), z = std::abs(d.z());
  const T r = std::sqrt((x * x + y * y) / (1 + z));  // sqrt(1 - z) without its cancellation
  const T large = std::max(x, y), small = std::min(x, y);
  T phi = large == 0 ? T(0) : std::atan(small / large) * (2 / kPi<T>);
  if (x < y) phi = 1 - phi;
  T v = phi * r, u = r - v;
  if (std::signbit(d.z())) {
    std::swap(u, v);
    u = 1 - u;
    v = 1 - v;
  }
  u = std::copysign(u, d.x());
  v = std::copysign(v, d.y());
  return {std::clamp((u + 1) / 2, T(0), T(1)), std::clamp((v + 1) / 2, T(0), T(1))};
}

/// Derivatives of octahedral_to_direction by u and by v (both tangent to the sphere; the area they
/// span is 4 pi everywhere). At the two poles and on the folds, the limit from inside the quadrant
/// is returned.
template <class T>
struct OctahedralTangents {
  Vector3<T> du, dv;
};

template <class T>
OctahedralTangents<T> octahedral_tangents(T u, T v) {
  const T s = 2 * u - 1, t = 2 * v - 1;
  const T sign_u = std::copysign(T(1), s), sign_v = std::copysign(T(1), t);
  // The poles have no derivative: step off by a distance far below a texel of any map.
  constexpr T kStep = T(1e-6);
  const T up = std::clamp(std::abs(s), kStep, 1 - kStep);
  const T vp = std::clamp(std::abs(t), kStep, 1 - kStep);
  const bool upper = up + vp <= 1;
  const T r = upper ? up + vp : std::max(2 - up - vp, T(1e-6));
  const T phi = ((vp - up) / r + 1) * kPi<T> / 4;
  const T root = std::sqrt(2 - r * r);
  const T radius = r * root;
  const T radius_r = (2 - 2 * r * r) / root;
  const T r_p = upper ? T(1) : T(-1);  // dr/dup = dr/dvp
  const T phi_u = -kPi<T> / 2 * (upper ? vp : 1 - vp) / (r * r);
  const T phi_v = kPi<T> / 2 * (upper ? up : 1 - up) / (r * r);
  const T z_p = -2 * r;  // upper: z = 1 - r^2 with dr = +1; lower: z = r^2 - 1 with dr = -1
  const T c = std::cos(phi), sn = std::sin(phi);
  OctahedralTangents<T> d;
  d.du = 2 * Vector3<T>(radius_r * r_p * c - radius * sn * phi_u,
                        sign_u * sign_v * (radius_r * r_p * sn + radius * c * phi_u), sign_u * z_p);
  d.dv = 2 * Vector3<T>(sign_u * sign_v * (radius_r * r_p * c - radius * sn * phi_v),
                        radius_r * r_p * sn + radius * c * phi_v, sign_v * z_p);
  return d;
}

/// Tangent-plane gradient at `direction` (per radian) of a function given by its derivatives by u
/// and v.
template <class T>
Vector3<T> octahedral_gradient(const Vector3<T>& direction, const Vector2<T>& uv, T by_u, T by_v) {
  const OctahedralTangents<T> d = octahedral_tangents(uv.x(), uv.y());
  const Vector3<T> normal = d.du.cross(d.dv);
  const T orientation = normal.dot(direction);  // +-4 pi
  return (by_u * d.dv.cross(direction) + by_v * direction.cross(d.du)) / orientation;
}

/// Direction of the centre of texel (x, y) of an N x N map. Row-major index: y * N + x.
template <class T>
Vector3<T> octahedral_texel_direction(int x, int y, int resolution) {
  return octahedral_to_direction<T>((x + T(0.5)) / resolution, (y + T(0.5)) / resolution);
}

/// Index of texel (x, y), each in [-N, 2N), with the octahedral map's wrap: leaving through an edge
/// comes back through the same edge, mirrored.
inline int octahedral_wrap(int x, int y, int resolution) {
  if (x < 0 || x >= resolution) {
    x = x < 0 ? -1 - x : 2 * resolution - 1 - x;
    y = resolution - 1 - y;
  }
  if (y < 0 || y >= resolution) {
    y = y < 0 ? -1 - y : 2 * resolution - 1 - y;
    x = resolution - 1 - x;
  }
  return y * resolution + x;
}

/// The four texels and weights of a bilinear lookup.
template <class T>
struct OctahedralFootprint {
  int texel[4];   ///< (x0,y0), (x1,y0), (x0,y1), (x1,y1)
  T weight[4];    ///< sums to one
  T weight_u[4];  ///< derivative of the weights by u
  T weight_v[4];  ///< derivative of the weights by v
};

template <class T>
OctahedralFootprint<T> octahedral_footprint(const Vector2<T>& uv, int resolution) {
  const T px = uv.x() * resolution - T(0.5), py = uv.y() * resolution - T(0.5);
  const T floor_x = std::floor(px), floor_y = std::floor(py);
  const int x = static_cast<int>(floor_x), y = static_cast<int>(floor_y);
  const T fx = px - floor_x, fy = py - floor_y;
  const T n = static_cast<T>(resolution);
  return {{octahedral_wrap(x, y, resolution), octahedral_wrap(x + 1, y, resolution),
           octahedral_wrap(x, y + 1, resolution), octahedral_wrap(x + 1, y + 1, resolution)},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy},
          {-n * (1 - fy), n * (1 - fy), -n * fy, n * fy},
          {-n * (1 - fx), -n * fx, n * (1 - fx), n * fx}};
}

}  // namespace burnish
