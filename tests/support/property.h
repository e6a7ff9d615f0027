#pragma once

#include <cmath>
#include <cstdlib>

#include <rapidcheck/gtest.h>

#include "burnish/sphere/frame.h"

/// Inputs of property tests (RapidCheck), and their fixed seed. A failing property prints its
/// shrunken input and a string that reproduces it through the environment variable RC_PARAMS.
namespace burnish::test {

/// RapidCheck seeds itself from the clock unless RC_PARAMS says otherwise.
inline const int kPropertySeed = setenv("RC_PARAMS", "seed=2013 max_success=500", 0);

/// In [0, 1), on a grid of 2^-20; shrinks to 0.
inline double any_unit() { return *rc::gen::inRange(0, 1 << 20) / double(1 << 20); }

inline double any_between(double low, double high) { return low + (high - low) * any_unit(); }

/// Uniform in the logarithm.
inline double any_log_between(double low, double high) {
  return std::exp(any_between(std::log(low), std::log(high)));
}

/// Uniform over the sphere; shrinks to -z.
inline Vector3d any_direction() {
  const double z = any_between(-1, 1), phi = any_between(0, 2 * kPi<double>);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// A direction within `angle` of `axis`.
inline Vector3d any_direction_near(const Vector3d& axis, double angle) {
  const double theta = any_between(0, angle), phi = any_between(0, 2 * kPi<double>);
  return frame_from_axis(axis).to_world(
      {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
}

inline Frame<double> any_frame(const Vector3d& axis) {
  const double angle = any_between(0, 2 * kPi<double>);
  const Frame<double> frame = frame_from_axis(axis);
  const Vector3d x = std::cos(angle) * frame.x + std::sin(angle) * frame.y;
  return {x, axis.cross(x), axis};
}

inline Eigen::Matrix3d any_rotation() {
  return Eigen::AngleAxisd(any_between(0, kPi<double>), any_direction()).toRotationMatrix();
}

}  // namespace burnish::test
