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
};

/// Filters a lat-long environment. `world_from_environment` turns the environment's frame into the
/// world's.
PrefilteredEnvironment prefilter_environment(const Image& environment,
                                             const Eigen::Matrix3f& world_from_environment);

/// Mean radiance of the environment under a lobe: (integral of lobe * L) / (integral of lobe). An
/// anisotropic lobe is taken as taps along its long axis, at most `max_taps`. A constant
/// environment gives exactly that constant.
Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps);

}  // namespace burnish
