#pragma once

#include "burnish/light/rgb.h"

namespace burnish {

enum class FresnelModel {
  schlick,     ///< from the reflectance at normal incidence (schlick1994)
  dielectric,  ///< exact, of a real refractive index
  conductor,   ///< exact, of a complex refractive index
};

/// Reflectance of a smooth interface, by channel.
struct Fresnel {
  FresnelModel model = FresnelModel::schlick;
  Rgb normal_reflectance = Rgb::Constant(0.04f);  ///< schlick: at normal incidence, 0..1
  Rgb eta = Rgb::Constant(1.5f);  ///< dielectric, conductor: index over that of the outside, > 0
  Rgb k = Rgb::Zero();            ///< conductor: extinction, >= 0
};

/// For a cosine, 0..1, between a direction and the (micro)surface's normal; in 0..1.
Rgb eval_fresnel(const Fresnel& fresnel, float cos_difference);

}  // namespace burnish
