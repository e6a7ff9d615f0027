#pragma once

#include <span>
#include <vector>

#include "burnish/material/specular_slice.h"
#include "burnish/sphere/spherical_gaussian.h"

/// What slices of specular materials are measured against: quadrature in double of the exact BRDF.
namespace burnish::tools {

/// What a material reflects toward a viewer, by light.
struct Reflected {
  std::vector<double> by_light;  ///< integral of f(o, i) max(i.z, 0) light(i)
  double energy = 0;             ///< the same under a light of 1 everywhere
};

/// Mean of the channels of the specular part. `outgoing` unit, in the local frame, above the
/// horizon. Relative error about 1e-3 where the lobe is cut by the horizon, less elsewhere, for
/// alphas from .01 on.
Reflected integrate_brdf(const Material& material, const Vector3f& outgoing,
                         std::span<const SphericalGaussian<double>> lights);

/// Of lobes, each times the half of its Gaussian that is above the horizon where the form is
/// SpecularForm::peak, which has no share of its own in that.
Reflected integrate_slice(std::span<const SliceLobe> slice, SpecularForm form,
                          std::span<const SphericalGaussian<double>> lights);

}  // namespace burnish::tools
