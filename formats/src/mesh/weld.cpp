#include "weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace burnish::detail {
namespace {

/// Bits of a position: an order that also holds for NaN. Adding 0 makes -0 and 0 one.
std::array<std::uint32_t, 3> position_key(const Vector3f& p) {
  return {std::bit_cast<std::uint32_t>(p.x() + 0.f), std::bit_cast<std::uint32_t>(p.y() + 0.f),
          std::bit_cast<std::uint32_t>(p.z() + 0.f)};
}

}  // namespace

std::vector<std::uint32_t> weld_positions(std::span<const Vector3f> positions,
                                          std::uint32_t& points) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return position_key(positions[a]) < position_key(positions[b]);
  });
  std::vector<std::uint32_t> point(positions.size());
  points = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && position_key(positions[order[i]]) != position_key(positions[order[i - 1]]))
      ++points;
    point[order[i]] = points;
  }
  if (!order.empty()) ++points;
  return point;
}

}  // namespace burnish::detail
