#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "burnish/sphere/frame.h"

namespace burnish::test {

/// Nodes and weights of Gauss-Legendre quadrature on [a, b], by Newton's method on the polynomial.
inline std::vector<std::pair<double, double>> gauss_legendre(int n, double a, double b) {
  std::vector<std::pair<double, double>> rule;
  for (int i = 1; i <= n; ++i) {
    double x = std::cos(kPi<double> * (i - 0.25) / (n + 0.5)), derivative = 1;
    for (int step = 0; step < 50; ++step) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      derivative = n * (x * p1 - p0) / (x * x - 1);
      const double change = p1 / derivative;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    rule.push_back(
        {(a + b) / 2 + (b - a) / 2 * x, (b - a) / ((1 - x * x) * derivative * derivative)});
  }
  return rule;
}

/// Integral over the sphere of f(direction): Gauss-Legendre in the angle from `axis` (piecewise, so
/// that a kink at the axis's horizon lies on a node boundary), trapezoid in azimuth.
template <class F>
double integrate_sphere(const F& f, const Vector3d& axis = Vector3d::UnitZ(), int steps = 128) {
  const Frame<double> frame = frame_from_axis(axis);
  double sum = 0;
  for (const auto& [from, to] : {std::pair{0.0, kPi<double> / 2}, {kPi<double> / 2, kPi<double>}}) {
    for (const auto& [theta, weight] : gauss_legendre(steps, from, to)) {
      for (int j = 0; j < 2 * steps; ++j) {
        const double phi = kPi<double> * j / steps;
        const Vector3d local(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                             std::cos(theta));
        sum += weight * std::sin(theta) * kPi<double> / steps * f(frame.to_world(local));
      }
    }
  }
  return sum;
}

struct Node {
  Vector3d direction;
  double weight;
};

/// A quadrature rule over the sphere that follows a lobe of these bandwidths: Gauss-Legendre in the
/// radius of a stereographic plane about the frame's z, scaled by the lobe's widths, the trapezoid
/// rule in azimuth.
inline std::vector<Node> nodes_about(const Frame<double>& frame, double bandwidth_x,
                                     double bandwidth_y, int radii, int azimuths) {
  const double width_x = std::min(1.0, 2 / std::sqrt(bandwidth_x + 1));
  const double width_y = std::min(1.0, 2 / std::sqrt(bandwidth_y + 1));
  std::vector<Node> nodes;
  for (const auto& [t, weight] : gauss_legendre(radii, 0, 1)) {
    const double q = t / (1 - t);
    for (int i = 0; i < azimuths; ++i) {
      const double azimuth = (i + 0.5) * 2 * kPi<double> / azimuths;
      const double x = width_x * q * std::cos(azimuth), y = width_y * q * std::sin(azimuth);
      const double r2 = x * x + y * y;
      const double area = width_x * width_y * q / ((1 - t) * (1 - t)) * 4 / ((1 + r2) * (1 + r2));
      nodes.push_back({frame.to_world(Vector3d(2 * x, 2 * y, 1 - r2) / (1 + r2)),
                       weight * area * 2 * kPi<double> / azimuths});
    }
  }
  return nodes;
}

inline Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// A random right-handed frame around a unit axis.
inline Frame<double> random_frame(const Vector3d& axis, std::mt19937& random) {
  const double angle = std::uniform_real_distribution<double>(0, 2 * kPi<double>)(random);
  const Frame<double> frame = frame_from_axis(axis);
  const Vector3d x = std::cos(angle) * frame.x + std::sin(angle) * frame.y;
  return {x, axis.cross(x), axis};
}

}  // namespace burnish::test
