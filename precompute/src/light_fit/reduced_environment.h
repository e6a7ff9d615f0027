#pragma once

#include "burnish/light/environment_map.h"

namespace burnish {

/// A smaller map of the same light.
struct ReducedEnvironment {
  Image image;
  double spread = 0;  ///< integral of |radiance - its mean over the pixel|^2
};

/// Maps are fitted and measured at this width at most: pixels of 0.09 degrees, a sixth of the sun.
inline constexpr int kMaxFitWidth = 4096;

/// The map, no wider than `max_width` and no higher than half of it: pixels of the result are exact
/// means by solid angle. Of a small enough map a copy.
ReducedEnvironment reduce_environment(const Image& environment, int max_width = kMaxFitWidth);

}  // namespace burnish
