#include "burnish/visibility/ssdf.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/batch.h"
#include "burnish/sphere/octahedral_map.h"

namespace burnish {
namespace {

/// Value and gradient from the four texels of a bilinear footprint.
SsdfSample interpolate(const OctahedralFootprint<float>& footprint, const float (&value)[4],
                       const Vector2<float>& uv, const Vector3f& direction) {
  float distance = 0, by_u = 0, by_v = 0;
  for (int i = 0; i < 4; ++i) {
    distance += footprint.weight[i] * value[i];
    by_u += footprint.weight_u[i] * value[i];
    by_v += footprint.weight_v[i] * value[i];
  }
  const Vector3f gradient = octahedral_gradient(direction, uv, by_u, by_v);
  const float length = gradient.norm();
  // Below this slope (a signed distance has 1, an encoded one more at the boundary and less far
  // from it) the direction is rounding noise.
  const bool has_gradient = length > 1e-4f;
  return {distance, has_gradient ? Vector3f(gradient / length) : Vector3f::Zero()};
}

}  // namespace

void encode_ssdf(std::span<float> distances, float amplitude_rad) noexcept {
  if (!(amplitude_rad > 0)) return;
  constexpr size_t kBlock = 256;
  float exponential[kBlock];
  for (size_t first = 0; first < distances.size(); first += kBlock) {
    const std::span<float> block =
        distances.subspan(first, std::min(kBlock, distances.size() - first));
    for (size_t i = 0; i < block.size(); ++i)
      exponential[i] = -2 / amplitude_rad * std::abs(block[i]);
    const std::span<float> e(exponential, block.size());
    batch::exp(e, e);
    for (size_t i = 0; i < block.size(); ++i)
      block[i] = std::copysign((1 - e[i]) / (1 + e[i]), block[i]);
  }
}

float decode_ssdf(float value, float amplitude_rad) noexcept {
  if (!(amplitude_rad > 0)) return value;
  const float size = std::min(std::abs(value), 1.0f);
  const float distance = amplitude_rad / 2 * std::log((1 + size) / (1 - size));
  return std::copysign(std::min(distance, kPi<float>), value);
}

SsdfSample lookup_ssdf(const float* texels, int resolution, const Vector3f& direction) noexcept {
  const Vector2<float> uv = direction_to_octahedral(direction);
  const OctahedralFootprint<float> footprint = octahedral_footprint(uv, resolution);
  float value[4];
  for (int i = 0; i < 4; ++i) value[i] = texels[footprint.texel[i]];
  return interpolate(footprint, value, uv, direction);
}

SsdfSample lookup_ssdf(const SsdfBasis& basis, const float* coefficients, int terms,
                       const Vector3f& direction) noexcept {
  const Vector2<float> uv = direction_to_octahedral(direction);
  const OctahedralFootprint<float> footprint = octahedral_footprint(uv, basis.resolution);
  const Eigen::Map<const Eigen::VectorXf> weights(coefficients, terms);
  float value[4];
  for (int i = 0; i < 4; ++i) {
    const size_t texel = static_cast<size_t>(footprint.texel[i]);
    const Eigen::Map<const Eigen::VectorXf> eigen(basis.eigen.data() + texel * basis.terms, terms);
    value[i] = basis.mean[texel] + eigen.dot(weights);
  }
  SsdfSample sample = interpolate(footprint, value, uv, direction);
  sample.distance = decode_ssdf(sample.distance, basis.amplitude_rad);
  return sample;
}

}  // namespace burnish
