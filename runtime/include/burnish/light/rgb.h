#pragma once

#include <Eigen/Core>

namespace burnish {

/// Linear RGB, Rec. 709 primaries.
using Rgb = Eigen::Array3f;

/// Luminance of a linear Rec. 709 colour.
inline float luminance(const Rgb& color) {
  return 0.2126f * color.x() + 0.7152f * color.y() + 0.0722f * color.z();
}

}  // namespace burnish
