#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Directions are unit vectors that leave the surface (docs/conventions.md). Everything in sphere/
/// is a template on the scalar, used as float at run time and as double in the precompute and the
/// tests.
namespace burnish {

template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
using Vector3f = Vector3<float>;
using Vector3d = Vector3<double>;

template <class T>
inline constexpr T kPi = T(3.14159265358979323846264338327950288L);

/// Angle between two unit vectors, radians in [0, pi]. Keeps full relative precision for nearly
/// equal and nearly opposite directions, where acos of the dot product loses half the digits.
template <class T>
T angle_between(const Vector3<T>& a, const Vector3<T>& b) {
  // a x b from the difference of near vectors, the sum of opposite ones: both are exact.
  const T cosine = a.dot(b);
  const Vector3<T> offset = cosine > 0 ? Vector3<T>(b - a) : Vector3<T>(b + a);
  return std::atan2(a.cross(offset).norm(), cosine);
}

}  // namespace burnish
