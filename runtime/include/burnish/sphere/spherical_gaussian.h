#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "burnish/sphere/direction.h"
#include "burnish/sphere/frame.h"
#include "burnish/sphere/mean_resultant.h"
#include "burnish/sphere/special_functions.h"

/// Based on: spherical Gaussians (wang2009svbrdf); values and samples as in tokuyoshi2025vmf. The
/// forms below are those that stay accurate at small and at large sharpness; the textbook forms
/// cancel or overflow there. Every function takes a sharpness from 0 to the largest finite number.
/// A sharpness or amplitude of a result that would leave the scalar's range becomes the largest
/// finite number.
namespace burnish {

/// amplitude * exp(sharpness * (v . axis - 1)).
template <class T>
struct SphericalGaussian {
  Vector3<T> axis = Vector3<T>::UnitZ();  ///< unit
  T sharpness = 1;                        ///< >= 0
  T amplitude = 1;
};

/// Value at a unit direction. The exponent is taken from the distance |v - axis|, which keeps its
/// digits near the axis, where 1 - v . axis has none left.
template <class T>
T eval(const SphericalGaussian<T>& lobe, const Vector3<T>& direction) {
  return lobe.amplitude *
         std::exp(T(-0.5) * lobe.sharpness * (direction - lobe.axis).squaredNorm());
}

namespace internal {

/// (1 - exp(-2 L)) / L: the integral of a lobe over 2 pi. At most 2.
template <class T>
T sg_mass(T sharpness) {
  return sharpness > 0 ? -std::expm1(-2 * sharpness) / sharpness : T(2);
}

/// a * b * factor for factor >= 0, without overflow or underflow that the result does not have;
/// saturates at the largest finite number.
template <class T>
T scaled_product(T a, T b, T factor) {
  if (std::abs(a) < std::abs(b)) std::swap(a, b);
  constexpr T kMax = std::numeric_limits<T>::max();
  return std::clamp(factor > 1 ? a * b * factor : a * factor * b, -kMax, kMax);
}

}  // namespace internal

/// Integral over the sphere, to 2 epsilons; 4 pi * amplitude at sharpness 0.
template <class T>
T integral(const SphericalGaussian<T>& lobe) {
  return lobe.amplitude * (2 * kPi<T> * internal::sg_mass(lobe.sharpness));
}

template <class T>
SphericalGaussian<T> rotate(const SphericalGaussian<T>& lobe,
                            const Eigen::Matrix<T, 3, 3>& rotation) {
  return {rotation * lobe.axis, lobe.sharpness, lobe.amplitude};
}

namespace internal {

/// The product of two lobes but for the amplitudes: exp(exponent) at the axis.
template <class T>
struct SgProduct {
  Vector3<T> axis;
  T sharpness, exponent;
};

/// With L the larger sharpness and r <= 1 the ratio of the two, the product's sharpness and axis
/// are the length and direction of L (p + r q), and its exponent there is
/// L |p + r q| - L - r L = -r L |p - q|^2 / (|p + r q| + 1 + r). Only the last form keeps digits,
/// and nothing in it overflows.
template <class T>
SgProduct<T> sg_product(const SphericalGaussian<T>& a, const SphericalGaussian<T>& b) {
  const bool a_larger = a.sharpness >= b.sharpness;
  const SphericalGaussian<T>&narrow = a_larger ? a : b, &wide = a_larger ? b : a;
  const T ratio = narrow.sharpness > 0 ? wide.sharpness / narrow.sharpness : T(0);
  const Vector3<T> sum = narrow.axis + ratio * wide.axis;
  const T length = sum.norm();
  return {length > 0 ? Vector3<T>(sum / length) : a.axis,
          std::min(narrow.sharpness * length, std::numeric_limits<T>::max()),
          -(wide.sharpness / (length + 1 + ratio)) * (a.axis - b.axis).squaredNorm()};
}

}  // namespace internal

/// Product of two lobes: exact, again a lobe. Opposite axes of equal sharpness give sharpness 0
/// about the first axis.
template <class T>
SphericalGaussian<T> product(const SphericalGaussian<T>& a, const SphericalGaussian<T>& b) {
  const internal::SgProduct<T> p = internal::sg_product(a, b);
  return {p.axis, p.sharpness,
          internal::scaled_product(a.amplitude, b.amplitude, std::exp(p.exponent))};
}

/// Integral of the product of two lobes, exact. Never negative for amplitudes >= 0, never more
/// than 4 pi times their product.
template <class T>
T inner_product(const SphericalGaussian<T>& a, const SphericalGaussian<T>& b) {
  const internal::SgProduct<T> p = internal::sg_product(a, b);
  return internal::scaled_product(
      a.amplitude, b.amplitude, 2 * kPi<T> * internal::sg_mass(p.sharpness) * std::exp(p.exponent));
}

/// Convolution with another lobe, C(p) = integral of lobe(v) kernel(v; p) over v, as a lobe over p
/// (the kernel's own axis is not used). Exact in its integral and in its mean direction, whose
/// lengths multiply (the convolution of von Mises-Fisher distributions, mardia2000directional).
/// Relative L2 error for equal sharpness .5/1/2/5/10/50/100: .04/.5/2.9/5.4/3.2/.6/.3 %; it is
/// ruled by the wider lobe, and less when they differ.
template <class T>
SphericalGaussian<T> convolve(const SphericalGaussian<T>& lobe,
                              const SphericalGaussian<T>& kernel) {
  const MeanResultant<T> a = mean_resultant(lobe.sharpness), b = mean_resultant(kernel.sharpness);
  SphericalGaussian<T> result = lobe;
  result.sharpness = sharpness_from_mean(
      MeanResultant<T>{a.length * b.length, a.complement + a.length * b.complement});
  // The mass of the wider lobe against the result's is at most 1, and the narrower one's at most 2.
  const T narrow = std::max(lobe.sharpness, kernel.sharpness);
  const T wide = std::min(lobe.sharpness, kernel.sharpness);
  const T mass = 2 * kPi<T> * internal::sg_mass(narrow) *
                 (internal::sg_mass(wide) / internal::sg_mass(result.sharpness));
  result.amplitude = internal::scaled_product(lobe.amplitude, kernel.amplitude, mass);
  return result;
}

/// As convolve, for narrow lobes: sharpness L1 L2 / (L1 + L2), the rule of plane Gaussians, with
/// the exact integral. Without the mean direction to keep, it is also the nearer one above
/// sharpness 3. Relative L2 error for equal sharpness
/// .5/1/2/5/10/50/100: 9.8/12/6.1/3.5/1.9/.36/.18 %.
template <class T>
SphericalGaussian<T> convolve_fast(const SphericalGaussian<T>& lobe,
                                   const SphericalGaussian<T>& kernel) {
  const T narrow = std::max(lobe.sharpness, kernel.sharpness);
  const T wide = std::min(lobe.sharpness, kernel.sharpness);
  SphericalGaussian<T> result = lobe;
  result.sharpness = narrow > 0 ? wide / (1 + wide / narrow) : T(0);
  const T mass = 2 * kPi<T> * internal::sg_mass(narrow) *
                 (internal::sg_mass(wide) / internal::sg_mass(result.sharpness));
  result.amplitude = internal::scaled_product(lobe.amplitude, kernel.amplitude, mass);
  return result;
}

/// A direction distributed as the lobe, from u and v uniform in [0, 1]; the amplitude is not used.
/// Density: pdf(lobe, direction).
///
/// w = 1 - v . axis has the distribution (1 - exp(-L w)) / (1 - exp(-2 L)), which is inverted here.
template <class T>
Vector3<T> sample(const SphericalGaussian<T>& lobe, T u, T v) {
  // Below an epsilon the lobe is a constant to all digits, and u L may vanish among the denormals.
  const T height = lobe.sharpness < std::numeric_limits<T>::epsilon()
                       ? 2 * u
                       : -std::log1p(u * std::expm1(-2 * lobe.sharpness)) / lobe.sharpness;
  const T w = std::clamp(height, T(0), T(2));
  const T radius = std::sqrt(w * (2 - w)), phi = 2 * kPi<T> * v;
  return frame_from_axis(lobe.axis).to_world(
      {radius * std::cos(phi), radius * std::sin(phi), 1 - w});
}

/// Density of sample(), per sr: the lobe over its integral.
template <class T>
T pdf(const SphericalGaussian<T>& lobe, const Vector3<T>& direction) {
  const SphericalGaussian<T> unit{lobe.axis, lobe.sharpness, T(1)};
  return eval(unit, direction) / (2 * kPi<T> * internal::sg_mass(lobe.sharpness));
}

}  // namespace burnish
