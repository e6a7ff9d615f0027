#pragma once

#include <limits>

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

/// The rotation by the smallest angle that takes the unit vector `from` to the unit vector `to`,
/// orthonormal to a few epsilons for any two: the identity for equal ones, and for opposite ones
/// the half turn about the y axis of frame_from_axis(from).
///
/// The product of two reflections, in the planes of `from` and of the bisector. The sum of nearly
/// opposite vectors is exact but knows `from` only as well as the two are unit, so its part along
/// `from` is taken from its length instead.
template <class T>
Eigen::Matrix<T, 3, 3> minimal_rotation(const Vector3<T>& from, const Vector3<T>& to) {
  using Matrix = Eigen::Matrix<T, 3, 3>;
  const Vector3<T> sum = from + to;
  const T along = sum.squaredNorm() / 2;
  const Vector3<T> across = sum - from * from.dot(sum);
  Vector3<T> bisector = across + from * along;
  const bool opposite = along < 1 && across.norm() < 8 * std::numeric_limits<T>::epsilon();
  bisector = opposite ? frame_from_axis(from).x : Vector3<T>(bisector.normalized());
  return (Matrix::Identity() - 2 * bisector * bisector.transpose()) *
         (Matrix::Identity() - 2 * from * from.transpose());
}

}  // namespace burnish
