#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/anisotropic_gaussian.h"

/// The fraction of a lobe that is visible past a boundary at a signed angular distance from its
/// axis (radians, positive: the axis is visible). Derivations and errors: docs/maths.md, "Visible
/// fraction".
namespace burnish {

/// What is assumed of the visible region around the lobe's axis.
enum class VisibilityModel {
  cap,          ///< a disc of the radius `distance`; 17..71 % relative RMS: for comparison only
  hemisphere,   ///< a half-space, lobe taken isotropic (wang2009svbrdf; xu2013asg Eq. 27); 3..23 %
  directional,  ///< a half-space whose boundary runs across the SSDF's gradient; 1.6..21 %
};

/// Fraction of a spherical Gaussian inside a cap of radius `distance` around its axis.
template <class T>
T visible_fraction_cap(T sharpness, T distance) {
  if (distance <= 0) return 0;
  const T height = 1 - std::cos(std::min(distance, kPi<T>));
  return std::min(
      height * one_minus_exp_over(sharpness * height) / (2 * one_minus_exp_over(2 * sharpness)),
      T(1));
}

/// Fraction of a spherical Gaussian on the visible side of a great circle: absolute error 2.4e-3
/// for sharpness 1e-3..1e6. Distances beyond +-pi/2 count as +-pi/2.
template <class T>
T visible_fraction_hemisphere(T sharpness, T distance) {
  const T theta = std::clamp(distance, -kPi<T> / 2, kPi<T> / 2);
  // A least-squares fit of the form (docs/maths.md); symmetric: P(theta) + P(-theta) = 1.
  constexpr T a = T(0.138012), c1 = T(1.021524), n = T(1.342477), l0 = T(4.48787);
  const T lo = 1 / (1 + std::exp(std::min(sharpness, T(80))));
  const T k = sharpness *
              std::sqrt((sharpness / 2 + a) / (sharpness * (sharpness + 2 * a + T(0.75)) + 8 * a));
  const T w = (1 - c1 / (1 + std::pow(sharpness / l0, n))) / 4;
  const T far = k * (1 + w);
  const T x = k * std::abs(std::sin(theta)) * (1 + w * (1 - std::cos(theta)));
  // The hidden tail, written with erfc so that it does not cancel.
  const T tail = far > 0 ? (std::erfc(x) - std::erfc(far)) / (2 * std::erf(far))
                         : (1 - std::abs(std::sin(theta))) / 2;
  const T hidden = lo + (1 - 2 * lo) * std::max(tail, T(0));
  return theta >= 0 ? 1 - hidden : hidden;
}

/// Fraction of an ASG on the visible side of a great circle, from its bandwidth across that circle.
template <class T>
T visible_fraction_directional(T bandwidth_across, T distance) {
  const T theta = std::clamp(distance, -kPi<T> / 2, kPi<T> / 2);
  const T s = std::abs(std::sin(theta));
  const T root = std::sqrt(bandwidth_across);
  const T whole = std::erf(root);
  if (!(whole > 0)) return (1 + std::copysign(s, theta)) / 2;
  // The hidden tail: a difference of erfs for wide lobes, of erfcs for narrow ones, so that neither
  // cancels.
  const T tail = root < T(0.5) ? whole - std::erf(root * s) : std::erfc(root * s) - std::erfc(root);
  const T hidden = std::max(tail / (2 * whole), T(0));
  return theta >= 0 ? 1 - hidden : hidden;
}

/// Bandwidth of a lobe along a unit direction of its tangent plane: 1 / (n_x^2 / b_x + n_y^2 /
/// b_y). A zero gradient (nothing near has a boundary) gives the geometric mean.
template <class T>
T bandwidth_across(const AnisotropicGaussian<T>& lobe, const Vector3<T>& gradient) {
  const T nx = gradient.dot(lobe.frame.x), ny = gradient.dot(lobe.frame.y);
  const T square = nx * nx + ny * ny;
  const T numerator = lobe.bandwidth_x * lobe.bandwidth_y;
  const T denominator = nx * nx * lobe.bandwidth_y + ny * ny * lobe.bandwidth_x;
  if (!(denominator > 0)) return std::sqrt(lobe.bandwidth_x) * std::sqrt(lobe.bandwidth_y);
  return numerator / denominator * square;
}

/// Fraction of a lobe that is visible, given the SSDF at its axis and its gradient there (tangent
/// to the sphere, toward rising distance; used by `directional` only).
template <class T>
T visible_fraction(VisibilityModel model, const AnisotropicGaussian<T>& lobe, T distance,
                   const Vector3<T>& gradient) {
  switch (model) {
    case VisibilityModel::cap:
      return visible_fraction_cap(effective_sharpness(lobe), distance);
    case VisibilityModel::hemisphere:
      return visible_fraction_hemisphere(effective_sharpness(lobe), distance);
    case VisibilityModel::directional:
      break;
  }
  return visible_fraction_directional(bandwidth_across(lobe, gradient), distance);
}

}  // namespace burnish
