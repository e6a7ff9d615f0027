#pragma once

#include <vector>

#include "burnish/light/rgb.h"

namespace burnish::detail {

/// Weights that turn a reflectance spectrum, linear between rising wavelengths (nm), into linear
/// Rec. 709 RGB: rgb = sum of weight x value. A flat spectrum of 1 becomes white, (1, 1, 1). Colour
/// matching functions: wyman2013cie, within 1 % of the CIE 1931 ones. All zero where the spectrum
/// has no part in the visible.
std::vector<Rgb> rgb_weights(const std::vector<float>& wavelengths_nm);

}  // namespace burnish::detail
