#pragma once

#include "burnish/sphere/anisotropic_gaussian.h"

/// The cosine integral of a lobe from its first two moments: no quadrature per vertex, and no
/// product of two lobes, whose error is 20-30 % here (docs/maths.md, "Clamped cosine of a lobe").
namespace burnish {

/// Mean and second moments of a normalised distribution on the sphere, symmetric about its frame's
/// axes.
template <class T>
struct LobeMoments {
  T mean_z = 1;                ///< E[v.z]; E[v.x] = E[v.y] = 0
  T mean_xx = 0, mean_yy = 0;  ///< E[(v.x)^2], E[(v.y)^2]
  T variance_z = 0;            ///< Var[v.z]
};

/// Moments of an ASG of these bandwidths; relative error of each below 1e-5.
LobeMoments<double> asg_moments(double bandwidth_x, double bandwidth_y);

/// Moments, exact, of a uniform cap around z whose edge is at `cos_edge`, -1..1 (a spherical
/// light).
template <class T>
LobeMoments<T> cap_moments(T cos_edge) {
  const T mean = (1 + cos_edge) / 2;
  const T mean_zz = (1 + cos_edge + cos_edge * cos_edge) / 3;
  const T mean_xx = (1 - mean_zz) / 2;
  const T height = 1 - cos_edge;
  return {mean, mean_xx, mean_xx, height * height / 12};
}

/// Mean of max(n . v, 0) over the distribution, `normal` in the distribution's frame: n . v taken
/// as a normal variable with the exact mean and variance. Exact for narrow lobes and where the
/// whole lobe is above the horizon; relative L2 over normals .036 for a bandwidth of 0, .028 at 1,
/// .007 at (16, 4).
template <class T>
T mean_clamped_cosine(const LobeMoments<T>& moments, const Vector3<T>& normal) {
  const T mean = normal.z() * moments.mean_z;
  const T variance = normal.x() * normal.x() * moments.mean_xx +
                     normal.y() * normal.y() * moments.mean_yy +
                     normal.z() * normal.z() * moments.variance_z;
  const T deviation = std::sqrt(variance);
  const T ratio = mean / std::max(deviation, T(1e-12));
  if (ratio > 6) return mean;
  if (ratio < -6) return 0;
  const T density = std::exp(-ratio * ratio / 2) / std::sqrt(2 * kPi<T>);
  const T tail = std::erfc(-ratio / std::sqrt(T(2))) / 2;
  return std::max(deviation * density + mean * tail, T(0));
}

}  // namespace burnish
