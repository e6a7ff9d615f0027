#pragma once

#include "harness/picture.h"

/// From radiance to what a display shows, for metrics of what is seen. One exposure serves a
/// picture and all that is compared with it.
namespace burnish {

inline constexpr float kMiddleGrey = 0.18f;

/// The factor that brings the mean luminance of the pixels that the mesh fills to kMiddleGrey; 1
/// where they are black or there are none.
float exposure_of(const Picture& picture);

/// Radiance times `exposure`, clamped to 0..1, through the sRGB transfer function.
Image tone_map(const Image& radiance, float exposure);

}  // namespace burnish
