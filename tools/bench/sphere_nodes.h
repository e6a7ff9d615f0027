#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/gauss_legendre.h"

/// What lobes are compared by: the L2 norm over the sphere, by quadrature that follows a lobe.
namespace burnish::tools {

struct SphereNode {
  Vector3d direction;
  double weight;  ///< sr
};

/// A rule over the whole sphere, densest where a lobe of this frame and these bandwidths is: Radii
/// Gauss-Legendre points of the stereographic plane about the lobe's axis, scaled by the lobe's
/// widths, on each of 2 Radii azimuths. Relative error of a lobe's integral below 1e-9 for 48 radii
/// and bandwidths from 3 on; where a horizon cuts what is integrated, about 1e-3.
template <int Radii>
std::vector<SphereNode> nodes_about(const AnisotropicGaussian<double>& lobe) {
  const auto& rule = internal::unit_gauss<Radii>();
  const double width_x = std::min(1.0, 2 / std::sqrt(lobe.bandwidth_x + 1));
  const double width_y = std::min(1.0, 2 / std::sqrt(lobe.bandwidth_y + 1));
  constexpr double kStep = kPi<double> / Radii;  // of the azimuth
  std::vector<SphereNode> nodes;
  nodes.reserve(2 * Radii * Radii);
  for (int k = 0; k < Radii; ++k) {
    const double t = rule.node[k], radius = t / (1 - t);
    const double ring = rule.weight[k] * kStep * width_x * width_y * radius / ((1 - t) * (1 - t));
    for (int i = 0; i < 2 * Radii; ++i) {
      const double x = width_x * radius * std::cos((i + 0.5) * kStep);
      const double y = width_y * radius * std::sin((i + 0.5) * kStep);
      const double scale = 1 / (1 + x * x + y * y);
      nodes.push_back({lobe.frame.to_world({2 * x * scale, 2 * y * scale, 2 * scale - 1}),
                       ring * 4 * scale * scale});
    }
  }
  return nodes;
}

struct LobeDistance {
  double difference = 0;  ///< L2 norm of approximation - truth
  double norm = 0;        ///< of the truth

  double relative() const { return norm > 0 ? difference / norm : 0; }
};

/// Of two functions of a unit Vector3d.
template <class Approximation, class Truth>
LobeDistance distance_of(const Approximation& approximation, const Truth& truth,
                         const std::vector<SphereNode>& nodes) {
  double squares = 0, norm = 0;
  for (const SphereNode& node : nodes) {
    const double value = truth(node.direction);
    const double difference = approximation(node.direction) - value;
    squares += node.weight * difference * difference;
    norm += node.weight * value * value;
  }
  return {std::sqrt(squares), std::sqrt(norm)};
}

}  // namespace burnish::tools
