#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/frame.h"
#include "burnish/sphere/spherical_gaussian.h"

/// Based on: anisotropic spherical Gaussians (xu2013asg). Equation numbers are that paper's.
namespace burnish {

/// amplitude * max(v . z, 0) * exp(-bandwidth_x (v . x)^2 - bandwidth_y (v . y)^2), Eq. 1.
/// The larger bandwidth is the narrower direction. With both bandwidths nu it matches a spherical
/// Gaussian of sharpness 2 nu (not nu).
template <class T>
struct AnisotropicGaussian {
  Frame<T> frame;     ///< z is the lobe's axis
  T bandwidth_x = 1;  ///< >= 0
  T bandwidth_y = 1;  ///< >= 0
  T amplitude = 1;
};

/// Finite for every input. x and y are measured from the axis, so that the peak is at frame.z
/// itself, however narrow the lobe: v . x of a rounded frame is off by an epsilon there.
template <class T>
T eval(const AnisotropicGaussian<T>& lobe, const Vector3<T>& direction) {
  const T z = direction.dot(lobe.frame.z);
  if (z <= 0) return T(0);
  const Vector3<T> offset = direction - lobe.frame.z;
  const T x = offset.dot(lobe.frame.x), y = offset.dot(lobe.frame.y);
  // (bandwidth x) x, since a bandwidth may be larger than 1 / smallest number
  return lobe.amplitude * z * std::exp(-(lobe.bandwidth_x * x) * x - (lobe.bandwidth_y * y) * y);
}

/// Integral over the sphere, at a level of accuracy the caller chooses.
template <class T>
T integral(const AnisotropicGaussian<T>& lobe, AsgIntegral level = AsgIntegral::exact) {
  return lobe.amplitude * asg_integral(lobe.bandwidth_x, lobe.bandwidth_y, level);
}

template <class T>
AnisotropicGaussian<T> rotate(const AnisotropicGaussian<T>& lobe,
                              const Eigen::Matrix<T, 3, 3>& rotation) {
  AnisotropicGaussian<T> result = lobe;
  result.frame = {rotation * lobe.frame.x, rotation * lobe.frame.y, rotation * lobe.frame.z};
  return result;
}

/// The ASG of the same peak and the same second derivatives there as a spherical Gaussian: equal
/// bandwidths of half its sharpness (Eq. 3). Their integrals agree to exp(-sharpness / 2); relative
/// L2 error .27 at sharpness 2, .018 at 20, .0018 at 200. The limit at sharpness 0 is a cosine.
template <class T>
AnisotropicGaussian<T> asg_from_sg(const SphericalGaussian<T>& lobe) {
  return {frame_from_axis(lobe.axis), lobe.sharpness / 2, lobe.sharpness / 2, lobe.amplitude};
}

/// Sharpness of the spherical Gaussian whose support has the same area: 2 sqrt(bandwidth_x
/// bandwidth_y), at most the largest finite number.
template <class T>
T effective_sharpness(const AnisotropicGaussian<T>& lobe) {
  const T sharpness = 2 * std::sqrt(lobe.bandwidth_x) * std::sqrt(lobe.bandwidth_y);
  return std::min(sharpness, std::numeric_limits<T>::max());
}

/// The spherical Gaussian of the same peak and, for narrow lobes, the same integral: the inverse of
/// asg_from_sg for equal bandwidths. Its shape is that of the lobe only for equal bandwidths:
/// relative L2 error .3 at a ratio of 4, .6 at 16, .9 at 100.
template <class T>
SphericalGaussian<T> sg_from_asg(const AnisotropicGaussian<T>& lobe) {
  return {lobe.frame.z, effective_sharpness(lobe), lobe.amplitude};
}

/// The matrix A of the algebraic form max(v . z, 0) exp(-v^T A v), Eq. 2, z its eigenvector of the
/// smallest eigenvalue.
template <class T>
Eigen::Matrix<T, 3, 3> algebraic_form(const AnisotropicGaussian<T>& lobe) {
  return lobe.bandwidth_x * lobe.frame.x * lobe.frame.x.transpose() +
         lobe.bandwidth_y * lobe.frame.y * lobe.frame.y.transpose();
}

/// The lobe of a symmetric matrix's algebraic form, with bandwidth_x >= bandwidth_y. The smallest
/// eigenvalue e goes into the amplitude as exp(-e), since v^T v = 1; the matrix may be indefinite.
/// z points to the same side as `hint`. Where eigenvalues are equal, so are many frames.
template <class T>
AnisotropicGaussian<T> asg_from_algebraic(const Eigen::Matrix<T, 3, 3>& form,
                                          const Vector3<T>& hint, T amplitude = 1) {
  // In double: the small eigenvalues are lost in the rounding of the large one.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(form.template cast<double>());
  const Vector3d values = eigen.eigenvalues();  // rising
  Vector3d z = eigen.eigenvectors().col(0);
  if (z.dot(hint.template cast<double>()) < 0) z = -z;
  const Vector3d x = eigen.eigenvectors().col(2);
  return {Frame<double>{x, z.cross(x), z}.template cast<T>(), T(values[2] - values[0]),
          T(values[1] - values[0]), T(double(amplitude) * std::exp(-values[0]))};
}

/// Where a lobe of unit amplitude falls to a threshold: angles from its axis, toward +-x and +-y,
/// the half axes of an ellipse outside which the lobe is smaller.
template <class T>
struct AsgSupport {
  T angle_x, angle_y;  ///< radians, in [0, pi / 2]
};

/// Angle t with cos(t) exp(-bandwidth sin^2 t) = threshold, to rounding: 0 for a threshold >= 1, pi
/// / 2 for 0. Falls as either rises.
template <class T>
T support_angle(T bandwidth, T threshold) {
  const T target = -std::log(threshold);
  if (!(target > 0)) return 0;
  if (!std::isfinite(target)) return kPi<T> / 2;
  // In y = log cos^2 t: -y / 2 - bandwidth expm1(y) = target, concave. Newton's method from an
  // upper bound (of the two, the better), whence it falls to the root.
  T y = std::min(-target / (bandwidth + T(0.5)), 2 * (bandwidth - target));
  for (int step = 0; step < 8; ++step) {
    const T e = std::expm1(y);
    y += (-y / 2 - bandwidth * e - target) / (T(0.5) + bandwidth * (1 + e));
  }
  return std::atan2(std::sqrt(-std::expm1(y)), std::exp(y / 2));
}

template <class T>
AsgSupport<T> support(const AnisotropicGaussian<T>& lobe, T threshold) {
  return {support_angle(lobe.bandwidth_x, threshold), support_angle(lobe.bandwidth_y, threshold)};
}

}  // namespace burnish
