#pragma once

#include "burnish/light/environment_map.h"

namespace burnish {

/// A photographer's studio as a lat-long environment, +y up: a dark room, lighter above; a warm key
/// light, a cool fill opposite, a broad soft box overhead and one long strip light behind. Radiance
/// 0.018 to about 10, every pixel finite and positive; a diffuse floor is neither dark nor burnt
/// out at exposure 0. `width` is twice the height and at least 64.
Image studio_environment(int width = 512);

/// How an environment (+y up) stands in a world with the unit vector `up`: the smallest rotation of
/// +y to `up`, after a turn by `degrees` about +y (counter-clockwise seen from above).
Eigen::Matrix3f world_from_environment(const Vector3f& up, double degrees);

}  // namespace burnish
