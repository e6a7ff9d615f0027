#pragma once

#include "burnish/precompute/fit_brdf.h"

namespace burnish {

/// Throws Error for dials out of range.
void check_options(const BrdfFitOptions& options);

}  // namespace burnish
