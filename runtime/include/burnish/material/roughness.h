#pragma once

#include <algorithm>

#include "burnish/material/material.h"

namespace burnish {

/// Of a perceptual roughness, kMinRoughness..1, the alpha of the models: its square (burley2012).
/// The one place where the two meet.
inline float alpha_from_roughness(float roughness) {
  return std::max(roughness * roughness, kMinAlpha);  // rounding of the smallest
}

/// Bounds of a roughness: those of alpha.
inline constexpr float kMinRoughness = 0.01f;
inline constexpr float kMaxRoughness = 1.0f;

}  // namespace burnish
