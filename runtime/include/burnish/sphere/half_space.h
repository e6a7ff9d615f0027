#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/sg_half_space.h"

/// The fraction of a lobe that is visible past a boundary at a signed angular distance from its
/// axis (radians, positive: the axis is visible). Derivations and errors: docs/maths.md, "Visible
/// fraction". Every function takes bandwidths from 0 to the largest finite number. Distances beyond
/// +-pi/2 count as +-pi/2 (pi in `cap`). All but `cap` are symmetric, P(d) + P(-d) = 1; the small
/// one of the two keeps its digits, in `directional` down to 1e-7 of the whole.
namespace burnish {

/// What is assumed of the visible region around the lobe's axis.
enum class VisibilityModel {
  cap,          ///< a disc of the radius `distance`; 17..71 % relative RMS: for comparison only
  hemisphere,   ///< a half-space, lobe taken isotropic (wang2009svbrdf; xu2013asg Eq. 27); 3..23 %
  directional,  ///< a half-space whose boundary runs across the SSDF's gradient; 1.6..21 %
};

/// Fraction of an ASG on the visible side of a great circle, from its bandwidth across that circle.
template <class T>
T visible_fraction_directional(T bandwidth_across, T distance) {
  const T sine = std::sin(std::clamp(distance, -kPi<T> / 2, kPi<T> / 2));
  const T root = std::max(std::sqrt(bandwidth_across), internal::kSmallestRoot<T>);
  const T hidden = internal::gaussian_tail(root * std::abs(sine), root);
  return sine >= 0 ? 1 - hidden : hidden;
}

/// Bandwidth of a lobe along a direction of its tangent plane, of any length: 1 / (n_x^2 / b_x +
/// n_y^2 / b_y) for its unit vector n; between b_x and b_y. A zero gradient (nothing near has a
/// boundary) gives the geometric mean.
template <class T>
T bandwidth_across(const AnisotropicGaussian<T>& lobe, const Vector3<T>& gradient) {
  const T nx = gradient.dot(lobe.frame.x), ny = gradient.dot(lobe.frame.y);
  const T small = std::min(lobe.bandwidth_x, lobe.bandwidth_y);
  const T large = std::max(lobe.bandwidth_x, lobe.bandwidth_y);
  const T norm = std::max(std::abs(nx), std::abs(ny));
  if (!(norm > 0)) return std::sqrt(small) * std::sqrt(large);
  // n along the wide and the narrow axis, scaled so that the larger square does not vanish.
  const bool x_is_wide = lobe.bandwidth_x < lobe.bandwidth_y;
  const T wide = (x_is_wide ? nx : ny) / norm, narrow = (x_is_wide ? ny : nx) / norm;
  const T wide_square = wide * wide, narrow_square = narrow * narrow;
  if (wide_square == 0) return large;
  if (small == 0) return 0;
  return std::clamp(
      small * ((wide_square + narrow_square) / (wide_square + narrow_square * (small / large))),
      small, large);
}

/// The bandwidth that makes visible_fraction_directional of an ASG's half-space most accurate:
/// bandwidth_across, corrected for what it neglects. Over random lobes (sqrt(b_x b_y) .01..300, b_x
/// / b_y 1..1000) the fraction then errs by .003 (mean) and .039 (worst); without, by .006 and .18.
template <class T>
T directional_bandwidth(const AnisotropicGaussian<T>& lobe, const Vector3<T>& gradient) {
  // The disc's edge makes a long axis that reaches it shorter than its bandwidth says (fitted).
  AnisotropicGaussian<T> held = lobe;
  const bool x_is_wide = lobe.bandwidth_x < lobe.bandwidth_y;
  const T large = x_is_wide ? lobe.bandwidth_y : lobe.bandwidth_x;
  T& small = x_is_wide ? held.bandwidth_x : held.bandwidth_y;
  small += T(2) / 3 * ((large - small) / (1 + large)) / (1 + small);
  // A great circle is half an ellipse in the orthographic plane, not a line: where the lobe extends
  // along it by w, it is nearer by sqrt(1 - w^2). The mean of w^2 is about 1 / (2 b + 5 / 2).
  const T along = bandwidth_across(held, Vector3<T>(lobe.frame.z.cross(gradient)));
  return bandwidth_across(held, gradient) * (1 - 1 / (2 * along + T(2.5)));
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
  return visible_fraction_directional(directional_bandwidth(lobe, gradient), distance);
}

/// Integral of lobe times visibility: its integral times its visible fraction.
template <class T>
T visible_integral(VisibilityModel model, const AnisotropicGaussian<T>& lobe, T distance,
                   const Vector3<T>& gradient, AsgIntegral level = AsgIntegral::exact) {
  return integral(lobe, level) * visible_fraction(model, lobe, distance, gradient);
}

}  // namespace burnish
