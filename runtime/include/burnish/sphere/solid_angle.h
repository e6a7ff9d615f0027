#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/sphere/direction.h"

namespace burnish {

/// Solid angle of the spherical triangle of three unit vectors, in sr, [0, 2 pi]; either
/// orientation. Zero where the corners lie on an arc of less than half a great circle, and where
/// two are opposite to each other (the triangle is then not defined).
///
/// Based on: vanoosterom1983solidangle, tan(area / 2) = |a . (b x c)| / (1 + a.b + b.c + c.a). Both
/// terms are taken from differences of near corners and sums of opposite ones, which are exact.
template <class T>
T triangle_solid_angle(Vector3<T> a, Vector3<T> b, Vector3<T> c) {
  // The widest edge becomes ab.
  const T ab = a.dot(b), bc = b.dot(c), ca = c.dot(a);
  if (bc < ab && bc <= ca)
    std::swap(a, c);
  else if (ca < ab)
    std::swap(b, c);
  const Vector3<T> sum = a + b;
  const Vector3<T> from_near = a.dot(c) > b.dot(c) ? Vector3<T>(c - a) : Vector3<T>(c - b);
  const T triple = a.dot(b) < 0 ? a.cross(sum).dot(from_near) : (a - c).cross(b - c).dot(c);
  return 2 * std::atan2(std::abs(triple), sum.dot(sum / 2 + c));
}

/// Solid angle of a pixel of an equirectangular map, in sr: the same for all columns of `row`, row
/// 0 at a pole. Exact; a whole map sums to 4 pi.
template <class T>
T latlong_pixel_solid_angle(int row, int width, int height) {
  // cos(t) - cos(t + s) without its cancellation, from the nearer pole
  const T half_step = kPi<T> / (2 * T(height));
  const int from_pole = std::min(row, height - 1 - row);
  return 4 * kPi<T> / T(width) * std::sin(half_step * T(2 * from_pole + 1)) * std::sin(half_step);
}

/// Solid angle of every texel of an octahedral map, in sr: the map is equal-area.
template <class T>
T octahedral_texel_solid_angle(int resolution) {
  return 4 * kPi<T> / (T(resolution) * T(resolution));
}

}  // namespace burnish
