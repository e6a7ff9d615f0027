#pragma once

#include "burnish/light/environment_map.h"

namespace burnish {

/// The map itself, whose pixels have edges, blurred by a bell of this variance (of a sine) along
/// the meridian and across it: lobes narrower than a filtered map's last level see few pixels. A
/// constant map gives that constant, to the bit. The fourth number is 0.
Eigen::Array4f eval_map_pixels(const Image& map, const Vector3f& direction,
                               float variance) noexcept;

}  // namespace burnish
