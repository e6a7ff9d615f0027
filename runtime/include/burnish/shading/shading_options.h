#pragma once

#include "burnish/material/specular_slice.h"
#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/half_space.h"

namespace burnish {

/// How the cosine of the diffuse term is taken.
enum class CosineModel {
  constant,            ///< at the lobe's axis, out of the integral (xu2013asg, Eq. 29)
  horizon_normalised,  ///< unshadowed cosine integral times visible fraction over horizon fraction
};

/// Speed for accuracy. The defaults are ours; VisibilityModel::hemisphere, CosineModel::constant
/// and one tap of SpecularForm::peak are the paper's method.
struct ShadingOptions {
  VisibilityModel visibility = VisibilityModel::directional;
  CosineModel cosine = CosineModel::horizon_normalised;
  AsgIntegral integral = AsgIntegral::exact;
  int terms = 0;                  ///< PCA terms used, 1..baked; 0: all that were baked
  SpecularOptions specular = {};  ///< how materials are prepared: see prepare_material
  int environment_taps = 32;      ///< at most, along the long axis of a specular lobe, 1..64
  /// The horizon-normalised diffuse term of lobes wider than the transfer's crossover sees through
  /// the visibility ladder, where one was baked. False: through the SSDF, as the papers do.
  bool ladder = true;
  /// prepare_lights splits an environment's lobes wider than this into narrower ones
  /// (lobe_split.h), each with a boundary of its own; 0: none. Costs as many times the lobes; buys
  /// accuracy where there is no ladder (docs/lights.md, "Lobe width").
  float split_bandwidth = 0;
};

}  // namespace burnish
