#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/spherical_gaussian.h"

/// The light that a spherical Gaussian sends onto a surface: the integral of lobe(v) max(v . n, 0).
/// Derivation and errors: docs/maths.md, "Clamped cosine of a spherical Gaussian".
namespace burnish {

namespace internal {

/// The integral over 2 pi for n opposite to the axis, exp(-2 L) (exp(L) - 1 - L) / L^2.
template <class T>
T sg_cosine_behind(T sharpness) {
  if (sharpness < 1) {  // where the closed form cancels: the series of (exp(L) - 1 - L) / L^2
    T sum = 0, term = T(0.5);
    for (int k = 3; sum + term > sum; ++k) {
      sum += term;
      term *= sharpness / T(k);
    }
    return std::exp(-2 * sharpness) * sum;
  }
  const T e = std::exp(-sharpness);
  return e / sharpness * ((1 - e) / sharpness - e);
}

/// Slope of the transition at the horizon. A plane Gaussian has t^2 = L / 2; the rational function
/// is tokuyoshi2024sglighting's fit of what the sphere's curvature makes of that.
template <class T>
T sg_cosine_slope(T sharpness) {
  constexpr T a = T(2.7360831611272558), b = T(17.021297774187415), c = T(4.0100826728510421),
              d = T(15.219156263147211), e = T(76.087896272360737);
  if (sharpness < 1) {
    const T l = sharpness;
    return l * std::sqrt(((l + a) * l + b) / (2 * (((l + c) * l + d) * l + e)));
  }
  const T x = 1 / sharpness;
  return std::sqrt(sharpness / 2 * ((1 + x * (a + x * b)) / (1 + x * (c + x * (d + x * e)))));
}

}  // namespace internal

/// Integral of lobe(v) max(v . normal, 0) over the sphere, `normal` unit. Exact for a normal along
/// and opposite to the axis, for sharpness 0, and for narrow lobes; worst error, relative to the
/// value for a normal along the axis: 1.6e-3 at sharpness 5, 4e-4 below 2 and above 20. Never
/// negative for amplitudes >= 0.
///
/// Based on: tokuyoshi2024sglighting. With c = axis . n, the odd part in c is exactly linear, since
/// max(x, 0) - max(-x, 0) = x: half of it is c times the lobe's mean. The even part is that of a
/// plane Gaussian, whose integrated erfc is scaled to be exact at c = +-1.
template <class T>
T clamped_cosine_integral(const SphericalGaussian<T>& lobe, const Vector3<T>& normal) {
  const T c = std::clamp(lobe.axis.dot(normal), T(-1), T(1));
  const T t = internal::sg_cosine_slope(lobe.sharpness);
  const T x = t * std::abs(c);
  // (ierfc(x) - ierfc(t)) / (2 t), in a form that cancels neither for small nor for large t.
  const T gap =
      t > 0 ? std::exp(-x * x) * -std::expm1(-t * t * (1 - c * c)) / (std::sqrt(kPi<T>) * t) : T(0);
  const T even = std::max((std::erfc(t) - std::abs(c) * std::erfc(x) + gap) / 2, T(0));
  const T mean = internal::sg_mass(lobe.sharpness) * mean_cosine(lobe.sharpness);
  return lobe.amplitude *
         (2 * kPi<T> *
          (internal::sg_cosine_behind(lobe.sharpness) + mean * (std::max(c, T(0)) + even)));
}

}  // namespace burnish
