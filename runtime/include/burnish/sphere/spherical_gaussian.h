#pragma once

#include <cmath>

#include "burnish/sphere/direction.h"
#include "burnish/sphere/special_functions.h"

/// Based on: spherical Gaussians (wang2009svbrdf). The forms below are those that stay accurate at
/// small and at large sharpness; the textbook forms cancel or overflow there.
namespace burnish {

/// amplitude * exp(sharpness * (v . axis - 1)).
template <class T>
struct SphericalGaussian {
  Vector3<T> axis = Vector3<T>::UnitZ();  ///< unit
  T sharpness = 1;                        ///< >= 0
  T amplitude = 1;
};

template <class T>
T eval(const SphericalGaussian<T>& lobe, const Vector3<T>& direction) {
  return lobe.amplitude *
         std::exp(T(-0.5) * lobe.sharpness * (direction - lobe.axis).squaredNorm());
}

/// Integral over the sphere; 4 pi * amplitude at sharpness 0.
template <class T>
T integral(const SphericalGaussian<T>& lobe) {
  return lobe.amplitude * 4 * kPi<T> * one_minus_exp_over(2 * lobe.sharpness);
}

/// Product of two lobes: exact, again a lobe. Opposite axes of equal sharpness give sharpness 0
/// about the first axis.
template <class T>
SphericalGaussian<T> product(const SphericalGaussian<T>& a, const SphericalGaussian<T>& b) {
  const Vector3<T> sum = a.sharpness * a.axis + b.sharpness * b.axis;
  const T sharpness = sum.norm();
  const T total = sharpness + a.sharpness + b.sharpness;
  const T exponent =
      total > 0 ? -a.sharpness * b.sharpness * (a.axis - b.axis).squaredNorm() / total : T(0);
  SphericalGaussian<T> result;
  result.axis = sharpness > 0 ? Vector3<T>(sum / sharpness) : a.axis;
  result.sharpness = sharpness;
  result.amplitude = a.amplitude * b.amplitude * std::exp(exponent);
  return result;
}

/// Integral of the product of two lobes, exact.
template <class T>
T inner_product(const SphericalGaussian<T>& a, const SphericalGaussian<T>& b) {
  return integral(product(a, b));
}

}  // namespace burnish
