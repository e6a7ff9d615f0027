#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/shading/transfer.h"
#include "burnish/sphere/sg_half_space.h"

/// What wide lobes see: a fraction stored for a few bandwidths, and interpolated linearly in the
/// bandwidth's logarithm (docs/maths.md, "Visibility ladder").
namespace burnish {

/// Two neighbouring levels of a ladder and the weight of the second. A bandwidth beyond the first
/// or the last level counts as that level's.
struct LadderLevels {
  int first = 0, second = 0;
  float weight = 0;
};

inline LadderLevels ladder_levels(const LadderBasis& basis, float bandwidth) {
  const auto& levels = basis.bandwidths;
  const auto above = std::upper_bound(levels.begin(), levels.end(), bandwidth);
  const int second = static_cast<int>(above - levels.begin());
  if (second == 0) return {};
  if (above == levels.end()) return {second - 1, second - 1, 0};
  const float low = *(above - 1);
  return {second - 1, second, std::log(bandwidth / low) / std::log(*above / low)};
}

/// The fraction, 0..1, of a lobe exp(2 bandwidth (v . direction - 1)) that is visible: mean + eigen
/// * coefficients of the two levels next to the bandwidth, bilinear in the direction.
float lookup_ladder(const LadderBasis& basis, const float* coefficients, const Vector3f& direction,
                    const LadderLevels& levels) noexcept;

inline float lookup_ladder(const LadderBasis& basis, const float* coefficients,
                           const Vector3f& direction, float bandwidth) noexcept {
  return lookup_ladder(basis, coefficients, direction, ladder_levels(basis, bandwidth));
}

/// The same fraction where nothing occludes but the horizon, whose distance from the direction is
/// given (radians), interpolated between the same two levels: the ladder's own error between them
/// cancels in the ratio.
inline float ladder_horizon_fraction(const LadderBasis& basis, float horizon_distance,
                                     const LadderLevels& levels) {
  const auto fraction = [&](int level) {
    return visible_fraction_hemisphere(2 * basis.bandwidths[static_cast<size_t>(level)],
                                       horizon_distance);
  };
  const float first = fraction(levels.first);
  if (levels.weight == 0) return first;
  return first + levels.weight * (fraction(levels.second) - first);
}

}  // namespace burnish
