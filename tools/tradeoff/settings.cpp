#include "tradeoff/settings.h"

namespace burnish::tools {
namespace {

const char* name_of(VisibilityModel model) {
  switch (model) {
    case VisibilityModel::cap:
      return "cap";
    case VisibilityModel::hemisphere:
      return "hemisphere";
    case VisibilityModel::directional:
      break;
  }
  return "directional";
}

const char* name_of(AsgIntegral integral) {
  switch (integral) {
    case AsgIntegral::fast:
      return "fast";
    case AsgIntegral::series:
      return "series";
    case AsgIntegral::exact:
      break;
  }
  return "exact";
}

}  // namespace

nlohmann::ordered_json settings_json(const Settings& settings) {
  const BakeOptions& bake = settings.bake;
  const ShadingOptions& shading = settings.shading;
  nlohmann::ordered_json json;
  json["bake"] = {{"directions", bake.directions},
                  {"resolution", bake.resolution},
                  {"terms", bake.terms},
                  {"bases", bake.bases},
                  {"ladder-terms", bake.ladder_terms},
                  {"training-vertices", bake.training_vertices}};
  json["lights"] = {{"lobes", settings.lobes}};
  json["shading"] = {
      {"visibility", name_of(shading.visibility)},
      {"cosine", shading.cosine == CosineModel::constant ? "constant" : "horizon-normalised"},
      {"integral", name_of(shading.integral)},
      {"ladder", shading.ladder ? "on" : "off"},
      {"ladder-reach", shading.ladder_reach},
      {"specular-form", shading.specular.form == SpecularForm::peak ? "peak" : "moments"},
      {"specular-taps", shading.specular.taps},
      {"specular-lobes", shading.specular.lobes},
      {"split-bandwidth", shading.split_bandwidth},
      {"environment-taps", shading.environment_taps},
      {"terms", shading.terms},
      {"specular-from", settings.specular_from_map ? "map" : "lobes"}};
  return json;
}

}  // namespace burnish::tools
