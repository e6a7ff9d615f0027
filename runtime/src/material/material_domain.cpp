#include <cmath>

#include "burnish/material/material.h"
#include "burnish/sphere/lobe_domain.h"

namespace burnish {
namespace {

std::string range_error(const std::string& field, float value, float low, float high) {
  if (value >= low && value <= high) return {};
  const auto text = [](float number) {
    std::string digits = std::to_string(number);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return digits;
  };
  return field + " is " + std::to_string(value) + ", expected " + text(low) + " to " + text(high);
}

std::string color_error(const std::string& field, const Rgb& color, float low, float high) {
  for (const float channel : color) {
    const std::string error = range_error(field, channel, low, high);
    if (!error.empty()) return error;
  }
  return {};
}

}  // namespace

std::string domain_error(const Fresnel& fresnel) {
  if (fresnel.model == FresnelModel::schlick)
    return color_error("normal_reflectance", fresnel.normal_reflectance, 0, 1);
  std::string error = color_error("eta", fresnel.eta, kMinEta, kMaxEta);
  if (error.empty() && fresnel.model == FresnelModel::conductor)
    error = color_error("k", fresnel.k, 0, kMaxEta);
  return error;
}

std::string domain_error(const Material& material) {
  std::string error =
      internal::first_error({color_error("diffuse", material.diffuse, 0, 1),
                             color_error("specular", material.specular, 0, kMaxSpecular),
                             range_error("alpha_x", material.alpha_x, kMinAlpha, kMaxAlpha),
                             range_error("alpha_y", material.alpha_y, kMinAlpha, kMaxAlpha)});
  if (!error.empty()) return error;
  switch (material.model) {
    case SpecularModel::none:
    case SpecularModel::ward:
    case SpecularModel::ward_balanced:
      break;
    case SpecularModel::ashikhmin_shirley:
    case SpecularModel::cook_torrance:
      error = domain_error(material.fresnel);
      return error.empty() ? error : "fresnel: " + error;
    case SpecularModel::fitted:
      if (!material.fitted) return "fitted is missing";
      error = domain_error(*material.fitted);
      return error.empty() ? error : "fitted: " + error;
  }
  return {};
}

}  // namespace burnish
