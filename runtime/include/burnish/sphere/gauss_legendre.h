#pragma once

#include <array>
#include <cmath>

#include "burnish/sphere/direction.h"

namespace burnish::internal {

/// Gauss-Legendre quadrature of N points over (0, 1).
template <int N>
struct UnitGauss {
  std::array<double, N> node, weight;  ///< nodes rising; weights sum to one
};

/// The rule, computed on first use by Newton's method on the Legendre polynomial.
template <int N>
const UnitGauss<N>& unit_gauss() {
  static const UnitGauss<N> rule = [] {
    UnitGauss<N> r;
    for (int i = 0; i < N; ++i) {
      double x = std::cos(kPi<double> * (i + 0.75) / (N + 0.5)), slope = 1;
      for (int step = 0; step < 8; ++step) {
        double p0 = 1, p1 = x;
        for (int k = 2; k <= N; ++k) {
          const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
          p0 = p1;
          p1 = p2;
        }
        slope = N * (x * p1 - p0) / (x * x - 1);
        x -= p1 / slope;
      }
      r.node[i] = (1 - x) / 2;
      r.weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
    return r;
  }();
  return rule;
}

}  // namespace burnish::internal
