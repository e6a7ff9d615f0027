#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "burnish/sphere/direction.h"

/// The irradiance of a uniformly bright cap of directions (a sphere, the sun), also where the
/// horizon cuts it. Derivation: docs/maths.md, "Local lights".
namespace burnish {

namespace internal {

/// asin(c) - c sqrt(1 - c^2) for c in [0, 1], without its cancellation for small c.
template <class T>
T asin_minus_chord(T c) {
  const T square = c * c;
  if (c > T(0.3)) return std::asin(c) - c * std::sqrt(std::max(1 - square, T(0)));
  constexpr int kTerms = std::is_same_v<T, float> ? 7 : 15;  // 0.09^n is the last bit
  T sum = 0, power = 2 * c * square;
  for (int k = 0; k < kTerms; ++k) {
    sum += power / T(2 * k + 3);
    power *= square * (T(2 * k + 1) / T(2 * k + 2));
  }
  return sum;
}

}  // namespace internal

/// Integral of max(v . n, 0) over a cap of directions around an axis: from 0 to pi. `height` = 1 -
/// cos(the cap's radius), 0..2; `cosine` = axis . n, -1..1. Error: 2e-6 in float and 1e-14 in
/// double, of the value for n along the axis. Rises with the cosine.
///
/// Based on: snyder1996area. The odd part in the cosine is linear, since max(x, 0) - max(-x, 0) =
/// x, so that its two branches are one here; terms are arranged so that small caps do not cancel.
template <class T>
T cap_cosine_integral(T height, T cosine) {
  // More than a hemisphere: everything but the opposite cap.
  if (height > 1) return kPi<T> - cap_cosine_integral(2 - height, -cosine);
  const T square = height * (2 - height);  // sin^2 of the radius
  const T k = std::abs(cosine), kk = k * k;
  const T whole = kPi<T> * square * std::max(cosine, T(0));
  if (kk >= square) return whole;
  // The cap's edge meets the horizon +-acos(c) off the azimuth of the axis.
  const T across = 1 - kk;
  const T c = std::sqrt(std::min((square - kk) / across, T(1)));
  const T s = std::min((1 - height) / std::sqrt(across), T(1));  // sqrt(1 - c^2)
  const T even = internal::asin_minus_chord(c) + s * c * kk -
                 k * square * std::asin(std::min(c / std::sqrt(square), T(1)));
  return whole + std::max(even, T(0));
}

}  // namespace burnish
