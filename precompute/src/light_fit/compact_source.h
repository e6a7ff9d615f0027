#pragma once

#include <optional>

#include "burnish/light/environment_map.h"
#include "burnish/light/light_rig.h"

namespace burnish {

/// Finds the brightest compact source that outshines everything else (the sun, a bare bulb), takes
/// it out of the map, filling its place with the radiance around it, and returns it as a lobe of
/// the same energy, centre and extent. Nothing, and the map untouched, if there is no such source.
/// `max_bandwidth` limits the lobe. Pixels in [0, 1].
std::optional<EnvironmentLobe> take_compact_source(Image& environment, double max_bandwidth);

}  // namespace burnish
