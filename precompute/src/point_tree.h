#pragma once

#include <cstdint>
#include <vector>

#include "burnish/shading/transfer.h"

namespace burnish {

/// Points in a tree of boxes, to be asked whether any lies above a plane.
class PointTree {
 public:
  PointTree() = default;
  /// All points are finite.
  explicit PointTree(std::vector<Vector3f> points);

  /// Whether normal . p > height for any point p. Exact but for the rounding of the dot product in
  /// float, a few parts in 10^7 of the normal's length times the points' largest distance from
  /// zero.
  bool any_above(const Vector3f& normal, float height) const;

 private:
  // In the order of a depth-first walk: a node's first child follows it.
  struct Node {
    Vector3f center, half_size;
    std::uint32_t next;          // the node after this one's last descendant
    std::uint32_t first, count;  // of its points, in a leaf; else count is 0
  };

  void build(std::uint32_t first, std::uint32_t last);

  std::vector<Vector3f> points_;
  std::vector<Node> nodes_;
};

}  // namespace burnish
