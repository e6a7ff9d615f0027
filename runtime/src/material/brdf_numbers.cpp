#include "material/brdf_numbers.h"

#include "material/ashikhmin.h"
#include "material/microfacet.h"

namespace burnish::internal {
namespace {

BrdfKind kind_of(const Material& material) {
  switch (material.model) {
    case SpecularModel::ward_balanced:
      return BrdfKind::ward_balanced;
    case SpecularModel::ashikhmin_shirley:
      return BrdfKind::ashikhmin;
    case SpecularModel::cook_torrance:
      return material.distribution == Distribution::beckmann ? BrdfKind::beckmann
             : material.distribution == Distribution::ggx    ? BrdfKind::ggx
                                                             : BrdfKind::blinn_phong;
    case SpecularModel::fitted:
      return BrdfKind::fitted;
    case SpecularModel::none:
    case SpecularModel::ward:
      break;
  }
  return BrdfKind::ward;
}

FresnelKind fresnel_kind_of(FresnelModel model) {
  return model == FresnelModel::schlick      ? FresnelKind::schlick
         : model == FresnelModel::dielectric ? FresnelKind::dielectric
                                             : FresnelKind::conductor;
}

bool is_grey(const Rgb& color) { return color[0] == color[1] && color[1] == color[2]; }

}  // namespace

BrdfNumbers brdf_numbers(const Material& material) noexcept {
  BrdfNumbers numbers;
  numbers.kind = kind_of(material);
  numbers.specular = material.specular;
  numbers.fitted = material.fitted.get();
  if (numbers.kind == BrdfKind::fitted) {
    numbers.fresnel_kind = FresnelKind::table;
    return numbers;
  }
  const Microfacets facets = microfacets_of(material);
  numbers.shadowing = material.shadowing;
  numbers.alpha_x = facets.alpha_x;
  numbers.alpha_y = facets.alpha_y;
  numbers.inverse_xx = 1 / (facets.alpha_x * facets.alpha_x);
  numbers.inverse_yy = 1 / (facets.alpha_y * facets.alpha_y);
  numbers.exponent = 2 * numbers.inverse_xx - 2;
  numbers.scale = numbers.kind == BrdfKind::ashikhmin
                      ? ashikhmin_normalisation(material) / (8 * kPi<float>)
                      : microfacet_peak(facets) / 4;
  if (numbers.kind == BrdfKind::ward || numbers.kind == BrdfKind::ward_balanced) return numbers;
  numbers.fresnel = material.fresnel;
  numbers.fresnel_kind = fresnel_kind_of(material.fresnel.model);
  numbers.is_grey =
      material.fresnel.model != FresnelModel::schlick && is_grey(material.fresnel.eta) &&
      (material.fresnel.model == FresnelModel::dielectric || is_grey(material.fresnel.k));
  return numbers;
}

}  // namespace burnish::internal
