#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/sphere/anisotropic_gaussian.h"

/// Based on: xu2013asg, section 5.2 (Eq. 23-26), corrected: the second derivatives there are twice
/// what the exponent needs, and no Jacobian enters the amplitude (docs/maths.md, "Spherical warp").
namespace burnish {

/// Cosines between view and lobe axis below this count as this: the warped width diverges at 0.
inline constexpr double kMinWarpCosine = 0.01;

/// A lobe over half vectors, as a lobe over incoming directions.
template <class T>
struct WarpedLobe {
  /// The amplitude is the half-vector lobe's: a function value, D(h(i)), does not change with its
  /// argument's name. 0 where the view is at or behind the axis's horizon. bandwidth_x is the
  /// larger.
  AnisotropicGaussian<T> lobe;
  /// Solid angle of incoming directions per solid angle of half vectors, 4 o.h, at the lobe's axis;
  /// in [4 kMinWarpCosine, 4]. For a density over h, divide the amplitude by it: the lobe's
  /// integral is then kept. For an integral over h that shall run over i, divide the integrand.
  T jacobian;
};

/// The lobe over incoming directions i = reflect(outgoing, h) that a lobe over half vectors h
/// becomes for a unit view `outgoing`. Any lobe frame; no surface normal enters. The exponent is
/// exact to second order at the axis, sqrt(bandwidth_x bandwidth_y) is the half lobe's over
/// 4 o.h. Bandwidths that overflow are the largest finite number.
template <class T>
WarpedLobe<T> warp_to_incoming(const AnisotropicGaussian<T>& half_lobe,
                               const Vector3<T>& outgoing) {
  const Frame<T>& half = half_lobe.frame;
  // In the lobe's frame the reflected axis is (-o_x, -o_y, o_z), and x' = (-o_y, o_x, 0) / sin is
  // orthogonal to it and to the lobe's axis whatever the rounding of a small sine. At sine 0 every
  // x' gives the same lobe.
  const Vector3<T> o = half.to_local(outgoing);
  const T sin_view = std::hypot(o.x(), o.y());
  const T a = sin_view > 0 ? -o.y() / sin_view : T(1);
  const T b = sin_view > 0 ? o.x() / sin_view : T(0);
  const Vector3<T> z(-o.x(), -o.y(), o.z()), x(a, b, 0), y(-o.z() * b, o.z() * a, -sin_view);

  // M, the matrix of the exponent in (x', y'), over the larger bandwidth, so that nothing
  // overflows.
  const T c = std::max(o.z(), T(kMinWarpCosine));
  const T large = std::max(half_lobe.bandwidth_x, half_lobe.bandwidth_y);
  const T small = std::min(half_lobe.bandwidth_x, half_lobe.bandwidth_y);
  const T lambda = large > 0 ? half_lobe.bandwidth_x / large : T(1);
  const T mu = large > 0 ? half_lobe.bandwidth_y / large : T(1);
  const T m_xx = (lambda * a * a + mu * b * b) / (4 * c * c);
  const T m_xy = (mu - lambda) * a * b / (4 * c);
  const T m_yy = (lambda * b * b + mu * a * a) / 4;

  // Eigenvalues: the smaller one from the determinant, as a difference it would cancel.
  const T half_difference = (m_xx - m_yy) / 2;
  const T radius = std::hypot(half_difference, m_xy);
  const T larger = (m_xx + m_yy) / 2 + radius;
  // Eigenvector of the larger one by half angles; the smaller of the two from the double sine.
  T cos_axis = 1, sin_axis = 0;
  if (radius > 0) {
    const T cos_double = half_difference / radius, sin_double = m_xy / radius;
    const T dominant = std::sqrt((1 + std::abs(cos_double)) / 2);
    const T other = sin_double / (2 * dominant);
    cos_axis = cos_double >= 0 ? dominant : std::abs(other);
    sin_axis = cos_double >= 0 ? other : std::copysign(dominant, sin_double);
  }
  WarpedLobe<T> warped;
  warped.lobe.frame = {half.to_world(cos_axis * x + sin_axis * y),
                       half.to_world(cos_axis * y - sin_axis * x), half.to_world(z)};
  warped.lobe.bandwidth_x = std::min(larger * large, std::numeric_limits<T>::max());
  warped.lobe.bandwidth_y = small / (16 * c * c * larger);
  warped.lobe.amplitude = o.z() > 0 ? half_lobe.amplitude : T(0);
  warped.jacobian = 4 * c;
  return warped;
}

}  // namespace burnish
