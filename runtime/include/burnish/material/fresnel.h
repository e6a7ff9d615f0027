#pragma once

#include <string>

#include "burnish/light/rgb.h"

namespace burnish {

enum class FresnelModel {
  schlick,     ///< from the reflectance at normal incidence (schlick1994)
  dielectric,  ///< exact, of a real refractive index; below 1, total beyond the critical angle
  conductor,   ///< exact, of a complex refractive index
};

/// Bounds of eta; in visible light all matter lies within.
inline constexpr float kMinEta = 0.01f;
inline constexpr float kMaxEta = 100.0f;

/// Reflectance of a smooth interface, by channel.
struct Fresnel {
  FresnelModel model = FresnelModel::schlick;
  Rgb normal_reflectance = Rgb::Constant(0.04f);  ///< schlick: at normal incidence, 0..1
  /// dielectric, conductor: refractive index over that of the outside, kMinEta..kMaxEta
  Rgb eta = Rgb::Constant(1.5f);
  Rgb k = Rgb::Zero();  ///< conductor: extinction, 0..kMaxEta
};

/// For a cosine, 0..1, between a direction and the (micro)surface's normal; in 0..1.
Rgb eval_fresnel(const Fresnel& fresnel, float cos_difference);

/// What is wrong with the numbers that its model uses, naming the field, or nothing.
std::string domain_error(const Fresnel& fresnel);

}  // namespace burnish
