#include "tradeoff/settings.h"

#include <fmt/format.h>

namespace burnish::tools {
namespace {

/// As --coarsest says "all".
constexpr int kMostDirections = 1024;

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

SettingsFile settings_file(const Settings& settings) {
  const BakeOptions& bake = settings.bake;
  const ShadingOptions& shading = settings.shading;
  const auto number = [](const char* name, auto value) {
    return DialSetting{name, fmt::format("{}", value)};
  };
  SettingsFile file;
  file.bake = {
      number("directions", bake.directions),
      {"coarsest", bake.coarsest >= kMostDirections ? "all" : fmt::format("{}", bake.coarsest)},
      number("origin-offset", bake.origin_offset),
      number("resolution", bake.resolution),
      number("terms", bake.terms),
      number("amplitude", bake.amplitude_rad),
      number("bases", bake.bases),
      number("ladder-terms", bake.ladder_terms),
      number("training-vertices", bake.training_vertices),
      number("residual-vertices", bake.residual_vertices)};
  file.lights = {number("lobes", settings.lobes)};
  file.shading = {
      {"visibility", name_of(shading.visibility)},
      {"cosine", shading.cosine == CosineModel::constant ? "constant" : "horizon-normalised"},
      {"integral", name_of(shading.integral)},
      {"ladder", shading.ladder ? "on" : "off"},
      number("ladder-reach", shading.ladder_reach),
      {"specular-form", shading.specular.form == SpecularForm::peak ? "peak" : "moments"},
      number("specular-taps", shading.specular.taps),
      number("specular-lobes", shading.specular.lobes),
      number("split-bandwidth", shading.split_bandwidth),
      number("environment-taps", shading.environment_taps),
      {"highlight-lobe", shading.highlight_lobe == HighlightLobe::whole ? "whole" : "visible-part"},
      {"specular-from", settings.specular_from_map ? "map" : "lobes"}};
  return file;
}

nlohmann::ordered_json settings_json(const Settings& settings) {
  const SettingsFile file = settings_file(settings);
  const auto object = [](const std::vector<DialSetting>& dials) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const DialSetting& dial : dials) json[dial.name] = dial.value;
    return json;
  };
  return {{"bake", object(file.bake)},
          {"lights", object(file.lights)},
          {"shading", object(file.shading)}};
}

}  // namespace burnish::tools
