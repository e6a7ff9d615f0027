#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/lobe_moments.h"

/// Based on: xu2013asg, section 5.2 (Eq. 23-26), corrected: the second derivatives there are twice
/// what the exponent needs, and no Jacobian enters the amplitude (docs/maths.md, "Spherical warp").
namespace burnish {

/// Cosines between view and lobe axis below this count as this: the warped width diverges at 0.
inline constexpr double kMinWarpCosine = 0.01;

/// A lobe over half vectors, as a lobe over incoming directions; bandwidth_x is the larger.
template <class T>
struct WarpedLobe {
  AnisotropicGaussian<T> lobe;
  /// Solid angle of incoming directions per solid angle of half vectors, 4 o.h, 0..4. It is no part
  /// of the amplitude, since D(h(i)) is a function value. For a density over half vectors divide
  /// the amplitude by it (or, where it is 0, the amplitude is, too): the integral is then that over
  /// half vectors. For an integral over half vectors that shall run over i, divide the integrand.
  T jacobian;
};

namespace internal {

template <class T>
struct WarpedAxes {
  T bandwidth_x, bandwidth_y;
  T cosine, sine;  ///< of the angle from x' to the axis of the larger bandwidth
};

/// Eigenvalues and axes of the exponent's matrix M in (x', y'), for a half-vector lobe whose axes
/// have the components a = x_h.x', b = y_h.x', and a cosine c > 0 of view and half vector.
template <class T>
WarpedAxes<T> warped_axes(T bandwidth_x, T bandwidth_y, T a, T b, T c) {
  // Over the larger bandwidth, so that nothing overflows.
  const T large = std::max(bandwidth_x, bandwidth_y), small = std::min(bandwidth_x, bandwidth_y);
  const T lambda = large > 0 ? bandwidth_x / large : T(1);
  const T mu = large > 0 ? bandwidth_y / large : T(1);
  const T m_xx = (lambda * a * a + mu * b * b) / (4 * c * c);
  const T m_xy = (mu - lambda) * a * b / (4 * c);
  const T m_yy = (lambda * b * b + mu * a * a) / 4;
  const T half_difference = (m_xx - m_yy) / 2;
  const T radius = std::hypot(half_difference, m_xy);
  // The smaller eigenvalue from the determinant: as a difference it would cancel.
  const T larger = (m_xx + m_yy) / 2 + radius;
  const T narrow = std::min(larger * large, std::numeric_limits<T>::max());
  WarpedAxes<T> result = {narrow, std::min(small / (16 * c * c * larger), narrow), T(1), T(0)};
  if (radius > 0) {
    // Half of the angle of (half_difference, m_xy); its smaller component from the double sine.
    const T cos_double = half_difference / radius, sin_double = m_xy / radius;
    const T dominant = std::sqrt((1 + std::abs(cos_double)) / 2);
    const T other = sin_double / (2 * dominant);
    result.cosine = cos_double >= 0 ? dominant : std::abs(other);
    result.sine = cos_double >= 0 ? other : std::copysign(dominant, sin_double);
  }
  return result;
}

/// x' in the half-vector lobe's frame: orthogonal to its axis whatever the rounding of a view close
/// to it. At the axis itself every x' gives the same lobe.
template <class T>
Vector3<T> across_view(const Vector3<T>& local_outgoing) {
  const T sine = std::hypot(local_outgoing.x(), local_outgoing.y());
  // Quotients of denormal numbers have no digits.
  if (!(sine > std::numeric_limits<T>::min())) return Vector3<T>::UnitX();
  return {-local_outgoing.y() / sine, local_outgoing.x() / sine, T(0)};
}

}  // namespace internal

/// The peak form: exact to second order about the reflection of the unit view `outgoing` at the
/// lobe's axis. Any lobe frame; no surface normal enters. The amplitude is the half-vector lobe's,
/// 0 where the view is at or behind the axis's horizon; sqrt(bandwidth_x bandwidth_y) is the half
/// lobe's over the jacobian. Bandwidths that overflow are the largest finite number. For the value
/// near the peak; for integrals, `warp_mean_to_incoming` is 2 to 13 times as accurate.
template <class T>
WarpedLobe<T> warp_to_incoming(const AnisotropicGaussian<T>& half_lobe,
                               const Vector3<T>& outgoing) {
  const Frame<T>& half = half_lobe.frame;
  const Vector3<T> o = half.to_local(outgoing);
  const Vector3<T> z(-o.x(), -o.y(), o.z()), x = internal::across_view(o), y = z.cross(x);
  const T c = std::max(o.z(), T(kMinWarpCosine));
  const internal::WarpedAxes<T> axes =
      internal::warped_axes(half_lobe.bandwidth_x, half_lobe.bandwidth_y, x.x(), x.y(), c);
  WarpedLobe<T> warped;
  warped.lobe.frame = {half.to_world(axes.cosine * x + axes.sine * y),
                       half.to_world(axes.cosine * y - axes.sine * x), half.to_world(z)};
  warped.lobe.bandwidth_x = axes.bandwidth_x;
  warped.lobe.bandwidth_y = axes.bandwidth_y;
  warped.lobe.amplitude = o.z() > 0 ? half_lobe.amplitude : T(0);
  warped.jacobian = 4 * c;
  return warped;
}

namespace internal {

/// Of a normal variable s that counts only where it is positive, s_+: its mean E[s_+], the means of
/// s and s^2 weighted by s_+, and the probability of s > 0 over E[s_+]. Held at 4 deviations below
/// 0, where E[s_+] counts as 0.
template <class T>
struct CutNormal {
  T mean, weighted_mean, weighted_square, probability_over_mean;
};

template <class T>
CutNormal<T> cut_normal(T mean, T deviation) {
  constexpr T kSmallest = std::numeric_limits<T>::min();  // for 1 / 0
  const T variance = deviation * deviation;
  if (mean > 6 * deviation)  // nothing is cut
    return {mean, mean + deviation * (deviation / mean), mean * mean + 3 * variance,
            1 / std::max(mean, kSmallest)};
  deviation = std::max(deviation, kSmallest);
  const T ratio = std::max(mean / deviation, T(-4));
  const T density = std::exp(-ratio * ratio / 2) / std::sqrt(2 * kPi<T>);
  const T probability = std::erfc(-ratio / std::sqrt(T(2))) / 2;
  const T excess = density + ratio * probability;
  // Stein's identity: E[s s_+] = mean E[s_+] + variance P, E[s^2 s_+] = mean E[s s_+] +
  // 2 variance E[s_+].
  const T weighted_mean = deviation * (ratio + probability / excess);
  return {ratio > -4 ? deviation * excess : T(0), weighted_mean,
          std::max(ratio * deviation * weighted_mean + 2 * variance, T(0)),
          probability / excess / deviation};
}

}  // namespace internal

/// What the mean form needs to know of a half-vector lobe; it depends on the bandwidths only.
template <class T>
struct LobeShape {
  T integral;  ///< for amplitude one
  LobeMoments<T> moments;
  T in_plane_cosine;  ///< sqrt(E[z^3] / E[z]): 1 for a narrow lobe, .77 for the widest
};

template <class T>
LobeShape<T> make_lobe_shape(T bandwidth_x, T bandwidth_y) {
  const LobeMoments<T> m = asg_moments(bandwidth_x, bandwidth_y);
  const T square = m.mean_z * m.mean_z + 3 * m.variance_z + m.mean_zzz / m.mean_z;
  return {asg_integral_exact(bandwidth_x, bandwidth_y), m, std::sqrt(square)};
}

/// The mean form: a lobe of the mean direction and the integral of D(h(i)), for a unit view
/// `outgoing`, which may be past the horizon of the lobe's axis. s = o.h, taken as a normal
/// variable that is cut at 0, gives both in closed form (docs/maths.md, "Spherical warp"). For
/// shading: the integral of lobe, cosine and a light at alpha (.32, .032) and 60/80/88 degrees errs
/// by .05/.10/.14, in the peak form by .15/.50/.87, and the teeth of a LobeComb by less. The peak
/// form is better for the values of one wide lobe (relative L2 .51 against .65 at 60 degrees), and
/// beyond alpha .5 for views near the axis. Amplitude and jacobian are 0 where no half vector is
/// seen.
template <class T>
WarpedLobe<T> warp_mean_to_incoming(const AnisotropicGaussian<T>& half_lobe,
                                    const LobeShape<T>& shape, const Vector3<T>& outgoing) {
  const Frame<T>& half = half_lobe.frame;
  const LobeMoments<T>& m = shape.moments;
  const Vector3<T> o = half.to_local(outgoing);
  const T variance =
      o.x() * o.x() * m.mean_xx + o.y() * o.y() * m.mean_yy + o.z() * o.z() * m.variance_z;
  const internal::CutNormal<T> s = internal::cut_normal(o.z() * m.mean_z, std::sqrt(variance));
  // E[i] = 2 E[s s_+ h] / E[s_+] - o. By Stein's identity E[s s_+ h] = E[h] E[s s_+] +
  // 2 E[s_+] Cov(h, s), plus the probability of s > 0 times the third moment of (s, s, h).
  const T third = s.probability_over_mean;
  const T xxz = third * m.mean_xxz, yyz = third * m.mean_yyz, zzz = third * m.mean_zzz;
  Vector3<T> z(o.x() * (4 * (m.mean_xx + o.z() * xxz) - 1),
               o.y() * (4 * (m.mean_yy + o.z() * yyz) - 1),
               2 * m.mean_z * s.weighted_mean + o.z() * (4 * m.variance_z - 1) +
                   2 * (o.x() * o.x() * xxz + o.y() * o.y() * yyz + o.z() * o.z() * zzz));
  const T length = z.norm();
  z = length > 0 ? Vector3<T>(z / length) : Vector3<T>::UnitZ();
  const Vector3<T> across = internal::across_view(o);
  const Vector3<T> x = (across - across.dot(z) * z).normalized(), y = z.cross(x);
  // For each turn of h, i turns by 2 s across the view, and in its plane by 2, the sine of which is
  // 2 sin cos. Seen along its axis, a lobe is the same in both.
  const T d = shape.in_plane_cosine, largest = std::numeric_limits<T>::max();
  const T c = std::clamp(std::sqrt(s.weighted_square) / d, T(kMinWarpCosine), T(1));
  internal::WarpedAxes<T> axes = internal::warped_axes(half_lobe.bandwidth_x, half_lobe.bandwidth_y,
                                                       across.x(), across.y(), c);
  axes.bandwidth_x = std::min(axes.bandwidth_x / (d * d), largest);
  axes.bandwidth_y = std::min(axes.bandwidth_y / (d * d), largest);
  WarpedLobe<T> warped;
  warped.lobe.frame = {half.to_world(axes.cosine * x + axes.sine * y),
                       half.to_world(axes.cosine * y - axes.sine * x), half.to_world(z)};
  warped.lobe.bandwidth_x = axes.bandwidth_x;
  warped.lobe.bandwidth_y = axes.bandwidth_y;
  warped.jacobian = 4 * s.mean;
  warped.lobe.amplitude =
      half_lobe.amplitude *
      (warped.jacobian * shape.integral / asg_integral_exact(axes.bandwidth_x, axes.bandwidth_y));
  return warped;
}

}  // namespace burnish
