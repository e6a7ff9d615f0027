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

/// What of a highlight's lobe the environment is averaged over.
enum class HighlightLobe {
  whole,         ///< all of it, as if light and visibility had nothing to do with each other
  visible_part,  ///< the moments of what lies past the nearest boundary, and above the horizon
};

/// Speed for accuracy: what each costs and buys is measured in docs/runtime.md. The defaults are
/// Quality::balanced; VisibilityModel::hemisphere, CosineModel::constant, HighlightLobe::whole, no
/// ladder and one tap of SpecularForm::peak are the paper's method.
struct ShadingOptions {
  /// `directional` costs what `hemisphere` costs, and errs by half; `cap` is for comparison.
  VisibilityModel visibility = VisibilityModel::directional;
  /// `constant` saves half of a narrow lobe's time, and errs by 3 to 30 %.
  CosineModel cosine = CosineModel::horizon_normalised;
  AsgIntegral integral = AsgIntegral::exact;  ///< of lights and of the paper's form of highlights
  /// PCA terms used, 1..baked; 0: all that were baked. Lookups cost in proportion.
  int terms = 0;
  SpecularOptions specular = {};  ///< how materials are prepared: see prepare_material
  /// Lookups of the environment along the long axis of a specular lobe, at most, 1..64: each costs
  /// 15 ns up to 15, and 60 ns above. Odd counts are best.
  int environment_taps = 7;
  /// `visible_part` costs 7 to 9 % of a frame, and takes off a fifth to half of the error where
  /// lobes are cut into several (docs/maths.md, "Visible part"). Only highlights of the map have
  /// it, not those of the lights' lobes.
  HighlightLobe highlight_lobe = HighlightLobe::visible_part;
  /// The horizon-normalised diffuse term of lobes wider than the transfer's crossover sees through
  /// the visibility ladder, where one was baked. False: through the SSDF, as the papers do.
  bool ladder = true;
  /// The environment's lobes up to this many times as sharp as the crossover come through the
  /// ladder, too, 1..1000. They cost nothing there, but 20 ns each where they come through the
  /// SSDF; what they err by more is measured in docs/runtime.md, "Sharp lobes through the ladder".
  float ladder_reach = 8;
  /// prepare_lights splits an environment's lobes wider than this into narrower ones
  /// (lobe_split.h), each with a boundary of its own; 0: none. Costs as many times the lobes; buys
  /// accuracy where there is no ladder (docs/lights.md, "Lobe width").
  float split_bandwidth = 0;
};

/// Points on the trade of speed for accuracy, chosen by `burnish-bench presets` (docs/tuning.md).
enum class Quality {
  fast,      ///< highlights of one lobe each
  balanced,  ///< the defaults
  accurate,  ///< lobes cut into nine, and more lookups
};

ShadingOptions shading_options(Quality quality);

}  // namespace burnish
