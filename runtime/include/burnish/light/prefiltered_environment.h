#pragma once

#include <vector>

#include "burnish/light/environment_map.h"
#include "burnish/sphere/anisotropic_gaussian.h"

namespace burnish {

/// An environment averaged over isotropic lobes of a ladder of bandwidths, on equal-area octahedral
/// maps.
struct PrefilteredEnvironment {
  struct Level {
    float bandwidth;            ///< ASG bandwidth of the lobe (an SG of twice this sharpness)
    int resolution;             ///< texels along an edge
    std::vector<Rgb> radiance;  ///< [resolution^2], mean radiance under the lobe
  };
  std::vector<Level> levels;  ///< by rising bandwidth, a factor of two apart
  /// Turns world directions into the environment's frame; may be changed at any time, at no cost.
  Eigen::Matrix3f environment_from_world = Eigen::Matrix3f::Identity();
};

/// Filters a lat-long environment. About a second for 1024 x 512 pixels on one core.
PrefilteredEnvironment prefilter_environment(const Image& environment);

/// Mean radiance of the environment under a lobe: (integral of lobe * L) / (integral of lobe). An
/// anisotropic lobe is taken as taps along its long axis, at most `max_taps`. A constant
/// environment gives exactly that constant.
Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps);

}  // namespace burnish
