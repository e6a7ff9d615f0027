#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/sphere/direction.h"

namespace burnish::detail {

/// For each position the number of its point: positions that are exactly equal (-0 is 0) share one.
/// `points` receives how many there are.
std::vector<std::uint32_t> weld_positions(std::span<const Vector3f> positions,
                                          std::uint32_t& points);

}  // namespace burnish::detail
