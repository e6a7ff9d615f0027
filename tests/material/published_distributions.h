#pragma once

#include <cmath>
#include <vector>

#include "burnish/material/material.h"
#include "support/quadrature.h"

/// The oracle of every D: the formulas as they are printed, in double, and nodes to integrate them.
namespace burnish::test {

/// D(h) over its value at the normal.
inline double published_distribution(const Material& material, const Vector3d& half) {
  if (half.z() <= 0) return 0;
  const double x = half.x() / material.alpha_x, y = half.y() / material.alpha_y, z = half.z();
  const double sine2 = half.x() * half.x() + half.y() * half.y();
  const double e = x * x + y * y;
  switch (material.model) {
    case SpecularModel::ward:  // ward1992, Eq. 5b
      return std::exp(-2 * e / (1 + z));
    case SpecularModel::ashikhmin_shirley:  // ashikhmin2000phong, Eq. 4, exponents 2 / alpha^2
      return sine2 > 0 ? std::pow(z, 2 * e / sine2) : 1;
    case SpecularModel::ward_balanced:
      break;  // Beckmann
    case SpecularModel::cook_torrance:
      if (material.distribution == Distribution::ggx)  // burley2012, Eq. 13
        return std::pow(e + z * z, -2);
      if (material.distribution == Distribution::blinn_phong) {  // walter2007, Eq. 30
        const double alpha2 = double(material.alpha_x) * material.alpha_y;
        return std::pow(z, 2 / alpha2 - 2);
      }
      break;
    case SpecularModel::none:
    case SpecularModel::fitted:
      return eval_distribution(material, half.cast<float>());
  }
  return std::exp(-e / (z * z)) / std::pow(z, 4);  // walter2007, Eq. 25, anisotropic
}

/// Nodes over the hemisphere, weights per sr, that follow any D of these alphas and its tail:
/// azimuths crowd toward the wide direction, angles grow from a quarter of the lobe's width by 1.6.
inline std::vector<Node> hemisphere_nodes(double alpha_x, double alpha_y, int azimuths = 24) {
  std::vector<Node> nodes;
  for (const auto& [psi, psi_weight] : gauss_legendre(azimuths, 0, kPi<double> / 2)) {
    const double x = alpha_x * std::cos(psi), y = alpha_y * std::sin(psi), norm = std::hypot(x, y);
    const double c = x / norm, s = y / norm, turn = alpha_x * alpha_y / (norm * norm);
    const double alpha = 1 / std::hypot(c / alpha_x, s / alpha_y);
    double from = 0, to = alpha / 4;
    while (from < kPi<double> / 2) {
      if (to > 0.8 * kPi<double> / 2) to = kPi<double> / 2;
      for (const auto& [theta, weight] : gauss_legendre(10, from, to)) {
        const double sine = std::sin(theta);
        for (const double sign_x : {-1, 1})
          for (const double sign_y : {-1, 1})
            nodes.push_back({{sign_x * sine * c, sign_y * sine * s, std::cos(theta)},
                             psi_weight * turn * weight * sine});
      }
      from = to;
      to *= 1.6;
    }
  }
  return nodes;
}

}  // namespace burnish::test
