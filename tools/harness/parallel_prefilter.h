#pragma once

#include "burnish/light/prefiltered_environment.h"

namespace burnish {

/// prefilter_environment on all threads.
PrefilteredEnvironment prefilter_in_parallel(const Image& environment);

}  // namespace burnish
