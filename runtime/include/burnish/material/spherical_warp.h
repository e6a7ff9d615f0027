#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/sphere/anisotropic_gaussian.h"

/// Based on: xu2013asg, section 5.2 (Eq. 23-26), corrected: the second derivatives there are twice
/// what the exponent needs, and no Jacobian enters the amplitude (docs/maths.md, "Spherical warp").
namespace burnish {

/// Cosines below this, between view and lobe axis, are clamped: the warped lobe's width diverges at
/// 0.
inline constexpr double kMinWarpCosine = 0.01;

/// A lobe over half vectors as a lobe over incoming directions, for a view `outgoing`. The
/// amplitude is kept, or 0 where the view is behind the lobe's axis.
template <class T>
AnisotropicGaussian<T> warp_to_incoming(const AnisotropicGaussian<T>& half_lobe,
                                        const Vector3<T>& outgoing) {
  const Frame<T>& half = half_lobe.frame;
  const T cos_view = outgoing.dot(half.z);
  const T c = std::max(cos_view, T(kMinWarpCosine));
  AnisotropicGaussian<T> result;
  result.amplitude = cos_view > 0 ? half_lobe.amplitude : T(0);
  const Vector3<T> z = (2 * cos_view * half.z - outgoing).normalized();
  // x' is orthogonal to the view: z x o = 2c (z_h x o).
  const Vector3<T> across = half.z.cross(outgoing);
  const T sin_view = across.norm();
  const Vector3<T> x = sin_view > T(1e-5) ? Vector3<T>(across / sin_view) : half.x;
  const Vector3<T> y = z.cross(x);
  const T a = half.x.dot(x), b = half.y.dot(x);
  const T lambda = half_lobe.bandwidth_x, mu = half_lobe.bandwidth_y;
  const T m_xx = (lambda * a * a + mu * b * b) / (4 * c * c);
  const T m_xy = (mu - lambda) * a * b / (4 * c);
  const T m_yy = (lambda * b * b + mu * a * a) / 4;
  // Eigenvalues: the smaller one from the exact determinant, where the difference would cancel.
  const T half_difference = (m_xx - m_yy) / 2;
  const T radius = std::hypot(half_difference, m_xy);
  const T larger = (m_xx + m_yy) / 2 + radius;
  const T smaller = larger > 0 ? (lambda / larger) * (mu / (16 * c * c)) : T(0);
  T cos_angle = 1, sin_angle = 0;
  if (radius > 0) {
    // Eigenvector of the larger eigenvalue by the half angle of (half_difference, m_xy).
    const T cos_double = half_difference / radius, sin_double = m_xy / radius;
    cos_angle = std::sqrt(std::max((1 + cos_double) / 2, T(0)));
    sin_angle = std::copysign(std::sqrt(std::max((1 - cos_double) / 2, T(0))), sin_double);
  }
  const Vector3<T> major = cos_angle * x + sin_angle * y;
  result.frame = {major, z.cross(major), z};
  result.bandwidth_x = larger;
  result.bandwidth_y = smaller;
  return result;
}

}  // namespace burnish
