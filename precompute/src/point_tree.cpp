#include "point_tree.h"

#include <algorithm>

namespace burnish {
namespace {

constexpr std::uint32_t kLeafPoints = 16;

}  // namespace

PointTree::PointTree(std::vector<Vector3f> points) : points_(std::move(points)) {
  if (!points_.empty()) build(0, static_cast<std::uint32_t>(points_.size()));
}

void PointTree::build(std::uint32_t first, std::uint32_t last) {
  Vector3f lower = points_[first], upper = lower;
  for (std::uint32_t i = first; i < last; ++i) {
    lower = lower.cwiseMin(points_[i]);
    upper = upper.cwiseMax(points_[i]);
  }
  const std::size_t node = nodes_.size();
  const Vector3f center = (lower + upper) / 2;
  nodes_.push_back({center, (upper - center).cwiseMax(center - lower), 0, first, last - first});
  if (last - first > kLeafPoints) {
    nodes_[node].count = 0;
    Eigen::Index axis = 0;
    (upper - lower).maxCoeff(&axis);
    const std::uint32_t middle = first + (last - first) / 2;
    const auto at = [&](std::uint32_t i) { return points_.begin() + i; };
    std::nth_element(at(first), at(middle), at(last),
                     [axis](const Vector3f& a, const Vector3f& b) { return a[axis] < b[axis]; });
    build(first, middle);
    build(middle, last);
  }
  nodes_[node].next = static_cast<std::uint32_t>(nodes_.size());
}

bool PointTree::any_above(const Vector3f& normal, float height) const {
  const Vector3f steepness = normal.cwiseAbs();
  for (std::size_t i = 0; i < nodes_.size();) {
    const Node& node = nodes_[i];
    if (!(normal.dot(node.center) + steepness.dot(node.half_size) > height)) {
      i = node.next;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      if (normal.dot(points_[k]) > height) return true;
    ++i;
  }
  return false;
}

}  // namespace burnish
