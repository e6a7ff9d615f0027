#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/anisotropic_gaussian.h"

namespace burnish {

/// A measured BRDF as a mixture of lobes over half vectors times a smooth factor (xu2013asg,
/// section 5.2, with M in tables): f = D(h) F(h.o) S(o.z) S(i.z). All in the local frame, z the
/// normal.
struct FittedSpecular {
  /// D(h): 1..kMaxFittedLobes, bandwidths > 0, amplitudes >= 0. An axis away from the normal is an
  /// off-specular reflection.
  std::vector<AnisotropicGaussian<float>> lobes;
  /// F: by channel, >= 0, at angles between h and o that divide 0..pi/2 evenly; 2..kMaxFittedTable.
  std::vector<Rgb> color_by_difference;
  /// S: >= 0, at angles from the normal that divide 0..pi/2 evenly; 2..kMaxFittedTable. It holds
  /// the root of all that depends on one direction: shadowing, and 1 / cos.
  std::vector<float> masking;
};

inline constexpr int kMaxFittedLobes = 8;
inline constexpr std::size_t kMaxFittedTable = 4096;
/// Of D F S S, by the greatest of each: that of a lobe of alpha 1e-4 is 3e7.
inline constexpr float kMaxFittedValue = 1e9f;

/// D(h), of a unit half vector; 0 below the horizon.
float eval_distribution(const FittedSpecular& fitted, const Vector3f& half);
/// F S S, of cosines that are clamped to 0..1; tables are interpolated linearly in the angle.
Rgb eval_smooth_factor(const FittedSpecular& fitted, float cos_outgoing, float cos_incoming,
                       float cos_difference);

/// What is wrong with its numbers, naming the field, or nothing.
std::string domain_error(const FittedSpecular& fitted);

}  // namespace burnish
