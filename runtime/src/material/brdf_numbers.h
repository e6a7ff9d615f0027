#pragma once

#include <array>

#include "burnish/material/specular_slice.h"

/// What brdf-inl.h reads of a material: numbers that depend on no direction.
namespace burnish::internal {

/// SpecularModel, and for cook_torrance its distribution.
enum class BrdfKind { ward, ward_balanced, ashikhmin, beckmann, ggx, blinn_phong, fitted };

/// Reflectance by channel, as FresnelModel has it, or 1, or a table of FittedSpecular.
enum class FresnelKind { none, schlick, dielectric, conductor, table };

struct BrdfNumbers {
  BrdfKind kind = BrdfKind::ward;
  Shadowing shadowing = Shadowing::smith;  ///< beckmann, ggx, blinn_phong
  float alpha_x = 1, alpha_y = 1;          ///< equal for blinn_phong
  float inverse_xx = 1, inverse_yy = 1;    ///< 1 / alpha^2
  float exponent = 0;                      ///< blinn_phong
  float scale = 1;                         ///< of the smooth factor
  FresnelKind fresnel_kind = FresnelKind::none;
  bool is_grey = false;  ///< the Fresnel factor is the same for all channels
  Fresnel fresnel;
  Rgb specular = Rgb::Ones();
  const FittedSpecular* fitted = nullptr;
};

/// Of a material that has_specular().
BrdfNumbers brdf_numbers(const Material& material) noexcept;

}  // namespace burnish::internal
