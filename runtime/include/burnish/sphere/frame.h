#pragma once

#include "burnish/sphere/direction.h"

namespace burnish {

/// Right-handed orthonormal frame: x tangent, y bitangent, z normal or lobe axis.
template <class T>
struct Frame {
  Vector3<T> x = Vector3<T>::UnitX();
  Vector3<T> y = Vector3<T>::UnitY();
  Vector3<T> z = Vector3<T>::UnitZ();

  Vector3<T> to_local(const Vector3<T>& v) const { return {v.dot(x), v.dot(y), v.dot(z)}; }
  Vector3<T> to_world(const Vector3<T>& v) const { return v.x() * x + v.y() * y + v.z() * z; }

  template <class U>
  Frame<U> cast() const {
    return {x.template cast<U>(), y.template cast<U>(), z.template cast<U>()};
  }
};

/// Frame around a unit axis, continuous but for the half-plane's edge at z = 0 (duff2017frame).
template <class T>
Frame<T> frame_from_axis(const Vector3<T>& axis) {
  const T sign = std::copysign(T(1), axis.z());
  const T a = T(-1) / (sign + axis.z());
  const T b = axis.x() * axis.y() * a;
  return {{T(1) + sign * axis.x() * axis.x() * a, sign * b, -sign * axis.x()},
          {b, sign + axis.y() * axis.y() * a, -axis.y()},
          axis};
}

/// Frame with z the unit `normal` and x as close to `tangent` as orthogonality allows. A tangent
/// that is zero, not finite or parallel to the normal is replaced by the one of frame_from_axis.
template <class T>
Frame<T> frame_from_normal_tangent(const Vector3<T>& normal, const Vector3<T>& tangent) {
  const Vector3<T> projected = tangent - tangent.dot(normal) * normal;
  const T length = projected.norm();
  if (!(length > T(1e-6) * tangent.norm()) || !std::isfinite(length))
    return frame_from_axis(normal);
  const Vector3<T> x = projected / length;
  return {x, normal.cross(x), normal};
}

}  // namespace burnish
