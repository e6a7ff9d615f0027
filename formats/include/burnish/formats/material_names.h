#pragma once

#include <array>
#include <utility>

#include "burnish/material/material.h"
#include "burnish/material/texture.h"

/// The names of enums in material files.
namespace burnish {

inline constexpr std::array kSpecularModelNames = {
    std::pair{"diffuse", SpecularModel::none},
    std::pair{"ward", SpecularModel::ward},
    std::pair{"ward-balanced", SpecularModel::ward_balanced},
    std::pair{"ashikhmin-shirley", SpecularModel::ashikhmin_shirley},
    std::pair{"cook-torrance", SpecularModel::cook_torrance},
    std::pair{"fitted", SpecularModel::fitted}};

inline constexpr std::array kDistributionNames = {
    std::pair{"beckmann", Distribution::beckmann}, std::pair{"ggx", Distribution::ggx},
    std::pair{"blinn-phong", Distribution::blinn_phong}};

inline constexpr std::array kShadowingNames = {
    std::pair{"smith", Shadowing::smith}, std::pair{"smith-separable", Shadowing::smith_separable},
    std::pair{"v-cavity", Shadowing::v_cavity}};

inline constexpr std::array kTextureWrapNames = {std::pair{"repeat", TextureWrap::repeat},
                                                 std::pair{"mirror", TextureWrap::mirror},
                                                 std::pair{"clamp", TextureWrap::clamp}};

/// The name of a value in one of these lists; "" for one that is not there.
template <class Enum, std::size_t N>
const char* name_of(const std::array<std::pair<const char*, Enum>, N>& names, Enum value) {
  for (const auto& [name, named] : names)
    if (named == value) return name;
  return "";
}

/// Which fields a model has beside diffuse.
/// @{
constexpr bool has_alpha(SpecularModel model) {
  return model != SpecularModel::none && model != SpecularModel::fitted;
}
constexpr bool has_fresnel(SpecularModel model) {
  return model == SpecularModel::ashikhmin_shirley || model == SpecularModel::cook_torrance;
}
/// @}

}  // namespace burnish
