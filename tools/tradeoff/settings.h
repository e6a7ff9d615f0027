#pragma once

#include <nlohmann/json.hpp>

#include "burnish/formats/settings_file.h"
#include "burnish/precompute/bake.h"
#include "burnish/shading/shading_options.h"

namespace burnish::tools {

/// All dials of a scene's way from its mesh to radiance.
struct Settings {
  BakeOptions bake;
  int lobes = 10;  ///< of light that the environment is fitted by
  ShadingOptions shading;
  bool specular_from_map = true;  ///< highlights reflect the map, else the fitted lights
};

/// Every dial that speed or error depends on, under the name that it has on the command line, by
/// the commands that take it.
SettingsFile settings_file(const Settings& settings);

/// The same: {"bake": {"directions": "512", ...}, "lights": {"lobes": "10"}, "shading": {...}}.
nlohmann::ordered_json settings_json(const Settings& settings);

}  // namespace burnish::tools
