#include "burnish/material/presets.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace burnish {
namespace {

Fresnel conductor(const Rgb& eta, const Rgb& k) {
  Fresnel fresnel;
  fresnel.model = FresnelModel::conductor;
  fresnel.eta = eta;
  fresnel.k = k;
  return fresnel;
}

// Complex refractive indices, spectra that were integrated to RGB (pellacini2019yocto; of its table
// of metals Ag, Al, Au, Cr, Cu and Ni, rounded to four digits).
constexpr const char* kIndices = "indices: pellacini2019yocto";
Fresnel silver() { return conductor({.1553f, .1167f, .1384f}, {4.828f, 3.122f, 2.147f}); }
Fresnel aluminium() { return conductor({1.657f, .8804f, .5212f}, {9.224f, 6.270f, 4.837f}); }
Fresnel gold() { return conductor({.1431f, .3750f, 1.442f}, {3.983f, 2.386f, 1.603f}); }
Fresnel chromium() { return conductor({4.370f, 2.917f, 1.655f}, {5.206f, 4.231f, 3.755f}); }
Fresnel copper() { return conductor({.2004f, .9240f, 1.102f}, {3.913f, 2.453f, 2.142f}); }
Fresnel nickel() { return conductor({2.367f, 1.663f, 1.467f}, {4.499f, 3.050f, 2.345f}); }

MaterialPreset metal(const char* name, const Fresnel& fresnel, Distribution distribution,
                     float alpha_x, float alpha_y, const char* alphas) {
  MaterialPreset preset = {name, std::string(kIndices) + "; " + alphas, {}};
  Material& material = preset.material;
  material.diffuse = Rgb::Zero();
  material.model = SpecularModel::cook_torrance;
  material.distribution = distribution;
  material.fresnel = fresnel;
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  return preset;
}

/// A surface of ward1992, table 1: alphas are his, colours are ours.
MaterialPreset ward_surface(const char* name, const char* surface, float alpha_x, float alpha_y,
                            const Rgb& diffuse, const Rgb& specular) {
  MaterialPreset preset = {
      name, std::string("alphas: ward1992, table 1, \"") + surface + "\"; reflectances: ours", {}};
  Material& material = preset.material;
  material.model = SpecularModel::ward;
  material.diffuse = diffuse;
  material.specular = specular;
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  return preset;
}

/// A coloured body under a clear surface.
MaterialPreset coated(const char* name, const char* source, SpecularModel model, float alpha_x,
                      float alpha_y, const Rgb& diffuse, float normal_reflectance) {
  MaterialPreset preset = {name, source, {}};
  Material& material = preset.material;
  material.model = model;
  material.diffuse = diffuse;
  material.fresnel.normal_reflectance = Rgb::Constant(normal_reflectance);
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  return preset;
}

std::vector<MaterialPreset> make_presets() {
  constexpr auto kGgx = Distribution::ggx, kBeckmann = Distribution::beckmann;
  constexpr auto kAshikhmin = SpecularModel::ashikhmin_shirley;
  constexpr auto kMicrofacets = SpecularModel::cook_torrance;
  constexpr const char* kOwn = "alphas: ours";
  constexpr const char* kAllOwn = "all numbers: ours";
  return {
      metal("silver", silver(), kGgx, .1f, .1f, kOwn),
      metal("aluminium", aluminium(), kGgx, .15f, .15f, kOwn),
      metal("gold", gold(), kGgx, .15f, .15f, kOwn),
      metal("chromium", chromium(), kGgx, .05f, .05f, kOwn),
      metal("copper", copper(), kGgx, .2f, .2f, kOwn),
      metal("nickel", nickel(), kGgx, .2f, .2f, kOwn),
      metal("brushed aluminium", aluminium(), kBeckmann, .088f, .13f,
            "alphas: ward1992, table 1, \"lightly brushed aluminum\""),
      metal("coarsely brushed aluminium", aluminium(), kGgx, .04f, .4f, kOwn),
      metal("brushed copper", copper(), kGgx, .05f, .3f, kOwn),
      ward_surface("rolled brass", "rolled brass", .05f, .16f, {.1f, .08f, .04f},
                   {.42f, .33f, .16f}),
      ward_surface("rolled aluminium", "rolled aluminum", .04f, .09f, Rgb::Constant(.1f),
                   Rgb::Constant(.4f)),
      ward_surface("varnished plywood", "varnished plywood", .04f, .11f, {.45f, .3f, .17f},
                   Rgb::Constant(.03f)),
      ward_surface("enamelled metal", "enamel finished metal", .08f, .096f, {.25f, .25f, .27f},
                   Rgb::Constant(.05f)),
      ward_surface("painted cardboard", "painted cardboard box", .076f, .085f, {.2f, .19f, .18f},
                   Rgb::Constant(.04f)),
      ward_surface("ceramic tile", "ceramic tile", .071f, .071f, Rgb::Constant(.7f),
                   Rgb::Constant(.05f)),
      ward_surface("glossy paper", "glossy paper", .082f, .082f, Rgb::Constant(.3f),
                   Rgb::Constant(.08f)),
      ward_surface("plastic", "computer plastic", .13f, .13f, {.5f, .46f, .38f},
                   Rgb::Constant(.04f)),
      ward_surface("plastic laminate", "plastic laminate", .092f, .092f, Rgb::Constant(.65f),
                   Rgb::Constant(.07f)),
      coated("satin", "exponents (8, 800): xu2013asg, figure 8; reflectances: ours", kAshikhmin,
             .5f, .05f, {.12f, .03f, .14f}, .15f),
      coated("car paint", kAllOwn, kMicrofacets, .06f, .06f, {.35f, .015f, .02f}, .05f),
      coated("rubber", kAllOwn, kMicrofacets, .6f, .6f, Rgb::Constant(.03f), .04f),
  };
}

/// Lower case, with blanks between words.
std::string plain_name(std::string_view name) {
  std::string plain(name);
  for (char& c : plain) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (c == '-' || c == '_') c = ' ';
  }
  return plain;
}

}  // namespace

std::span<const MaterialPreset> material_presets() {
  static const std::vector<MaterialPreset> presets = make_presets();
  return presets;
}

const MaterialPreset* find_material_preset(std::string_view name) {
  const std::string plain = plain_name(name);
  for (const MaterialPreset& preset : material_presets())
    if (preset.name == plain) return &preset;
  return nullptr;
}

}  // namespace burnish
