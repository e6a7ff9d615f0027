#include "burnish/visibility/visibility_ladder.h"

#include "burnish/sphere/octahedral_map.h"

namespace burnish {

float lookup_ladder(const LadderBasis& basis, const float* coefficients, const Vector3f& direction,
                    const LadderLevels& levels) noexcept {
  const OctahedralFootprint<float> footprint =
      octahedral_footprint(direction_to_octahedral(direction), basis.resolution);
  const auto terms = static_cast<size_t>(basis.terms);
  const auto texels = static_cast<size_t>(basis.resolution) * static_cast<size_t>(basis.resolution);
  const Eigen::Map<const Eigen::VectorXf> weights(coefficients, basis.terms);
  const auto at_level = [&](int level) {
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
      const size_t texel =
          static_cast<size_t>(level) * texels + static_cast<size_t>(footprint.texel[i]);
      const Eigen::Map<const Eigen::VectorXf> eigen(basis.eigen.data() + texel * terms,
                                                    basis.terms);
      sum += footprint.weight[i] * (basis.mean[texel] + eigen.dot(weights));
    }
    return sum;
  };
  float fraction = at_level(levels.first);
  if (levels.weight > 0) fraction += levels.weight * (at_level(levels.second) - fraction);
  return std::clamp(fraction, 0.0f, 1.0f);
}

}  // namespace burnish
