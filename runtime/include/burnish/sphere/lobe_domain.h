#pragma once

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/circular_gaussian.h"
#include "burnish/sphere/normalised_asg.h"
#include "burnish/sphere/spherical_gaussian.h"

/// Where lobes enter from outside. Operators on lobes neither check nor throw: call one of these
/// once, where a lobe is made of values that may be wrong.
namespace burnish {

/// By how much a squared length may miss 1, and a frame's z the cross product of x and y: thirty
/// times what a rotation in single precision leaves.
inline constexpr double kAxisTolerance = 1e-5;

/// What is wrong with a lobe, as "sharpness is -1, expected a finite number >= 0"; empty when
/// nothing is. Axes must be unit (and frames orthonormal and right-handed) within kAxisTolerance,
/// widths finite and >= 0, the amplitude finite.
/// @{
template <class T>
std::string domain_error(const SphericalGaussian<T>& lobe);
template <class T>
std::string domain_error(const AnisotropicGaussian<T>& lobe);
template <class T>
std::string domain_error(const NormalisedAsg<T>& lobe);
template <class T>
std::string domain_error(const CircularGaussian<T>& lobe);
template <class T>
std::string domain_error(const LongitudinalGaussian<T>& lobe);
/// @}

/// The lobe itself, or std::invalid_argument with its domain_error.
template <class Lobe>
const Lobe& require_valid(const Lobe& lobe) {
  const std::string error = domain_error(lobe);
  if (!error.empty()) throw std::invalid_argument(error);
  return lobe;
}

namespace internal {

template <class T>
std::string scalar_error(const char* name, T value, bool may_be_negative) {
  if (std::isfinite(value) && (may_be_negative || value >= 0)) return {};
  return std::string(name) + " is " + std::to_string(value) + ", expected a finite number" +
         (may_be_negative ? "" : " >= 0");
}

template <class T>
std::string unit_error(const char* name, const Vector3<T>& axis) {
  const double length = axis.template cast<double>().norm();
  if (std::abs(length * length - 1) <= kAxisTolerance) return {};  // false for NaN, too
  return std::string(name) + " has length " + std::to_string(length) + ", expected 1";
}

template <class T>
std::string frame_error(const Frame<T>& frame) {
  for (const auto& [name, axis] :
       {std::pair{"frame.x", &frame.x}, {"frame.y", &frame.y}, {"frame.z", &frame.z}}) {
    std::string error = unit_error(name, *axis);
    if (!error.empty()) return error;
  }
  const Frame<double> f = frame.template cast<double>();
  const double skew = (f.x.cross(f.y) - f.z).norm();
  if (skew <= kAxisTolerance) return {};
  return "frame.z differs from the cross product of frame.x and frame.y by " +
         std::to_string(skew) + ", expected 0";
}

inline std::string first_error(std::initializer_list<std::string> errors) {
  for (const std::string& error : errors)
    if (!error.empty()) return error;
  return {};
}

}  // namespace internal

template <class T>
std::string domain_error(const SphericalGaussian<T>& lobe) {
  return internal::first_error({internal::unit_error("axis", lobe.axis),
                                internal::scalar_error("sharpness", lobe.sharpness, false),
                                internal::scalar_error("amplitude", lobe.amplitude, true)});
}

template <class T>
std::string domain_error(const AnisotropicGaussian<T>& lobe) {
  return internal::first_error({internal::frame_error(lobe.frame),
                                internal::scalar_error("bandwidth_x", lobe.bandwidth_x, false),
                                internal::scalar_error("bandwidth_y", lobe.bandwidth_y, false),
                                internal::scalar_error("amplitude", lobe.amplitude, true)});
}

template <class T>
std::string domain_error(const NormalisedAsg<T>& lobe) {
  return internal::first_error({internal::frame_error(lobe.frame),
                                internal::scalar_error("sharpness", lobe.sharpness, false),
                                internal::scalar_error("anisotropy", lobe.anisotropy, false),
                                internal::scalar_error("amplitude", lobe.amplitude, true)});
}

namespace internal {

template <class Lobe>
std::string angular_lobe_error(const Lobe& lobe) {
  return first_error({scalar_error("center", lobe.center, true),
                      scalar_error("sharpness", lobe.sharpness, false),
                      scalar_error("amplitude", lobe.amplitude, true)});
}

}  // namespace internal

template <class T>
std::string domain_error(const CircularGaussian<T>& lobe) {
  return internal::angular_lobe_error(lobe);
}

template <class T>
std::string domain_error(const LongitudinalGaussian<T>& lobe) {
  return internal::angular_lobe_error(lobe);
}

}  // namespace burnish
