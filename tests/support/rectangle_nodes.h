#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "burnish/light/light_rig.h"
#include "support/quadrature.h"

namespace burnish::test {

/// Directions of a rectangle light as seen from a point, with weights that sum to the solid angle
/// of what shines there.
inline std::vector<Node> rectangle_nodes(const RectangleLight& light, const Vector3d& position,
                                         int steps) {
  const Vector3d edge_x = light.edge_x.cast<double>(), edge_y = light.edge_y.cast<double>();
  const Vector3d area = edge_x.cross(edge_y);
  const auto rule = gauss_legendre(steps, -0.5, 0.5);
  std::vector<Node> nodes;
  for (const auto& [u, weight_u] : rule) {
    for (const auto& [v, weight_v] : rule) {
      const Vector3d offset = light.center.cast<double>() + u * edge_x + v * edge_y - position;
      const double distance = offset.norm();
      const Vector3d direction = offset / distance;
      const double facing = -area.dot(direction) / (distance * distance);
      nodes.push_back(
          {direction,
           weight_u * weight_v * (light.two_sided ? std::abs(facing) : std::max(facing, 0.0))});
    }
  }
  return nodes;
}

}  // namespace burnish::test
