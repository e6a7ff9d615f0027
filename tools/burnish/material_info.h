#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "burnish/formats/material_file.h"

/// What `burnish info` says of materials.
namespace burnish::tools {

/// Of a preset or a file; of textures, the mean. Draws its lobes to `png` unless that is empty.
/// `name` as it was given: textures are relative to it.
nlohmann::ordered_json material_info(const std::string& name, const MaterialFile& file,
                                     const std::string& png);

/// Of all presets.
nlohmann::ordered_json presets_info();

}  // namespace burnish::tools
