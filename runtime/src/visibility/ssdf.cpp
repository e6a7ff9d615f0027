#include "burnish/visibility/ssdf.h"

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
  // Below this slope (a signed distance has 1) the direction is rounding noise.
  const bool has_gradient = length > 1e-4f;
  return {distance, has_gradient ? Vector3f(gradient / length) : Vector3f::Zero()};
}

}  // namespace

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
  return interpolate(footprint, value, uv, direction);
}

}  // namespace burnish
