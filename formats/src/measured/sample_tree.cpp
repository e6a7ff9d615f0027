#include "measured/sample_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "measured/measured_formats.h"

namespace burnish::detail {
namespace {

constexpr int kNeighbours = 8;
// Of difference against half vectors: a BRDF varies more slowly over the former.
constexpr double kDifferenceScale = 0.25;

}  // namespace

struct SampleTree::Nearest {
  std::array<float, kNeighbours> distance2;  ///< rising
  std::array<const Node*, kNeighbours> node = {};
  int count = 0;

  float reach() const {
    return count < kNeighbours ? std::numeric_limits<float>::infinity()
                               : distance2[kNeighbours - 1];
  }
  void offer(const Node& candidate, float d2) {
    if (d2 >= reach()) return;
    int i = std::min(count, kNeighbours - 1);
    for (; i > 0 && distance2[size_t(i - 1)] > d2; --i) {
      distance2[size_t(i)] = distance2[size_t(i - 1)];
      node[size_t(i)] = node[size_t(i - 1)];
    }
    distance2[size_t(i)] = d2;
    node[size_t(i)] = &candidate;
    count = std::min(count + 1, kNeighbours);
  }
};

SampleTree::Place SampleTree::place_of(const Vector3d& outgoing, const Vector3d& incoming) {
  const HalfDifference pair = half_difference(outgoing, incoming);
  return Eigen::Vector4d(pair.half.x(), pair.half.y(), kDifferenceScale * pair.difference.x(),
                         kDifferenceScale * pair.difference.y())
      .cast<float>();
}

SampleTree::SampleTree(const std::vector<BrdfSample>& samples) {
  nodes_.reserve(2 * samples.size());
  for (const BrdfSample& sample : samples) {
    const Place place = place_of(sample.outgoing.cast<double>(), sample.incoming.cast<double>());
    nodes_.push_back({place, sample.value});
    // With the directions exchanged the difference vector is mirrored.
    nodes_.push_back({Place(place[0], place[1], -place[2], -place[3]), sample.value});
  }
  split(0, nodes_.size(), 0);
}

void SampleTree::split(std::size_t begin, std::size_t end, int axis) {
  if (end - begin < 2) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return nodes_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const Node& a, const Node& b) { return a.place[axis] < b.place[axis]; });
  split(begin, middle, (axis + 1) % 4);
  split(middle + 1, end, (axis + 1) % 4);
}

void SampleTree::search(std::size_t begin, std::size_t end, int axis, const Place& at,
                        Nearest& nearest) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  nearest.offer(node, (node.place - at).squaredNorm());
  const float offset = at[axis] - node.place[axis];
  const int next = (axis + 1) % 4;
  const auto below = [&] { search(begin, middle, next, at, nearest); };
  const auto above = [&] { search(middle + 1, end, next, at, nearest); };
  offset < 0 ? below() : above();
  if (offset * offset < nearest.reach()) offset < 0 ? above() : below();
}

Rgb SampleTree::eval(const Vector3d& outgoing, const Vector3d& incoming) const {
  Nearest nearest;
  search(0, nodes_.size(), 0, place_of(outgoing, incoming), nearest);
  Rgb sum = Rgb::Zero();
  float weights = 0;
  for (size_t i = 0; i < static_cast<size_t>(nearest.count); ++i) {
    // Closer than the rounding of a place, a sample counts alone.
    const float weight = 1 / std::max(nearest.distance2[i], 1e-12f);
    sum += weight * nearest.node[i]->value;
    weights += weight;
  }
  return sum / weights;
}

}  // namespace burnish::detail
