#include "burnish/precompute/spherical_distance_transform.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <Eigen/Core>

#include "burnish/sphere/octahedral_map.h"

// How the nearest points are found: a quadtree of squares of texels. Let the texels of a square lie
// in a ball of radius r around c, and p0 be the boundary point nearest to c. For unit vectors, p is
// nearer than p0 to a texel q if q.(p0 - p) < 0; over the ball the left side is never less than
// c.(p0 - p) - r |p0 - p|, so p can be the nearest of some texel only if
//     (|c - p|^2 - |c - p0|^2) / 2 <= r |p0 - p|.
// A square hands only such points to its four children, and a leaf compares all it was given.
// Distances are chords, which order as angles do.

namespace burnish {
namespace {

constexpr int kLeaf = 4;        // texels along the edge of a leaf
constexpr int kRootAcross = 4;  // squares along an edge on the coarsest level
using Points = SphericalDistanceTransform::Scratch::Points;

// Points are handled in groups, for SIMD. The last group is filled up with copies of a point, which
// change no minimum.
constexpr std::size_t kGroup = 8;
using Group = Eigen::Array<float, kGroup, 1>;

void reserve(Points& points, std::size_t size) {
  points.x.resize(size);
  points.y.resize(size);
  points.z.resize(size);
}

void add_midpoint(const Vector3f& a, const Vector3f& b, Points& points) {
  if (points.size + kGroup >= points.x.size()) reserve(points, 2 * points.size + 1024);
  const Vector3f middle = (a + b).normalized();
  points.x[points.size] = middle.x();
  points.y[points.size] = middle.y();
  points.z[points.size] = middle.z();
  ++points.size;
}

// Needs room for kGroup - 1 more points, and at least one point.
void fill_last_group(Points& points) {
  for (const std::size_t last = points.size - 1; points.size % kGroup != 0; ++points.size) {
    points.x[points.size] = points.x[last];
    points.y[points.size] = points.y[last];
    points.z[points.size] = points.z[last];
  }
}

inline auto squared_chord(const Points& points, std::size_t first, const Vector3f& to) {
  return (Eigen::Map<const Group>(points.x.data() + first) - to.x()).square() +
         (Eigen::Map<const Group>(points.y.data() + first) - to.y()).square() +
         (Eigen::Map<const Group>(points.z.data() + first) - to.z()).square();
}

// Angle to the nearest point. Beyond a right angle from the chord to the opposite direction, since
// asin near 1 would turn the last bits of the chord into 1e-3 rad.
float nearest_angle(const Points& points, const Vector3f& from) {
  Group near = squared_chord(points, 0, from);
  for (std::size_t i = kGroup; i < points.size; i += kGroup)
    near = near.min(squared_chord(points, i, from));
  const float squared = near.minCoeff();
  if (squared < 2) return 2 * std::asin(std::sqrt(squared) / 2);
  float opposite = 0;
  for (std::size_t i = 0; i < points.size; i += kGroup)
    opposite = std::max(opposite, squared_chord(points, i, -from).maxCoeff());
  return kPi<float> - 2 * std::asin(std::min(std::sqrt(opposite) / 2, 1.0f));
}

}  // namespace

SphericalDistanceTransform::SphericalDistanceTransform(const DirectionTable& directions,
                                                       int resolution)
    : directions_(directions), resolution_(resolution) {
  const int n = directions.resolution();
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const Vector3f d = directions.direction(x, y);
      const int right = octahedral_wrap(x + 1, y, n), below = octahedral_wrap(x, y + 1, n);
      for (const int other : {right, below})
        boundary_pitch_ = std::max(
            boundary_pitch_, angle_between<float>(d, directions.direction(other % n, other / n)));
    }

  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x)
      texels_.push_back(octahedral_texel_direction<double>(x, y, resolution).cast<float>());

  for (int across = kRootAcross; across * kLeaf <= resolution; across *= 2) {
    const int size = resolution / across;
    std::vector<Node>& nodes = levels_.emplace_back();
    for (int i = 0; i < across * across; ++i) {
      const auto texel = [&](int k) {
        return texels_[static_cast<std::size_t>((i / across * size + k / size) * resolution +
                                                i % across * size + k % size)];
      };
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < size * size; ++k) sum += texel(k).cast<double>();
      Node node{(sum / (size * size)).cast<float>(), 0};
      for (int k = 0; k < size * size; ++k)
        node.radius = std::max(node.radius, (texel(k) - node.center).norm());
      nodes.push_back(node);
    }
  }
}

void SphericalDistanceTransform::collect_boundary(const VisibilityMask& mask,
                                                  Points& points) const {
  points.size = 0;
  const int n = mask.resolution;
  const std::size_t words = static_cast<std::size_t>(n) / 64;
  constexpr std::uint64_t kLowBits = ~std::uint64_t{0} >> 1;
  const auto add_neighbours = [&](int x, int y, int step_x, int step_y) {
    add_midpoint(directions_.direction(x, y), directions_.direction(x + step_x, y + step_y),
                 points);
  };
  // Block by block of 8 x 8 texels, so that points near each other in the list are near each other
  // on the sphere.
  std::uint64_t differs_right[8], differs_below[8];
  for (int block_y = 0; block_y < n; block_y += 8)
    for (std::size_t word = 0; word < words; ++word) {
      for (int i = 0; i < 8; ++i) {
        const std::uint64_t* row =
            mask.bits.data() + static_cast<std::size_t>(block_y + i) * words + word;
        const bool last = word + 1 == words;
        const std::uint64_t right = *row >> 1 | (last ? *row & ~kLowBits : row[1] << 63);
        differs_right[i] = *row ^ right;
        differs_below[i] = block_y + i + 1 < n ? *row ^ row[words] : 0;
      }
      for (int byte = 0; byte < 8; ++byte)
        for (int i = 0; i < 8; ++i) {
          const int x = static_cast<int>(word) * 64 + byte * 8, y = block_y + i;
          for (std::uint64_t d = differs_right[i] >> (8 * byte) & 255; d; d &= d - 1)
            add_neighbours(x + std::countr_zero(d), y, 1, 0);
          for (std::uint64_t d = differs_below[i] >> (8 * byte) & 255; d; d &= d - 1)
            add_neighbours(x + std::countr_zero(d), y, 0, 1);
        }
    }
  // Over the map's edges: each edge meets its own mirror image, so half of it names every pair.
  for (int i = 0; i < n / 2; ++i)
    for (const int edge : {0, n - 1}) {
      if (mask.visible(edge, i) != mask.visible(edge, n - 1 - i))
        add_midpoint(directions_.direction(edge, i), directions_.direction(edge, n - 1 - i),
                     points);
      if (mask.visible(i, edge) != mask.visible(n - 1 - i, edge))
        add_midpoint(directions_.direction(i, edge), directions_.direction(n - 1 - i, edge),
                     points);
    }
}

int SphericalDistanceTransform::sign(int x, int y, const VisibilityMask& mask) const {
  const int ratio = mask.resolution / resolution_;
  if (ratio == 1) return mask.visible(x, y) ? 1 : -1;
  const int right = x * ratio + ratio / 2, below = y * ratio + ratio / 2;
  const int visible = mask.visible(right - 1, below - 1) + mask.visible(right, below - 1) +
                      mask.visible(right - 1, below) + mask.visible(right, below);
  return (visible > 2) - (visible < 2);
}

void SphericalDistanceTransform::search_leaf(int x, int y, const Points& points,
                                             const VisibilityMask& mask,
                                             std::span<float> ssdf) const {
  for (int row = y * kLeaf; row < (y + 1) * kLeaf; ++row)
    for (int column = x * kLeaf; column < (x + 1) * kLeaf; ++column) {
      const auto texel = static_cast<std::size_t>(row * resolution_ + column);
      ssdf[texel] =
          static_cast<float>(sign(column, row, mask)) * nearest_angle(points, texels_[texel]);
    }
}

void SphericalDistanceTransform::search(std::size_t level, int x, int y, const VisibilityMask& mask,
                                        std::span<float> ssdf, Scratch& scratch) const {
  const Points& given = scratch.levels[level];
  Points& kept = scratch.levels[level + 1];
  const int across = kRootAcross << level;
  const Node& node = levels_[level][static_cast<std::size_t>(y * across + x)];

  float least = 5;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < given.size; i += kGroup) {
    const Group distance = squared_chord(given, i, node.center);
    Eigen::Map<Group>(scratch.distance.data() + i) = distance;
    const float smallest = distance.minCoeff();
    if (smallest < least) {
      least = smallest;
      nearest = i;
    }
  }
  while (scratch.distance[nearest] != least) ++nearest;
  const Vector3f p0(given.x[nearest], given.y[nearest], given.z[nearest]);

  constexpr float kSlack = 4e-6f;  // covers the rounding of squared chords, which are at most 4
  kept.size = 0;
  for (std::size_t i = 0; i < given.size; i += kGroup) {
    const Group excess = Eigen::Map<const Group>(scratch.distance.data() + i) - (least + kSlack) -
                         2 * node.radius * squared_chord(given, i, p0).sqrt();
    if (excess.minCoeff() > 0) continue;
    for (std::size_t k = 0; k < kGroup; ++k) {
      kept.x[kept.size] = given.x[i + k];
      kept.y[kept.size] = given.y[i + k];
      kept.z[kept.size] = given.z[i + k];
      kept.size += excess[static_cast<Eigen::Index>(k)] <= 0;
    }
  }
  fill_last_group(kept);

  if (level + 1 == levels_.size()) return search_leaf(x, y, kept, mask, ssdf);
  for (int child = 0; child < 4; ++child)
    search(level + 1, 2 * x + child % 2, 2 * y + child / 2, mask, ssdf, scratch);
}

void SphericalDistanceTransform::transform(const VisibilityMask& mask, std::span<float> ssdf,
                                           Scratch& scratch) const {
  scratch.levels.resize(levels_.size() + 1);
  Points& boundary = scratch.levels.front();
  collect_boundary(mask, boundary);
  if (boundary.size == 0) {
    std::fill(ssdf.begin(), ssdf.end(), mask.visible(0, 0) ? kPi<float> : -kPi<float>);
    return;
  }
  fill_last_group(boundary);
  const std::size_t room = boundary.x.size();
  for (Points& points : scratch.levels)
    if (points.x.size() < room) reserve(points, room);
  scratch.distance.resize(room);
  for (int y = 0; y < kRootAcross; ++y)
    for (int x = 0; x < kRootAcross; ++x) search(0, x, y, mask, ssdf, scratch);
}

}  // namespace burnish
