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

/// How the integral falls from the side of the axis to the other (docs/maths.md). Each is a fit
/// over sharpness 0.05..4e4 to quadrature, in a form that has the limits for 0 and for infinity.
template <class T>
struct SgCosineShape {
  T slope;   ///< of the error function; a plane Gaussian has slope^2 = L / 2
  T bump;    ///< height of what a plane Gaussian lacks
  T spread;  ///< of the bump
};

template <class T>
SgCosineShape<T> sg_cosine_shape(T sharpness) {
  constexpr T a = T(14.274), b = T(9.0721), c = T(4.3465), d = T(53.009), e = T(32.998);
  constexpr T h0 = T(0.010435), h1 = T(0.042754), h2 = T(0.030011), h3 = T(2.3046e-4);
  SgCosineShape<T> shape;
  if (sharpness < 1) {
    const T l = sharpness;
    shape.slope = l * std::sqrt(((l + a) * l + b) / (2 * (((l + c) * l + d) * l + e)));
    shape.bump = l * h0 / (1 + l * (h1 + l * (h2 + l * h3)));
  } else {  // the same by powers of 1 / L, which do not overflow
    const T x = 1 / sharpness;
    shape.slope =
        std::sqrt(sharpness / 2 * ((1 + x * (a + x * b)) / (1 + x * (c + x * (d + x * e)))));
    shape.bump = x * x * h0 / (h3 + x * (h2 + x * (h1 + x)));
  }
  const T ratio = sharpness / T(29.6);
  shape.spread = T(0.25) / (1 + ratio * ratio);
  return shape;
}

}  // namespace internal

/// What clamped_cosine_integral needs of a lobe, for many normals.
template <class T>
struct PreparedClampedCosine {
  Vector3<T> axis;
  T slope, bump, spread;  ///< internal::SgCosineShape
  T end;                  ///< erfc(slope)
  T behind, mean;         ///< the integral for a normal opposite to the axis, and its rise to c = 1
};

template <class T>
PreparedClampedCosine<T> prepare_clamped_cosine(const SphericalGaussian<T>& lobe) {
  const internal::SgCosineShape<T> shape = internal::sg_cosine_shape(lobe.sharpness);
  const T behind = internal::sg_cosine_behind(lobe.sharpness);
  const T mean = internal::sg_mass(lobe.sharpness) * mean_cosine(lobe.sharpness);
  return {lobe.axis,
          shape.slope,
          shape.bump,
          shape.spread,
          std::erfc(shape.slope),
          lobe.amplitude * (2 * kPi<T> * behind),
          lobe.amplitude * (2 * kPi<T> * mean)};
}

/// Integral of lobe(v) max(v . normal, 0) over the sphere, `normal` unit. Exact for a normal along
/// and opposite to the axis, for sharpness 0, and for narrow lobes; elsewhere within 6e-5 of the
/// value for a normal along the axis (1.5e-3 in the form of tokuyoshi2024sglighting, 8 to 17 % with
/// the cosine as a spherical Gaussian). Rises with v . normal, never negative for amplitudes >= 0.
///
/// Based on: tokuyoshi2024sglighting. With c = axis . n, the odd part in c is exactly linear, since
/// max(x, 0) - max(-x, 0) = x: half of it is c times the lobe's mean. The even part is that of a
/// plane Gaussian, whose integrated erfc is scaled to be exact at c = +-1; the bump is ours.
template <class T>
T clamped_cosine_integral(const PreparedClampedCosine<T>& lobe, const Vector3<T>& normal) {
  const T c = std::clamp(lobe.axis.dot(normal), T(-1), T(1)), rest = 1 - c * c;
  const T t = lobe.slope, x = t * std::abs(c), square = x * x;
  // (ierfc(x) - ierfc(t)) / (2 t), in a form that cancels neither for small nor for large t.
  const T gap = t > 0 ? -std::expm1(-t * t * rest) / (2 * std::sqrt(kPi<T>) * t) : T(0);
  const T bump = lobe.bump * rest * (1 + lobe.spread * square);
  const T even = (lobe.end - std::abs(c) * std::erfc(x)) / 2 + std::exp(-square) * (gap + bump);
  return lobe.behind + lobe.mean * (std::max(c, T(0)) + std::max(even, T(0)));
}

template <class T>
T clamped_cosine_integral(const SphericalGaussian<T>& lobe, const Vector3<T>& normal) {
  return clamped_cosine_integral(prepare_clamped_cosine(lobe), normal);
}

}  // namespace burnish
