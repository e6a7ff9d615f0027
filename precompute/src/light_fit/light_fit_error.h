#pragma once

#include "burnish/light/light_rig.h"
#include "burnish/precompute/fit_light.h"
#include "light_fit/reduced_environment.h"

namespace burnish {

/// The error of a rig against the environment that `map` was reduced from, all in the map's units.
LightFitError measure_light_fit(const ReducedEnvironment& map, const LightRig& rig);

/// That of the radiance alone.
double radiance_error(const ReducedEnvironment& map, const LightRig& rig);

}  // namespace burnish
