#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/direction.h"
#include "burnish/sphere/gauss_legendre.h"

/// The cosine integral of a lobe from its first four moments: no quadrature per vertex, and no
/// product of two lobes, whose error is 20-30 % here (docs/maths.md, "Clamped cosine of a lobe").
namespace burnish {

/// Moments of a normalised distribution on the sphere that is symmetric about its frame's x and y:
/// those of odd order in x or y are 0. With d = v.z - mean_z.
template <class T>
struct LobeMoments {
  T mean_z = 1;                    ///< E[v.z]
  T mean_xx = 0, mean_yy = 0;      ///< E[(v.x)^2], E[(v.y)^2]
  T variance_z = 0;                ///< E[d^2]
  T mean_xxz = 0, mean_yyz = 0;    ///< E[(v.x)^2 d], E[(v.y)^2 d]
  T mean_zzz = 0;                  ///< E[d^3]
  T mean_xxxx = 0, mean_yyyy = 0;  ///< E[(v.x)^4], E[(v.y)^4]
  T mean_zzzz = 0;                 ///< E[d^4]
  T mean_xxyy = 0;                 ///< E[(v.x)^2 (v.y)^2]
  T mean_xxzz = 0, mean_yyzz = 0;  ///< E[(v.x)^2 d^2], E[(v.y)^2 d^2]

  template <class U>
  LobeMoments<U> cast() const {
    return {U(mean_z),    U(mean_xx),   U(mean_yy),   U(variance_z), U(mean_xxz),
            U(mean_yyz),  U(mean_zzz),  U(mean_xxxx), U(mean_yyyy),  U(mean_zzzz),
            U(mean_xxyy), U(mean_xxzz), U(mean_yyzz)};
  }
};

namespace internal {

/// Sums over an ASG, x its narrow axis, of powers of w = 1 - z, and of those times x^2, y^2, x^4,
/// x^2 y^2 and y^4.
struct AsgSums {
  double one = 0, w1 = 0, w2 = 0, w3 = 0, w4 = 0;
  double xx = 0, xxw = 0, xxww = 0, yy = 0, yyw = 0, yyww = 0, xxxx = 0, xxyy = 0, yyyy = 0;
};

/// The sums, of the normalised lobe: azimuths of asg_integral.h; radii in w, in which the
/// exponential is smooth and the moments of narrow lobes do not cancel: t = x^2 + y^2 = w (2 - w),
/// dx dy = (1 - w) dw d(azimuth).
inline AsgSums asg_sums(double large, double small) {
  constexpr int kAzimuths = 18;
  constexpr double kOffset = 12.5, kTail = 40;  // exp(-40) is out of sight
  const auto& radii = unit_gauss<30>();
  const double squeeze = (small + kOffset) / (large + kOffset);
  AsgSums sum;
  for (const double cos_squared : quarter_turn_cosines_squared<double, kAzimuths>()) {
    const double sin_squared = 1 - cos_squared;
    const auto azimuth = asg_azimuth(large, small, squeeze, cos_squared, sin_squared);
    const double k = azimuth.bandwidth, c = azimuth.cos_squared, s = azimuth.sin_squared;
    const double t_end = k > kTail ? kTail / k : 1.0;
    const double w_end = t_end / (1 + std::sqrt(1 - t_end));
    const double jacobian = w_end / (squeeze * cos_squared + sin_squared);
    for (size_t i = 0; i < radii.node.size(); ++i) {
      const double w = w_end * radii.node[i];
      const double t = w * (2 - w);
      const double f = jacobian * radii.weight[i] * (1 - w) * std::exp(-k * t);
      sum.one += f;
      sum.w1 += f * w;
      sum.w2 += f * w * w;
      sum.w3 += f * w * w * w;
      sum.w4 += f * w * w * w * w;
      sum.xx += f * t * c;
      sum.xxw += f * t * c * w;
      sum.xxww += f * t * c * w * w;
      sum.yy += f * t * s;
      sum.yyw += f * t * s * w;
      sum.yyww += f * t * s * w * w;
      sum.xxxx += f * t * t * c * c;
      sum.xxyy += f * t * t * c * s;
      sum.yyyy += f * t * t * s * s;
    }
  }
  for (double* value : {&sum.w1, &sum.w2, &sum.w3, &sum.w4, &sum.xx, &sum.xxw, &sum.xxww, &sum.yy,
                        &sum.yyw, &sum.yyww, &sum.xxxx, &sum.xxyy, &sum.yyyy})
    *value /= sum.one;
  return sum;
}

}  // namespace internal

/// Moments of an ASG of any bandwidths from 0 on: relative error 1e-11 in double (of those odd in
/// d: of their largest possible value for the others), rounding in float. 540 exponentials: once
/// per lobe.
template <class T>
LobeMoments<T> asg_moments(T bandwidth_x, T bandwidth_y) {
  const bool x_is_narrow = bandwidth_x >= bandwidth_y;
  const internal::AsgSums s = x_is_narrow ? internal::asg_sums(bandwidth_x, bandwidth_y)
                                          : internal::asg_sums(bandwidth_y, bandwidth_x);
  // d = w1 - w, so that the central moments are differences of numbers of their own size.
  const double w1 = s.w1;
  LobeMoments<double> m;
  m.mean_z = 1 - w1;
  m.mean_xx = s.xx;
  m.mean_yy = s.yy;
  m.variance_z = s.w2 - w1 * w1;
  m.mean_xxz = w1 * s.xx - s.xxw;
  m.mean_yyz = w1 * s.yy - s.yyw;
  m.mean_zzz = -(s.w3 - 3 * w1 * s.w2 + 2 * w1 * w1 * w1);
  m.mean_xxxx = s.xxxx;
  m.mean_yyyy = s.yyyy;
  m.mean_zzzz = s.w4 - 4 * w1 * s.w3 + 6 * w1 * w1 * s.w2 - 3 * w1 * w1 * w1 * w1;
  m.mean_xxyy = s.xxyy;
  m.mean_xxzz = w1 * w1 * s.xx - 2 * w1 * s.xxw + s.xxww;
  m.mean_yyzz = w1 * w1 * s.yy - 2 * w1 * s.yyw + s.yyww;
  if (!x_is_narrow) {
    std::swap(m.mean_xx, m.mean_yy);
    std::swap(m.mean_xxz, m.mean_yyz);
    std::swap(m.mean_xxxx, m.mean_yyyy);
    std::swap(m.mean_xxzz, m.mean_yyzz);
  }
  return m.cast<T>();
}

/// What a matched Gaussian needs to know of a unit-amplitude ASG.
template <class T>
struct AsgSecondMoments {
  T integral;
  T mean_xx, mean_yy;  ///< E[(v.x)^2], E[(v.y)^2] of the normalised lobe; E[(v.z)^2] is the rest
};

namespace internal {

/// Integral of r^3 exp(-k r^2) over 0..1, times two: (1 - (1 + k) exp(-k)) / k^2.
template <class T>
T disc_second_moment(T k) {
  if (k > 1) return (1 - (1 + k) * std::exp(-k)) / (k * k);
  T sum = 0, power = T(0.5);  // (-k)^n / (n + 2)!
  for (int n = 0; n < 17; ++n) {
    sum += power * T(n + 1);
    power *= -k / T(n + 3);
  }
  return sum;
}

}  // namespace internal

/// By the quadrature of asg_integral_midpoints, for bandwidths from 0 on: relative error 3e-6 in
/// float, 1e-13 in double. 8 or 18 exponentials.
template <class T>
AsgSecondMoments<T> asg_second_moments(T bandwidth_x, T bandwidth_y) {
  const T edge = internal::kEdgeOutOfSight<T> + 3;  // the moments' edge is k exp(-k)
  if (std::min(bandwidth_x, bandwidth_y) > edge)
    return {asg_integral_fast(bandwidth_x, bandwidth_y), 1 / (2 * bandwidth_x),
            1 / (2 * bandwidth_y)};
  constexpr T kOffset = T(12.5);
  constexpr int kAzimuths = std::is_same_v<T, float> ? 8 : 18;
  const T large = std::max(bandwidth_x, bandwidth_y), small = std::min(bandwidth_x, bandwidth_y);
  const T squeeze = (small + kOffset) / (large + kOffset);
  T mass = 0, narrow = 0, wide = 0;
  for (const T cos_squared : internal::quarter_turn_cosines_squared<T, kAzimuths>()) {
    const auto azimuth = internal::asg_azimuth(large, small, squeeze, cos_squared, 1 - cos_squared);
    const T weight = azimuth.bandwidth + kOffset;
    const T second = weight * internal::disc_second_moment(azimuth.bandwidth);
    mass += weight * one_minus_exp_over(azimuth.bandwidth);
    narrow += second * azimuth.cos_squared;
    wide += second * azimuth.sin_squared;
  }
  const T scale = kPi<T> / (std::sqrt(large + kOffset) * std::sqrt(small + kOffset) * kAzimuths);
  const bool x_is_narrow = bandwidth_x >= bandwidth_y;
  return {scale * mass, (x_is_narrow ? narrow : wide) / mass, (x_is_narrow ? wide : narrow) / mass};
}

/// Moments, exact, of a uniform cap around z (a spherical light) of a height 1 - cos(its radius) in
/// [0, 2]. The height is the argument because the cosine has no digits for small caps.
template <class T>
LobeMoments<T> cap_moments(T height) {
  const T h = height, mean = 1 - h / 2;  // v.z is uniform in [1 - h, 1]
  const T variance = h * h / 12;
  const T fourth = h * h * h * h / 80;
  const T xx = h / 2 - h * h / 6;
  const T xxzz = ((h - h * h / 4) * variance - fourth) / 2;
  const T rrrr = h * h * (T(4) / 3 - h + h * h / 5);  // E[(1 - z^2)^2]
  LobeMoments<T> m;
  m.mean_z = mean;
  m.mean_xx = m.mean_yy = xx;
  m.variance_z = variance;
  m.mean_xxz = m.mean_yyz = -mean * variance;
  m.mean_xxxx = m.mean_yyyy = T(0.375) * rrrr;
  m.mean_zzzz = fourth;
  m.mean_xxyy = T(0.125) * rrrr;
  m.mean_xxzz = m.mean_yyzz = xxzz;
  return m;
}

/// Mean of max(n . v, 0) over the distribution, `normal` in the distribution's frame. Relative L2
/// error over normals at most .002 for ASGs and caps of any width, .001 on average. Exact where the
/// whole lobe is above or below the horizon, and for narrow lobes; never below max(E[n . v], 0).
///
/// n . v is taken as normal with the exact mean and variance, and its skewness g and excess
/// kurtosis k enter as in Edgeworth's series, sigma phi(r) (-g r / 6 + k (r^2 - 1) / 24), r = mean
/// / sigma. That series is for small g and k; its coefficients, and those of two terms more, were
/// fitted over 62 lobes and caps instead (Edgeworth's own: .011; without: .036).
template <class T>
T mean_clamped_cosine(const LobeMoments<T>& moments, const Vector3<T>& normal) {
  const LobeMoments<T>& m = moments;
  const T z = normal.z();
  const T xx = normal.x() * normal.x(), yy = normal.y() * normal.y(), zz = z * z;
  const T mean = z * m.mean_z;
  const T variance = xx * m.mean_xx + yy * m.mean_yy + zz * m.variance_z;
  const T deviation = std::sqrt(variance);
  const T inverse = 1 / std::max(deviation, T(1e-12));  // a needle has none
  const T r = mean * inverse;
  if (r > 6) return mean;
  if (r < -6) return 0;
  const T third = z * (zz * m.mean_zzz + 3 * (xx * m.mean_xxz + yy * m.mean_yyz));
  const T fourth = xx * xx * m.mean_xxxx + yy * yy * m.mean_yyyy + zz * zz * m.mean_zzzz +
                   6 * (xx * yy * m.mean_xxyy + zz * (xx * m.mean_xxzz + yy * m.mean_yyzz));
  const T g = third * inverse * inverse * inverse;
  const T k = fourth * inverse * inverse * inverse * inverse - 3;
  const T correction =
      g * r * (T(-0.1722) + T(0.1893) * k) + k * (T(0.113) * r * r - T(0.0291) + T(0.036) * k);
  const T density = std::exp(-r * r / 2) / std::sqrt(2 * kPi<T>);
  const T above = std::erfc(-r / std::sqrt(T(2))) / 2;
  // max(E, 0) <= E[max] <= (E + sqrt(E[(n.v)^2])) / 2, for any distribution.
  return std::clamp(deviation * density * (1 + correction) + mean * above, std::max(mean, T(0)),
                    (mean + std::sqrt(mean * mean + variance)) / 2);
}

/// Integral of lobe(v) max(v . normal, 0) over the sphere, `normal` unit: error as
/// mean_clamped_cosine, never negative for amplitudes >= 0. It finds the lobe's moments at every
/// call; for many normals, keep asg_moments and integral(lobe), which depend on the lobe alone, and
/// multiply the latter by mean_clamped_cosine of each normal.
template <class T>
T clamped_cosine_integral(const AnisotropicGaussian<T>& lobe, const Vector3<T>& normal) {
  const LobeMoments<T> moments = asg_moments(lobe.bandwidth_x, lobe.bandwidth_y);
  return integral(lobe) * mean_clamped_cosine(moments, lobe.frame.to_local(normal));
}

}  // namespace burnish
