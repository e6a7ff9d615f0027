#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/material/material.h"

/// What the BRDF models share. All directions are in the local frame.
namespace burnish::internal {

/// Models with 1 / cos have poles at the horizon; the cosine below which they are held. The BRDF
/// and the smooth factor share it.
inline constexpr float kMinCosine = 1e-5f;

struct HalfVector {
  Vector3f h;
  float cos_difference;  ///< h . i = h . o; 0 for exactly opposite directions, which have no h
};

/// The same to the last bit when the directions are swapped.
inline HalfVector half_vector(const Vector3f& outgoing, const Vector3f& incoming) {
  const Vector3f sum = incoming + outgoing;
  const float length = sum.norm();
  if (length < 1e-6f) return {Vector3f::UnitZ(), 0};
  return {sum / length, length / 2};
}

/// (h.x / alpha_x)^2 + (h.y / alpha_y)^2
inline float ellipse(float alpha_x, float alpha_y, const Vector3f& h) {
  const float x = h.x() / alpha_x, y = h.y() / alpha_y;
  return x * x + y * y;
}

/// log(h.z) for h.z > 0, near the axis from the sine, which keeps its digits there.
inline float log_cosine(const Vector3f& h) {
  const float sine2 = h.x() * h.x() + h.y() * h.y();
  return sine2 < 0.5f ? std::log1p(-sine2) / 2 : std::log(h.z());
}

/// The direction of a sine and an azimuth, with its cosine given, since the sine may be tiny.
inline Vector3f from_sine(float sine, float cosine, float cos_phi, float sin_phi) {
  return {sine * cos_phi, sine * sin_phi, cosine};
}

}  // namespace burnish::internal
