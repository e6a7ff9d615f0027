#pragma once

#include <vector>

#include "burnish/light/light_rig.h"

namespace burnish {

/// Lobes of light as rows of narrower ones (lobe_comb.h), along one axis or both: a single boundary
/// tells little of what a wide lobe sees, each part has one of its own. Lobes with both bandwidths
/// at least `min_bandwidth` stay as they are; of the parts of others, those about the lobe's axis
/// have at least that, as far as kMaxTaps teeth along an axis go. A lobe's parts have its integral,
/// and differ from it by a relative L2 of at most .15.
std::vector<EnvironmentLobe> split_wide_lobes(const std::vector<EnvironmentLobe>& lobes,
                                              float min_bandwidth);

}  // namespace burnish
