#pragma once

#include <cstdint>
#include <vector>

#include "burnish/precompute/ray_scene.h"

namespace burnish {

/// Sixteen directions: a 4 x 4 tile of texels of the octahedral map, row by row.
struct alignas(64) DirectionTile {
  float x[16], y[16], z[16];
};

/// The unit directions of all texel centres of a resolution x resolution octahedral map, tile by
/// tile: neighbours in a tile are neighbours on the sphere, so that a tile is a coherent packet.
class DirectionTable {
 public:
  /// `resolution`: a multiple of 8 (a tile never straddles a fold's corner), at most 8192.
  explicit DirectionTable(int resolution);

  int resolution() const { return resolution_; }

  /// Tile (x / 4, y / 4) is number y / 4 * resolution / 4 + x / 4.
  const std::vector<DirectionTile>& tiles() const { return tiles_; }

  Vector3f direction(int x, int y) const {
    const auto& tile = tiles_[static_cast<std::size_t>(y / 4 * (resolution_ / 4) + x / 4)];
    const int lane = y % 4 * 4 + x % 4;
    return {tile.x[lane], tile.y[lane], tile.z[lane]};
  }

 private:
  int resolution_;
  std::vector<DirectionTile> tiles_;
};

/// Which texels of an octahedral map are visible: one bit each, rows of resolution / 64 words, the
/// lowest bit first.
struct VisibilityMask {
  int resolution = 0;               ///< a multiple of 64
  std::vector<std::uint64_t> bits;  ///< [resolution * resolution / 64]

  VisibilityMask() = default;
  /// All texels occluded.
  explicit VisibilityMask(int resolution)
      : resolution(resolution),
        bits(static_cast<std::size_t>(resolution) * static_cast<std::size_t>(resolution) / 64) {}

  bool visible(int x, int y) const {
    const std::size_t texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(resolution) +
                              static_cast<std::size_t>(x);
    return bits[texel / 64] >> (texel % 64) & 1;
  }
  void set_visible(int x, int y) {
    const std::size_t texel = static_cast<std::size_t>(y) * static_cast<std::size_t>(resolution) +
                              static_cast<std::size_t>(x);
    bits[texel / 64] |= std::uint64_t{1} << (texel % 64);
  }
};

/// Bit i: direction i of the tile lies strictly above the horizon of `normal`, in float.
std::uint32_t above_horizon(const DirectionTile& tile, const Vector3f& normal);

/// Finds what a vertex sees. Rays leave from position + origin_offset * normal, into the directions
/// strictly above the horizon of the unit `normal`; what lies below counts as occluded. Fills
/// `mask`, which has the table's resolution (a multiple of 64). Returns the number of rays cast.
std::uint64_t sample_visibility(const RayScene& scene, const DirectionTable& table,
                                const Vector3f& position, const Vector3f& normal,
                                VisibilityMask& mask);

/// The same for rays that leave from `origin` itself.
std::uint64_t sample_visibility_from(const RayScene& scene, const DirectionTable& table,
                                     const Vector3f& origin, const Vector3f& normal,
                                     VisibilityMask& mask);

}  // namespace burnish
