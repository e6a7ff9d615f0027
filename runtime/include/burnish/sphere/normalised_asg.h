#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/frame.h"
#include "burnish/sphere/spherical_gaussian.h"

/// Based on: normalised anisotropic spherical Gaussians (huang2024nasg). Unlike an ASG, the lobe
/// has an integral in closed form and exact sampling without rejection, and no edge at the horizon.
/// Its contours are ellipses near the axis only.
namespace burnish {

/// amplitude * K^e exp(2 sharpness (K^(1 + e) - 1)), K = (1 + v . z) / 2,
/// e = anisotropy (v . x)^2 / (1 - (v . z)^2): a spherical Gaussian for anisotropy 0, narrower
/// along x otherwise.
template <class T>
struct NormalisedAsg {
  Frame<T> frame;    ///< z is the lobe's axis
  T sharpness = 1;   ///< >= 0
  T anisotropy = 0;  ///< >= 0
  T amplitude = 1;
};

namespace internal {

/// log of the lobe's value at unit amplitude.
template <class T>
T nasg_exponent(const NormalisedAsg<T>& lobe, const Vector3<T>& direction) {
  const bool front = lobe.frame.z.dot(direction) > 0;
  // x and y from the nearer pole: v . x of a rounded frame is off by an epsilon there.
  const Vector3<T> offset =
      front ? Vector3<T>(direction - lobe.frame.z) : Vector3<T>(direction + lobe.frame.z);
  const T x = lobe.frame.x.dot(offset), y = lobe.frame.y.dot(offset);
  const T square = x * x + y * y;
  // log K and the azimuth: on the axis K = 1, whatever the azimuth; opposite to it K^e = 0 unless
  // the azimuth or the anisotropy makes e zero.
  const T log_k = front ? std::log1p(T(-0.25) * std::min(offset.squaredNorm(), T(2)))
                        : std::log(offset.squaredNorm() / 4);
  const T e = lobe.anisotropy * (square > 0 ? std::min(x * x / square, T(1)) : T(front ? 0 : 1));
  return (e > 0 ? e * log_k : T(0)) + 2 * (lobe.sharpness * std::expm1((1 + e) * log_k));
}

}  // namespace internal

/// Value at a unit direction, accurate near the axis and near its opposite, where the lobe has no
/// limit: the least value around is returned there.
template <class T>
T eval(const NormalisedAsg<T>& lobe, const Vector3<T>& direction) {
  return lobe.amplitude * std::exp(internal::nasg_exponent(lobe, direction));
}

/// Integral over the sphere, exact: 2 pi (1 - exp(-2 sharpness)) / (sharpness sqrt(1 +
/// anisotropy)).
template <class T>
T integral(const NormalisedAsg<T>& lobe) {
  return lobe.amplitude * (2 * kPi<T> * internal::sg_mass(lobe.sharpness)) /
         std::sqrt(1 + lobe.anisotropy);
}

template <class T>
NormalisedAsg<T> rotate(const NormalisedAsg<T>& lobe, const Eigen::Matrix<T, 3, 3>& rotation) {
  NormalisedAsg<T> result = lobe;
  result.frame = {rotation * lobe.frame.x, rotation * lobe.frame.y, rotation * lobe.frame.z};
  return result;
}

/// A direction distributed as the lobe, from u and v uniform in [0, 1]; the amplitude is not used.
/// Density: pdf(lobe, direction).
///
/// dv = 2 dK dphi and d(K^(1 + e)) = (1 + e) K^e dK, so s = K^(1 + e) and the azimuth are
/// independent: s has density exp(2 l (s - 1)) on [0, 1], and phi 1 / (1 + a cos^2 phi), whose
/// integral is atan(tan(phi) / sqrt(1 + a)).
template <class T>
Vector3<T> sample(const NormalisedAsg<T>& lobe, T u, T v) {
  const T l = lobe.sharpness;
  const T drop =
      l < std::numeric_limits<T>::epsilon() ? u : -std::log1p(u * std::expm1(-2 * l)) / l / 2;
  const T psi = 2 * kPi<T> * v;
  const T cosine = std::cos(psi) / std::sqrt(1 + lobe.anisotropy), sine = std::sin(psi);
  const T norm = std::hypot(cosine, sine);  // 1 / sqrt(1 + e)
  const T log_k = std::log1p(-std::clamp(drop, T(0), T(1))) * (norm * norm);
  const T k = std::exp(log_k), one_minus_k = -std::expm1(log_k);
  const T radius = 2 * std::sqrt(k * one_minus_k);
  return lobe.frame.to_world(
      {radius * (cosine / norm), radius * (sine / norm), 1 - 2 * one_minus_k});
}

/// Density of sample(), per sr: the lobe over its integral.
template <class T>
T pdf(const NormalisedAsg<T>& lobe, const Vector3<T>& direction) {
  const T shape = std::exp(internal::nasg_exponent(lobe, direction));
  return internal::quotient_within_range(shape * std::sqrt(1 + lobe.anisotropy),
                                         2 * kPi<T> * internal::sg_mass(lobe.sharpness));
}

/// The ASG that the lobe is near its axis: bandwidth_x = sharpness (1 + anisotropy) / 2,
/// bandwidth_y = sharpness / 2, which differ from it by the order of 1 / bandwidth.
template <class T>
AnisotropicGaussian<T> asg_from_nasg(const NormalisedAsg<T>& lobe) {
  const T half = lobe.sharpness / 2;
  return {lobe.frame, std::min(half + half * lobe.anisotropy, std::numeric_limits<T>::max()), half,
          lobe.amplitude};
}

/// The inverse of asg_from_nasg; x and y are exchanged where bandwidth_y is the larger. A ratio of
/// bandwidths beyond the scalar's range becomes the largest finite number.
template <class T>
NormalisedAsg<T> nasg_from_asg(const AnisotropicGaussian<T>& lobe) {
  const Frame<T>& f = lobe.frame;
  const bool swap = lobe.bandwidth_y > lobe.bandwidth_x;
  const T large = std::max(lobe.bandwidth_x, lobe.bandwidth_y);
  const T small = std::min(lobe.bandwidth_x, lobe.bandwidth_y);
  const T excess = large > small ? internal::quotient_within_range(large - small, small) : T(0);
  return {swap ? Frame<T>{f.y, -f.x, f.z} : f, std::min(2 * small, std::numeric_limits<T>::max()),
          excess, lobe.amplitude};
}

}  // namespace burnish
