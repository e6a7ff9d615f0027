#pragma once

#include "burnish/light/environment_map.h"
#include "burnish/sphere/direction.h"

namespace burnish {

/// Of a 3840 pixel wide display, 0.7 m wide, seen from 0.7 m: the published default, about 67.
inline constexpr double kFlipPixelsPerDegree = 3840 * kPi<double> / 180;

/// FLIP (andersson2020flip), the LDR form: how much a viewer who flips between two pictures sees
/// each pixel change, 0 (not at all) to 1, as a grey picture. Symmetric. Colours are compared after
/// the eye's contrast sensitivity has blurred them, and differences count more where only one
/// picture has an edge or a point. Pictures have one size and at least one pixel, and are encoded
/// for a display: sRGB, 0..1.
Image flip_map(const Image& test, const Image& reference,
               double pixels_per_degree = kFlipPixelsPerDegree);

/// The published mean: over all pixels of a map.
double flip_mean(const Image& map);

}  // namespace burnish
