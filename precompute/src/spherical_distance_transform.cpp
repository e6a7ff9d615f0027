#include "burnish/precompute/spherical_distance_transform.h"

#include <algorithm>

#include "burnish/sphere/octahedral_map.h"
#include "nearest_boundary.h"
#include "visibility_boundary.h"

namespace burnish {
namespace {

constexpr int kLeaf = 8;  // texels along the edge of a square on the finest level

// Squares along an edge of the map on the coarsest: larger ones leave out hardly anything.
int root_across(int resolution) { return std::min(resolution / kLeaf, 8); }

float pitch_of(int resolution) {
  double largest = 0;
  // The map's symmetries: one quarter says it all.
  for (int y = 0; y < resolution / 2; ++y)
    for (int x = 0; x < resolution / 2; ++x) {
      const auto center = octahedral_texel_direction<double>(x, y, resolution);
      for (const auto& [right, down] : {std::pair{0.0, 0.5}, {1.0, 0.5}, {0.5, 0.0}, {0.5, 1.0}}) {
        const auto edge =
            octahedral_to_direction<double>((x + right) / resolution, (y + down) / resolution);
        largest = std::max(largest, angle_between<double>(center, edge));
      }
    }
  return static_cast<float>(2 * largest);
}

SphericalDistanceTransform::Square square_of(const DirectionTable& texels, int x, int y, int size) {
  const auto texel = [&](int k) { return texels.direction(x + k % size, y + k / size); };
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < size * size; ++k) sum += texel(k).cast<double>();
  SphericalDistanceTransform::Square square{(sum / (size * size)).cast<float>(), 0};
  for (int k = 0; k < size * size; ++k)
    square.radius = std::max(square.radius, (texel(k) - square.center).norm());
  return square;
}

}  // namespace

SphericalDistanceTransform::SphericalDistanceTransform(const DirectionTable& directions,
                                                       int resolution)
    : texels_(resolution), boundary_pitch_(pitch_of(directions.resolution())) {
  for (int across = root_across(resolution); across * kLeaf <= resolution; across *= 2) {
    const int size = resolution / across;
    std::vector<Square>& squares = levels_.emplace_back();
    for (int i = 0; i < across * across; ++i)
      squares.push_back(square_of(texels_, i % across * size, i / across * size, size));
  }
}

void SphericalDistanceTransform::transform(const VisibilityMask& mask, std::span<float> ssdf,
                                           Scratch& scratch) const {
  collect_boundary(mask, scratch);
  if (scratch.cell_begin.size() == 1) {
    std::fill(ssdf.begin(), ssdf.end(), mask.visible(0, 0) ? kPi<float> : -kPi<float>);
    return;
  }
  if (scratch.signs.size() < ssdf.size()) scratch.signs.resize(ssdf.size());
  boundary_signs(mask, resolution(), scratch.signs.data());
  const auto across = static_cast<std::size_t>(root_across(resolution()));
  find_nearest_boundary({texels_, across, levels_}, mask.resolution, scratch, ssdf.data());
}

}  // namespace burnish
