#pragma once

#include "burnish/light/environment_map.h"

namespace burnish {

/// A photographer's studio as a lat-long environment, +y up: a dark room, lighter above; a warm
/// key light, a cool fill opposite, a broad soft box overhead, one long strip light behind, and a
/// small bright lamp. Radiance 0.02 to 60, every pixel finite and positive. `width` is twice the
/// height and at least 64.
Image studio_environment(int width = 512);

/// How an environment (+y up) stands in a world with the unit vector `up`: the smallest rotation of
/// +y to `up`, after a turn by `degrees` about +y (counter-clockwise seen from above).
Eigen::Matrix3f world_from_environment(const Vector3f& up, double degrees);

}  // namespace burnish
