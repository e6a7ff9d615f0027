#pragma once

#include <span>
#include <vector>

#include "burnish/material/specular_slice.h"

/// Errors of a material's slices as light sees them: integrals of the lobes with smooth lights
/// against quadrature of the exact BRDF (specular_truth.h).
namespace burnish::tools {

/// For one angle of view, over five azimuths and 24 lights all around.
struct SliceLightError {
  double relative_rms = 0;
  double energy = 0;  ///< relative, under a light of 1 everywhere: the worst azimuth's, signed
};

/// One for each of `forms`.
std::vector<SliceLightError> slice_light_errors(const Material& material, double view_deg,
                                                std::span<const SpecularOptions> forms);

}  // namespace burnish::tools
