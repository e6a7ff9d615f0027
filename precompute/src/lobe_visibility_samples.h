#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "burnish/sphere/half_space.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/ssdf.h"

namespace burnish {

/// One random direction in each texel of a strata x strata octahedral map, row by row; the same
/// with every standard library. Vertex i is measured at number i % kEachOf and every kEachOf-th
/// from there: evenly spread, and not all vertices at the same ones.
inline std::vector<Vector3f> stratified_directions(int strata, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vector3f> directions;
  for (int y = 0; y < strata; ++y)
    for (int x = 0; x < strata; ++x) {
      const double u = (x + uniform()) / strata, v = (y + uniform()) / strata;
      directions.push_back(octahedral_to_direction(u, v).normalized().cast<float>());
    }
  return directions;
}
inline constexpr std::size_t kEachOf = 4;

/// Visible fraction of an isotropic lobe around a direction, as shading computes it.
inline double isotropic_fraction(float bandwidth, const Vector3f& direction,
                                 const SsdfSample& sample) {
  const AnisotropicGaussian<float> lobe{frame_from_axis(direction), bandwidth, bandwidth, 1};
  return static_cast<double>(
      visible_fraction(VisibilityModel::directional, lobe, sample.distance, sample.gradient));
}

/// Sums of a relative RMS error.
struct SquaredError {
  double error = 0, truth = 0;

  void add(double value, double exact) {
    error += (value - exact) * (value - exact);
    truth += exact * exact;
  }
  SquaredError& operator+=(const SquaredError& other) {
    error += other.error;
    truth += other.truth;
    return *this;
  }
  double relative_rms() const { return truth > 0 ? std::sqrt(error / truth) : 0; }
};

}  // namespace burnish
