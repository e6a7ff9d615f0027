#pragma once

#include <functional>
#include <vector>

#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/sphere/octahedral_map.h"

namespace burnish::test {

using Predicate = std::function<bool(const Vector3d&)>;

inline VisibilityMask mask_of(int resolution, const Predicate& visible) {
  VisibilityMask mask(resolution);
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x)
      if (visible(octahedral_texel_direction<double>(x, y, resolution))) mask.set_visible(x, y);
  return mask;
}

inline VisibilityMask inverse(VisibilityMask mask) {
  for (std::uint64_t& bits : mask.bits) bits = ~bits;
  return mask;
}

inline std::vector<float> transform(const VisibilityMask& mask, int resolution) {
  const DirectionTable directions(mask.resolution);
  const SphericalDistanceTransform transform(directions, resolution);
  SphericalDistanceTransform::Scratch scratch;
  std::vector<float> ssdf(static_cast<std::size_t>(resolution * resolution), -100.0f);
  transform.transform(mask, ssdf, scratch);
  return ssdf;
}

inline float pitch(int resolution) {
  const DirectionTable directions(resolution);
  return SphericalDistanceTransform(directions, 16).boundary_pitch();
}

}  // namespace burnish::test
