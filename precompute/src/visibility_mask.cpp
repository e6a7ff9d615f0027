#include "burnish/precompute/visibility_mask.h"

#include <algorithm>
#include <bit>

#include "burnish/sphere/octahedral_map.h"

namespace burnish {

DirectionTable::DirectionTable(int resolution)
    : resolution_(resolution),
      tiles_(static_cast<std::size_t>(resolution / 4) * static_cast<std::size_t>(resolution / 4)) {
  const int across = resolution / 4;
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    const int x = static_cast<int>(t) % across * 4, y = static_cast<int>(t) / across * 4;
    for (int lane = 0; lane < 16; ++lane) {
      const Vector3f d =
          octahedral_texel_direction<double>(x + lane % 4, y + lane / 4, resolution).cast<float>();
      tiles_[t].x[lane] = d.x();
      tiles_[t].y[lane] = d.y();
      tiles_[t].z[lane] = d.z();
    }
  }
}

std::uint32_t above_horizon(const DirectionTile& tile, const Vector3f& normal) {
  float cosine[16];
  for (int i = 0; i < 16; ++i)
    cosine[i] = tile.x[i] * normal.x() + tile.y[i] * normal.y() + tile.z[i] * normal.z();
  std::uint32_t above = 0;
  for (int i = 0; i < 16; ++i) above |= static_cast<std::uint32_t>(cosine[i] > 0) << i;
  return above;
}

std::uint64_t sample_visibility(const RayScene& scene, const DirectionTable& table,
                                const Vector3f& position, const Vector3f& normal,
                                VisibilityMask& mask) {
  const Vector3f origin = position + scene.origin_offset() * normal;
  return sample_visibility_from(scene, table, origin, normal, mask);
}

std::uint64_t sample_visibility_from(const RayScene& scene, const DirectionTable& table,
                                     const Vector3f& origin, const Vector3f& normal,
                                     VisibilityMask& mask) {
  const std::size_t words = static_cast<std::size_t>(table.resolution()) / 64;
  const std::size_t tiles = 16 * words;  // in a row of tiles
  std::uint64_t rays = 0;
  for (std::size_t word = 0; word < mask.bits.size() / 4; ++word) {
    // A row of tiles is four rows of texels; 16 tiles side by side fill one word of each.
    const std::size_t tile_row = word / words, column = word % words;
    std::uint64_t rows[4] = {};
    for (std::size_t i = 0; i < 16; ++i) {
      const DirectionTile& tile = table.tiles()[tile_row * tiles + column * 16 + i];
      const std::uint32_t above = above_horizon(tile, normal);
      if (above == 0) continue;
      rays += static_cast<std::uint64_t>(std::popcount(above));
      const std::uint64_t visible =
          above & ~scene.occluded16(origin, tile.x, tile.y, tile.z, above);
      for (std::size_t row = 0; row < 4; ++row) rows[row] |= (visible >> (4 * row) & 15) << (4 * i);
    }
    for (std::size_t row = 0; row < 4; ++row)
      mask.bits[(tile_row * 4 + row) * words + column] = rows[row];
  }
  return rays;
}

}  // namespace burnish
