#include "shading/ladder_share.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/half_space.h"
#include "burnish/visibility/visibility_ladder.h"

namespace burnish {
namespace {

float narrow_bandwidth(const AnisotropicGaussian<float>& lit) {
  return std::max(lit.bandwidth_x, lit.bandwidth_y) + 0.5f;
}

float wide_bandwidth(const AnisotropicGaussian<float>& lit) {
  return std::min(lit.bandwidth_x, lit.bandwidth_y) + 0.5f;
}

/// Calls visit(direction, weight, bandwidth) for the round lobes that a lobe is read by.
template <class Visit>
void for_each_part(const AnisotropicGaussian<float>& lit, const Visit& visit) {
  constexpr float kLong = 2;  // ratio of bandwidths from which on three places are read
  const float wide = wide_bandwidth(lit), narrow = narrow_bandwidth(lit);
  const Vector3f& axis = lit.frame.z;
  if (narrow < kLong * wide) return visit(axis, 1.0f, std::sqrt(wide * narrow));
  // Each part as wide as the lobe is narrow, but at least half as wide as it is long; their places
  // have the rest of its variance.
  const float part = std::min(narrow, 4 * wide);
  const float tangent = std::sqrt(1.5f * (1 / wide - 1 / part));
  const Vector3f offset = tangent * (lit.bandwidth_x < lit.bandwidth_y ? lit.frame.x : lit.frame.y);
  const float bandwidth = std::sqrt(part * narrow);
  visit(axis, 2.0f / 3, bandwidth);
  visit((axis + offset).normalized(), 1.0f / 6, bandwidth);
  visit((axis - offset).normalized(), 1.0f / 6, bandwidth);
}

}  // namespace

float ladder_weight(float bandwidth, float crossover) {
  if (!(crossover > 0)) return 0;
  const float octaves = std::log2(bandwidth / crossover);
  const float t = std::clamp((1 - octaves) / 2, 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

float ladder_bandwidth(const AnisotropicGaussian<float>& lit) {
  return std::sqrt(wide_bandwidth(lit)) * std::sqrt(narrow_bandwidth(lit));
}

float seen_by_ladder(const LadderBasis& basis, const float* coefficients,
                     const AnisotropicGaussian<float>& lit) {
  const VisibilityHarmonics harmonics = reconstruct_harmonics(basis, coefficients);
  float seen = 0;
  for_each_part(lit, [&](const Vector3f& direction, float weight, float bandwidth) {
    seen += weight * visible_fraction(harmonics, direction, lobe_bands(bandwidth));
  });
  return seen;
}

float above_horizon(const Vector3f& normal, const AnisotropicGaussian<float>& lit) {
  float above = 0;
  for_each_part(lit, [&](const Vector3f& direction, float weight, float bandwidth) {
    const float sine = std::clamp(normal.dot(direction), -1.0f, 1.0f);
    above += weight * visible_fraction_hemisphere(2 * bandwidth, std::asin(sine));
  });
  return above;
}

}  // namespace burnish
